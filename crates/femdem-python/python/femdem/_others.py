"""Bodies for other packages, which are imported where they are needed only."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Surface = tuple[NDArray[np.float64], NDArray[np.uint32]]


def need(package: str) -> Any:
    """A package, or an error that tells how to get it."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"this needs the package {package}: pip install {package}") from error


def rotations(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation matrices (n, 3, 3) of poses (n, 7)."""
    w, x, y, z = poses[:, 3:].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def placed(shapes: list[Any], shape_ids: NDArray[Any], poses: NDArray[np.float64]) -> list[Surface]:
    """The surfaces of posed bodies."""
    known = [(shape.vertices, shape.triangles) for shape in shapes]
    turns = rotations(poses)
    return [
        (known[k][0] @ turn.T + pose[:3], known[k][1]) for k, turn, pose in zip(shape_ids, turns, poses, strict=True)
    ]


def joined(surfaces: Iterable[Surface], ids: Iterable[int]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """All surfaces as one: vertices, triangles, and the body of each triangle."""
    points: list[NDArray[Any]] = [np.zeros((0, 3))]
    cells: list[NDArray[Any]] = [np.zeros((0, 3), dtype=np.int64)]
    body: list[NDArray[Any]] = [np.zeros(0, dtype=np.int64)]
    count = 0
    for (vertices, triangles), number in zip(surfaces, ids, strict=True):
        points.append(vertices)
        cells.append(triangles.astype(np.int64) + count)
        body.append(np.full(len(triangles), number, dtype=np.int64))
        count += len(vertices)
    return np.concatenate(points), np.concatenate(cells), np.concatenate(body)


def polydata(points: NDArray[Any], triangles: NDArray[Any], cell_data: dict[str, NDArray[Any]]) -> Any:
    """A surface for PyVista."""
    sizes = np.full((len(triangles), 1), 3, dtype=np.int64)
    mesh = need("pyvista").PolyData(points, np.hstack([sizes, triangles.astype(np.int64)]).ravel())
    for name, values in cell_data.items():
        mesh.cell_data[name] = values
    return mesh


class Bodies:
    """What worlds and results of bodies have in common: their surfaces, for other packages."""

    __slots__ = ()

    def _surfaces(self) -> tuple[list[int], list[Surface]]:
        raise NotImplementedError

    def _columns(self) -> dict[str, Any]:
        raise NotImplementedError

    def to_pyvista(self) -> Any:
        """The surfaces of all bodies as one ``pyvista.PolyData``, with the number of the body in each cell."""
        ids, surfaces = self._surfaces()
        points, triangles, body = joined(surfaces, ids)
        return polydata(points, triangles, {"body": body})

    def to_trimesh(self) -> Any:
        """The bodies as a ``trimesh.Scene``, one geometry each."""
        trimesh = need("trimesh")
        scene = trimesh.Scene()
        for number, (points, triangles) in zip(*self._surfaces(), strict=True):
            scene.add_geometry(trimesh.Trimesh(points, triangles, process=False), geom_name=f"body {number}")
        return scene

    def to_meshio(self) -> Any:
        """The surfaces of all bodies as one ``meshio.Mesh``, with the number of the body in each cell."""
        ids, surfaces = self._surfaces()
        points, triangles, body = joined(surfaces, ids)
        return need("meshio").Mesh(points, [("triangle", triangles)], cell_data={"body": [body]})

    def to_dataframe(self) -> Any:
        """The bodies as a ``pandas.DataFrame``, one row each."""
        return need("pandas").DataFrame(self._columns())
