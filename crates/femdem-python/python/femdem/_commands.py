"""The commands of the program."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ._femdem import FemdemError
from ._femdem import command as _call
from ._options import toml, words
from ._result import Keeper, Result
from ._shape import Shape

Folder = Result | str | os.PathLike[str]
Scene = Mapping[str, Any] | str | os.PathLike[str]
_SCENE = "scene-given.toml"


def command(name: str, *arguments: str | os.PathLike[str], **options: Any) -> None:
    """Runs a command of the program: ``command("pores", folder, voxel="0.4mm")`` is ``femdem pores FOLDER --voxel=0.4mm``.

    Keywords are the options, with ``_`` for ``-``; lists repeat them, and ``True`` is an option without a value. Python is
    not blocked meanwhile. After Ctrl-C ``pack``, ``run``, ``resume`` and ``sweep`` end with a checkpoint, from which
    :func:`resume` goes on; the other commands run to their end first. What a signal handler raised is raised then.
    """
    _call([name, *words(options), *(os.fspath(argument) for argument in arguments)])


def pack(scene: Scene | None = None, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Pours bodies into a container and lets them settle, as ``femdem pack`` does, and returns the pack.

    ``scene`` is a file or a dict with its keys; ``options`` are those of the command line and win: ``shape="A10"``,
    ``count=200``, ``friction=0.6``, ``box="6x6"``, ``protocol="pour"``, ``seed=1`` ... Shapes are names, paths of surface files
    or :class:`Shape`. Results go to the folder ``out``, to that of a dict, or else to one that lasts as long as the result;
    not to that which a file names.
    """
    for option in ("check", "print_scene", "help"):
        if options.get(option):
            raise FemdemError(f"{option} makes no pack: call femdem.command('pack', {option}=True)")
    with TemporaryDirectory(prefix="femdem-") as given:
        if "shape" in options:
            options["shape"] = _shapes(options["shape"], Path(given))
        arguments = [] if scene is None else [_file(scene, given)]
        out = out or (scene.get("out") if isinstance(scene, Mapping) else None)
        return _with_folder(out, lambda folder: command("pack", *arguments, out=folder, quiet=quiet, **options))


def run(scene: Scene, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Runs a scene, as ``femdem run`` does, and returns what came of it.

    ``scene`` is a file, or a dict with the same keys: ``{"duration": 0.1, "material": {...}, "wall": [...], "body": [...]}``.
    ``options``: ``threads``, ``force``, ``yes``. Results go to the folder ``out``, to that of a dict, or else to one that
    lasts as long as the result; not to that which a file names.
    """
    if options.get("check"):
        raise FemdemError("check makes no run: call femdem.command('run', FILE, check=True)")
    with TemporaryDirectory(prefix="femdem-") as given:
        path = _file(scene, given)
        out = out or (scene.get("out") if isinstance(scene, Mapping) else None)
        return _with_folder(out, lambda folder: command("run", path, out=folder, quiet=quiet, **options))


def resume(folder: Folder, *, quiet: bool = True, **options: Any) -> Result:
    """Goes on with a pack or a run from its checkpoint; ``duration`` lets a run go on beyond its end."""
    command("resume", _path(folder), quiet=quiet, **options)
    return _result(folder)


def analyse(folder: Folder, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Measures a pack or a run in every way; ``analyse(pack).analysis`` has the numbers, its ``table`` the lists.

    ``options``: ``threshold``, ``axes``, ``core_inset``, ``fields``, ``over_time``, ``frame``, ``inside`` ...
    """
    command("analyse", _path(folder), out=out, quiet=quiet, **options)
    return _result(folder, out)


def report(folder: Folder, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Writes the report page of a pack or a run, ``report.html``; the method :meth:`Result.report` has its text."""
    command("report", _path(folder), out=out, quiet=quiet, **options)
    return _result(folder, out)


def resolve(folder: Folder, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Finds the stresses inside the bodies of a pack; ``table("stress.csv")`` of the result has the means of the bodies.

    ``options``: ``young`` (Pa), ``poisson``, ``mesh_size``, ``quadratic``, ``tolerance``, ``steps``.
    """
    command("resolve", _path(folder), out=out, quiet=quiet, **options)
    return _result(folder, out, "resolved")


def stresses(folder: Folder, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Finds the stresses inside the bodies of a pack, body by body, under the forces of their contacts: in seconds, where
    :func:`resolve` lets all bodies deform together. ``table("stress.csv")`` of the result has them, Pa.

    ``options``: ``strength`` (Pa), ``young`` (Pa), ``poisson``, ``mesh_size``, ``linear`` ...
    """
    command("stresses", _path(folder), out=out, quiet=quiet, **options)
    return _result(folder, out, "stresses")


def pores(folder: Folder, *, out: str | os.PathLike[str] | None = None, quiet: bool = True, **options: Any) -> Result:
    """Makes the void of a pack usable by flow codes, as ``femdem pores`` does; ``summary`` of the result has the numbers, its
    folder the voxels and surfaces.

    ``options``: ``voxel`` (``"0.4mm"``), ``region``, ``sides``, ``contacts``, ``no_surface`` ...
    """
    command("pores", _path(folder), out=out, quiet=quiet, **options)
    return _result(folder, out, "pores")


def _path(folder: Folder) -> str:
    return os.fspath(folder.folder if isinstance(folder, Result) else folder)


def _result(of: Folder, out: str | os.PathLike[str] | None = None, within: str = "") -> Result:
    if out is not None:
        return Result(out)
    return Result(Path(_path(of)) / within, _keeper=of._keeper if isinstance(of, Result) else None)


def _file(scene: Scene, folder: str) -> str:
    if not isinstance(scene, Mapping):
        return os.fspath(scene)
    path = Path(folder) / _SCENE
    path.write_text(toml({key: value for key, value in scene.items() if key != "out"}), encoding="utf-8")
    return os.fspath(path)


def _shapes(given: Any, folder: Path) -> list[Any]:
    found: list[Any] = []
    for k, shape in enumerate(given if isinstance(given, (list, tuple)) else [given]):
        if not isinstance(shape, Shape):
            found.append(shape)
            continue
        if shape.is_ball:
            raise FemdemError("the ball has no facets for a file: give shape='sphere' and a diameter")
        if shape.is_picture:
            raise FemdemError(f"the shape {shape.name!r} of a result is a picture: take it from the shapes of its world")
        (folder / str(k)).mkdir()
        path = folder / str(k) / f"{shape.name.replace('/', '-')}.obj"
        shape.save(path)
        found.append(os.fspath(path))
    return found


def _with_folder(out: str | os.PathLike[str] | None, work: Any) -> Result:
    if out is not None:
        work(os.fspath(out))
        return Result(out)
    keeper = Keeper()
    work(keeper.folder)
    return Result(keeper.folder, _keeper=keeper)
