"""Shapes of bodies."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _femdem, _others
from ._options import index

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


class Shape:
    """A closed surface, convex or not: the form of bodies.

    ``Shape("dolos:waist=0.36", size=0.3)`` is a shape of ``femdem shapes``, with parameters as on the command line, by its
    size or its circumscribed ``diameter`` in m. ``Shape("sphere", diameter=0.02)`` is the exact ball. See also
    :meth:`from_arrays`, :meth:`from_tetrahedra`, :meth:`convex_hull` and :meth:`from_file`.

    A rigid body that is not convex gets tetrahedra for its contacts; ``mesh_size`` is their edge length over the diameter.
    """

    __slots__ = ("_shape",)
    _shape: _femdem.Shape

    def __init__(
        self, name: str, *, size: float | None = None, diameter: float | None = None, mesh_size: float | None = None
    ) -> None:
        self._shape = _femdem.Shape.named(name, size, diameter, mesh_size)

    @classmethod
    def _of(cls, shape: _femdem.Shape) -> Shape:
        made = cls.__new__(cls)
        made._shape = shape
        return made

    @classmethod
    def from_arrays(
        cls,
        vertices: ArrayLike,
        faces: Sequence[Sequence[int]] | NDArray[Any],
        *,
        name: str = "body",
        mesh_size: float | None = None,
    ) -> Shape:
        """A surface of vertices (n, 3) in m and faces: rows of an array, or lists of vertices, counter-clockwise from outside."""
        lists = [[index(f"faces[{k}]", i) for i in face] for k, face in enumerate(faces)]
        return cls._of(_femdem.Shape.of_arrays(name, vertices, lists, mesh_size))

    @classmethod
    def from_tetrahedra(
        cls, points: ArrayLike, tets: Sequence[Sequence[int]] | NDArray[Any], *, name: str = "body"
    ) -> Shape:
        """A body of tetrahedra (n, 4) of points (m, 3) in m, which deformable bodies of it have as they are given.

        Of a file that meshio reads: ``Shape.from_tetrahedra(mesh.points, mesh.cells_dict["tetra"])``.
        """
        lists = [[index(f"tets[{k}]", i) for i in tet] for k, tet in enumerate(tets)]
        if any(len(corners) != 4 for corners in lists):
            raise _femdem.FemdemError("tets needs four points in each row: give an array (n, 4)")
        return cls._of(_femdem.Shape.of_tetrahedra(name, points, lists))

    @classmethod
    def convex_hull(cls, points: ArrayLike, *, name: str = "hull") -> Shape:
        """The convex hull of points (n, 3) in m."""
        return cls._of(_femdem.Shape.of_arrays(name, points, None, None))

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        *,
        unit: str = "m",
        repair: bool = False,
        diameter: float | None = None,
        mesh_size: float | None = None,
    ) -> Shape:
        """The surface in an OBJ, STL, OFF or PLY file, with coordinates in ``unit``, or scaled to a ``diameter`` in m; or the
        tetrahedra in a MSH file of Gmsh."""
        return cls._of(_femdem.Shape.of_file(os.fspath(path), unit, repair, diameter, mesh_size))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the surface, in m, into an OBJ, STL, OFF or PLY file, by the ending of its name."""
        self._shape.save(os.fspath(path))

    @property
    def name(self) -> str:
        """Name, as it appears in results."""
        return self._shape.name

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices (n, 3), m."""
        return self._shape.vertices

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """The faces, divided into triangles (m, 3)."""
        return self._shape.triangles

    @property
    def faces(self) -> list[list[int]]:
        """The faces as lists of vertices."""
        return self._shape.faces

    @property
    def volume(self) -> float:
        """Volume, m^3."""
        return self._shape.volume

    @property
    def area(self) -> float:
        """Area of the surface, m^2; of a ball that of its picture."""
        return self._shape.area

    @property
    def diameter(self) -> float:
        """Diameter of the sphere about the centroid that holds it, m."""
        return self._shape.diameter

    @property
    def centroid(self) -> NDArray[np.float64]:
        """Centroid (3,), m."""
        return self._shape.centroid

    @property
    def is_convex(self) -> bool:
        """Whether it is convex."""
        return self._shape.is_convex

    @property
    def is_ball(self) -> bool:
        """Whether it is the exact ball, of which the vertices are a picture."""
        return self._shape.is_ball

    @property
    def is_picture(self) -> bool:
        """Whether it is drawn and measured only, and not for bodies: the shapes of a :class:`Result` are."""
        return self._shape.is_picture

    def to_trimesh(self) -> Any:
        """The surface as a ``trimesh.Trimesh``."""
        return _others.need("trimesh").Trimesh(self.vertices, self.triangles, process=False)

    def to_pyvista(self) -> Any:
        """The surface as a ``pyvista.PolyData``."""
        return _others.polydata(self.vertices, self.triangles, {})

    def to_meshio(self) -> Any:
        """The surface as a ``meshio.Mesh``."""
        return _others.need("meshio").Mesh(self.vertices, [("triangle", self.triangles)])

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._shape.to_bytes(),)

    def __repr__(self) -> str:
        kind = "ball" if self.is_ball else f"{len(self.vertices)} vertices"
        return f"Shape({self.name!r}, {kind}, {self.volume:.4g} m^3)"


def _restored(data: bytes) -> Shape:
    return Shape._of(_femdem.Shape.from_bytes(data))
