"""Results in a folder."""

from __future__ import annotations

import csv
import json
import os
import shutil
import tempfile
import weakref
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _femdem
from ._others import Bodies, Surface, placed
from ._shape import Shape
from ._world import World

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SUMMARIES = ("summary.json", "resolve.json", "stresses.json", "pores.json")
_STATES = ("pack.ckpt", "run.ckpt", "bodies.csv", "contacts.csv")


class Keeper:
    """A temporary folder that lasts as long as this, in the process that made it."""

    def __init__(self) -> None:
        self.folder = tempfile.mkdtemp(prefix="femdem-")
        weakref.finalize(self, _remove, self.folder, os.getpid())


def _remove(folder: str, process: int) -> None:
    # A process that forked has the same object, and not the folder.
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


class Result(Bodies):
    """A folder of a pack, a run or their measurements, as ``pack``, ``run`` and the program write it.

    ``Result(folder)`` also opens what the program has written, and all its properties are of what the folder holds now. A
    folder that :func:`femdem.pack` or :func:`femdem.run` made for want of ``out`` is removed with the last result that refers
    to it.
    """

    def __init__(self, folder: str | os.PathLike[str], *, _keeper: Keeper | None = None) -> None:
        self.folder = Path(folder)
        """The folder."""
        self._keeper = _keeper
        self._known: tuple[list[int], _femdem.Snapshot] | None = None
        if not self.folder.is_dir():
            raise _femdem.FemdemError(f"there is no folder {self.folder}")

    def _json(self, *names: str) -> dict[str, Any]:
        for name in names:
            path = self.folder / name
            if path.is_file():
                found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
                return found
        raise _femdem.FemdemError(f"there is no {' and no '.join(names)} in {self.folder}")

    @property
    def summary(self) -> dict[str, Any]:
        """The result in numbers, as in ``summary.json``."""
        return self._json(*_SUMMARIES)

    @property
    def analysis(self) -> dict[str, Any]:
        """What :func:`femdem.analyse` measured, as in ``analysis.json``."""
        return self._json("analysis.json")

    def table(self, name: str) -> dict[str, Any]:
        """The columns of a CSV file in the folder, such as ``history.csv``: arrays of numbers, or of text."""
        path = self.folder / name
        if not path.is_file():
            known = ", ".join(sorted(p.relative_to(self.folder).as_posix() for p in self.folder.rglob("*.csv")))
            raise _femdem.FemdemError(f"there is no {name} in {self.folder}; there are: {known or 'no tables'}")
        with path.open(newline="", encoding="utf-8") as file:
            lines = csv.reader(line for line in file if not line.startswith("#"))
            header = next(lines, [])
            rows = list(lines)
        return {name: _column([row[k] for row in rows]) for k, name in enumerate(header)}

    @property
    def _snapshot(self) -> _femdem.Snapshot:
        """The state in the folder, which is read again when its files have changed."""
        paths = [self.folder / name for name in _STATES]
        stamp = [path.stat().st_mtime_ns if path.is_file() else 0 for path in paths]
        if self._known is None or self._known[0] != stamp:
            self._known = (stamp, _femdem.Snapshot.from_folder(os.fspath(self.folder)))
        return self._known[1]

    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses (n, 7) of the bodies at the end: x, y, z, qw, qx, qy, qz."""
        return self._snapshot.poses

    @property
    def masses(self) -> NDArray[np.float64]:
        """Masses (n,), kg."""
        return self._snapshot.masses

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities (n, 3) of the centres of mass, m/s."""
        return self._snapshot.velocities

    @property
    def shapes(self) -> list[Shape]:
        """Surfaces of the shapes; :attr:`shape_ids` tells which bodies have which. A ball has a surface of its volume. To add
        bodies, take the shapes of :attr:`world`."""
        return [Shape._of(shape) for shape in self._snapshot.shapes]

    @property
    def shape_ids(self) -> NDArray[np.uint32]:
        """Index of the shape of each body."""
        return self._snapshot.shape_ids

    @property
    def contacts(self) -> dict[str, Any]:
        """The contacts as columns: ``body``, ``partner`` (-1 for a wall, named in ``wall``), ``point`` (m), ``normal``,
        ``normal_force`` (N), ``friction`` on the partner (N), ``area`` (m^2), ``volume`` (m^3), ``class``."""
        return self._snapshot.contacts()

    @property
    def world(self) -> World:
        """The world at the end, to step on."""
        return World.from_folder(self.folder)

    @property
    def stages(self) -> dict[str, Result]:
        """The results of the stages of a scene that have begun, by name in their order; empty for a scene without stages."""
        known = _femdem.stages(os.fspath(self.folder)) if (self.folder / "scene.toml").is_file() else []
        begun = [(name, folder) for name, folder in known if (folder / "run.ckpt").is_file()]
        return {name: Result(folder, _keeper=self._keeper) for name, folder in begun}

    def report(self) -> str:
        """The report page, which :func:`femdem.report` makes if it is not there."""
        page = self.folder / "report.html"
        if not page.is_file():
            _femdem.command(["report", os.fspath(self.folder), "--quiet"])
        return page.read_text(encoding="utf-8")

    def _surfaces(self) -> tuple[list[int], list[Surface]]:
        surfaces = placed(self.shapes, self.shape_ids, self.poses)
        return list(range(len(surfaces))), surfaces

    def _columns(self) -> dict[str, Any]:
        names = np.array([shape.name for shape in self.shapes])
        columns: dict[str, Any] = {"shape": names[self.shape_ids]}
        columns.update(zip(("x", "y", "z", "qw", "qx", "qy", "qz"), self.poses.T, strict=True))
        if len(self.masses):
            columns["mass"] = self.masses
        return columns

    def __repr__(self) -> str:
        return f"Result({os.fspath(self.folder)!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        if self._keeper is not None:
            raise _femdem.FemdemError(f"{self.folder} is removed with its result, which cannot be pickled: give a folder `out`")
        return Result, (self.folder,)

    def _repr_html_(self) -> str:
        path = self.folder / "report.html"
        if not path.is_file():
            return f"<code>{escape(repr(self))}</code>"
        page = escape(path.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 600px; border: 0"></iframe>'


def _column(texts: list[str]) -> NDArray[Any]:
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts, dtype=np.str_)
