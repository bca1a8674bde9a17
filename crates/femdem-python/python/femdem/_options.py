"""Options as the compiled half and the program take them."""

from __future__ import annotations

import json
import math
import operator
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._femdem import FemdemError

# Numbers of materials are below this.
MATERIALS = 2**8


def plain(name: str, value: Any) -> Any:
    """The same of plain Python types, without the keys of ``None``; numbers must be finite."""
    if isinstance(value, Mapping):
        given = {str(key): item for key, item in value.items() if item is not None}
        return {key: plain(f"{name}.{key}", item) for key, item in given.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(f"{name}[{k}]", item) for k, item in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise FemdemError(f"{name} = {value} is not allowed: give a finite number")
    if isinstance(value, (bool, int, float, str)):
        return value
    raise FemdemError(f"{name} = {value!r} is not allowed: give numbers, texts, lists, arrays and dicts of these")


def index(name: str, value: Any, end: int = 2**32) -> int:
    """A whole number from 0 and below ``end``; a truth value is none."""
    try:
        number = -1 if isinstance(value, (bool, np.bool_)) else operator.index(value)
    except TypeError:
        number = -1
    if not 0 <= number < end:
        raise FemdemError(f"{name} = {value!r} is not allowed: give a whole number from 0, below {end}")
    return number


def vector(name: str, given: Sequence[float]) -> list[float]:
    """Three finite numbers."""
    numbers = [float(x) for x in given]
    if len(numbers) != 3 or not all(math.isfinite(x) for x in numbers):
        raise FemdemError(f"{name} = {numbers} is not allowed: give three finite numbers")
    return numbers


def bodies_list(bodies: Any) -> list[int]:
    """Numbers of bodies: one, or several."""
    try:
        given = list(bodies)
    except TypeError:
        given = [bodies]
    if any(isinstance(number, (bool, np.bool_)) for number in given):
        raise FemdemError("bodies has truth values, not numbers: of a mask, give ids[mask]")
    return [index("bodies", number) for number in given]


def kebab(value: Any) -> Any:
    """The same with the keys of scenes, which have hyphens."""
    if isinstance(value, dict):
        return {key.replace("_", "-"): kebab(item) for key, item in value.items()}
    return [kebab(item) for item in value] if isinstance(value, list) else value


def as_json(name: str, value: Mapping[str, Any]) -> str:
    """A dict as text."""
    return json.dumps(plain(name, value))


def entry(name: str, value: Mapping[str, Any]) -> str:
    """A table of a scene as text."""
    return json.dumps(kebab(plain(name, value)))


def entries(name: str, values: Sequence[Mapping[str, Any]]) -> str:
    """Tables of a scene as text."""
    if isinstance(values, Mapping):
        raise FemdemError(f"{name} is one dict: give a list of dicts")
    return json.dumps([kebab(plain(f"{name}[{k}]", value)) for k, value in enumerate(values)])


def toml(scene: Mapping[str, Any]) -> str:
    """A scene as TOML, one key a line."""
    lines = [f"{_key(key)} = {_value(value)}" for key, value in plain("scene", scene).items()]
    return "\n".join(lines) + "\n"


def _key(key: str) -> str:
    return _text(key)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + "}"
    return "[" + ", ".join(_value(item) for item in value) + "]"


def words(options: Mapping[str, Any]) -> list[str]:
    """Keywords as options of the command line: ``wall_friction=0.3`` is ``--wall-friction=0.3``."""
    found: list[str] = []
    for key, value in options.items():
        option = "--" + key.rstrip("_").replace("_", "-")
        value = None if value is None else plain(key, value)
        if value is None or value is False:
            continue
        if value is True:
            found.append(option)
            continue
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, (bool, list, dict)):
                raise FemdemError(f"{key} = {value!r} is not allowed: give a number, a text or a list of these")
            found.append(f"{option}={item}")
    return found
