"""Contacts for hosts that own the bodies and their motion."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _femdem
from ._options import MATERIALS, as_json, bodies_list, entry, index, vector
from ._shape import Shape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ids = int | Sequence[int] | NDArray[Any]


class ContactBatch:
    """The contacts of rigid bodies and walls that a host moves: of its own integrator, or of another engine.

    Keywords are parameters of the contact law, as those of :class:`World`: ``friction``, ``penalty`` (Pa), ``damping_ratio`` ...
    The batch finds the pairs and keeps the history of friction; it knows no gravity and moves nothing. A step of a host::

        forces, torques = batch.update(poses, velocities, angular_velocities, dt=dt)
        # ... integrate with these and its own loads

    Arrays have a row for each body, in the order of :attr:`ids`. Velocities are those of the half step before, as leapfrog and
    semi-implicit Euler integrators have them: the dashpots allow for their lag. One thread at a time uses a batch.
    """

    __slots__ = ("_batch",)
    _batch: _femdem.ContactBatch

    def __init__(self, **contact: Any) -> None:
        self._batch = _femdem.ContactBatch(as_json("ContactBatch", contact))

    @classmethod
    def from_bytes(cls, data: bytes) -> ContactBatch:
        """The batch of :meth:`to_bytes`, which goes on with the same bits."""
        made = cls.__new__(cls)
        made._batch = _femdem.ContactBatch.from_bytes(data)
        return made

    def to_bytes(self) -> bytes:
        """The whole state, for :meth:`from_bytes` of the same version."""
        return self._batch.to_bytes()

    # Bodies and walls.

    def add(self, shape: Shape, density: float, *, count: int = 1, material: int = 0) -> NDArray[np.uint32]:
        """Adds ``count`` rigid bodies of one shape and a density (kg/m^3), and returns their numbers.

        The batch needs their masses for its dashpots and for :attr:`stable_step`; the host finds them in :attr:`masses` and
        :attr:`inertias`. ``material`` chooses their contact laws (:meth:`set_law`). Numbers of removed bodies come again.
        """
        if (number := index("count", count)) == 0:
            raise _femdem.FemdemError("count = 0 is not allowed: give 1 or more")
        return self._batch.add(shape._shape, density, number, index("material", material, MATERIALS))

    def add_wall(self, name: str, *, material: int = 0, **wall: Any) -> list[int]:
        """Adds a wall, described by one of the keys of a wall in a scene, and returns its number; a box has several.

        See :meth:`World.add_wall`. It stands still until :meth:`move_wall`.
        """
        for key in ("control", "motion", "opens"):
            if key in wall:
                raise _femdem.FemdemError(f"{key} is for worlds and scenes: leave it out, and use move_wall or remove_wall")
        return self._batch.add_wall(name, entry("wall", wall), index("material", material, MATERIALS))

    def move_wall(
        self,
        wall: int,
        pose: ArrayLike,
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
        angular_velocity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Puts a wall at a pose (7,), counted from where it was added, from the next update on.

        ``velocity`` (m/s) is that of its origin, ``angular_velocity`` in rad/s; they stay until the next call.
        """
        motion = (vector("velocity", velocity), vector("angular_velocity", angular_velocity))
        self._batch.move_wall(index("wall", wall), pose, *motion)

    def remove(self, bodies: Ids) -> NDArray[np.uint32]:
        """Removes bodies, all of them or none, and returns those that they touched."""
        return self._batch.remove(bodies_list(bodies))

    def remove_wall(self, wall: int) -> NDArray[np.uint32]:
        """Removes a wall, and returns the bodies that touched it."""
        return self._batch.remove_wall(index("wall", wall))

    def put_elsewhere(self, bodies: Ids) -> None:
        """Tells that the host puts bodies elsewhere by hand, and does not move them there: their contacts end, with friction."""
        self._batch.put_elsewhere(bodies_list(bodies))

    # Laws.

    @property
    def contact(self) -> dict[str, Any]:
        """Parameters of the contact law of all materials without a law of their own."""
        found: dict[str, Any] = json.loads(self._batch.contact())
        return found

    def set_contact(self, **contact: Any) -> None:
        """Replaces parameters of that law; the others stay."""
        self._batch.set_contact(as_json("contact", {**self.contact, **contact}))

    def set_law(self, a: int, b: int, **contact: Any) -> None:
        """Gives two materials a law: that of all with these parameters changed; without any, it is that again."""
        law = as_json("law", {**self.contact, **contact}) if contact else None
        self._batch.set_law(index("a", a, MATERIALS), index("b", b, MATERIALS), law)

    # The step.

    def update(
        self,
        poses: ArrayLike,
        velocities: ArrayLike | None = None,
        angular_velocities: ArrayLike | None = None,
        *,
        dt: float,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Finds all contacts, and returns the forces (n, 3), N, and the torques (n, 3) about the centroids, N m.

        ``poses`` (n, 7) take the coordinates of each shape to the world: x, y, z, qw, qx, qy, qz. ``velocities`` (n, 3) are those
        of the centroids, m/s, ``angular_velocities`` (n, 3) in rad/s; all vectors are in world axes. Velocities that are left out
        are 0. ``dt`` is the step since the last update, s: friction advances by it; 0 for the first. The interpreter lock is
        released.
        """
        forces, torques = self._batch.update(poses, velocities, angular_velocities, dt)
        return forces, torques

    # The state, as of the last update.

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Numbers of the bodies, ascending."""
        return self._batch.ids

    @property
    def shapes(self) -> list[Shape]:
        """The shape of each body."""
        return [Shape._of(shape) for shape in self._batch.shapes]

    @property
    def masses(self) -> NDArray[np.float64]:
        """Masses (n,), kg."""
        return self._batch.masses

    @property
    def inertias(self) -> NDArray[np.float64]:
        """Inertia tensors (n, 3, 3) about the centroids, in the axes of the shapes, kg m^2."""
        return self._batch.inertias.reshape(-1, 3, 3)

    @property
    def centroids(self) -> NDArray[np.float64]:
        """Centroids (n, 3) in the coordinates of the shapes, m."""
        return self._batch.centroids

    @property
    def forces(self) -> NDArray[np.float64]:
        """Forces (n, 3), N: what :meth:`update` returned."""
        return self._batch.loads()[0]

    @property
    def torques(self) -> NDArray[np.float64]:
        """Torques (n, 3) about the centroids, N m."""
        return self._batch.loads()[1]

    def contacts(self) -> dict[str, NDArray[Any]]:
        """The contacts as columns: see :meth:`World.contacts`."""
        return self._batch.contacts()

    @property
    def walls(self) -> dict[int, dict[str, Any]]:
        """The walls by number: ``name``, and the ``force`` (N) and ``torque`` (N m) about the origin that bear on it."""
        return {
            number: {"name": name, "force": np.array(force), "torque": np.array(torque)}
            for number, name, force, torque in self._batch.walls()
        }

    @property
    def stable_step(self) -> float:
        """The largest step for which these contacts are stable, s; infinite without any. Take a small part of it."""
        return self._batch.stable_step

    @property
    def totals(self) -> Mapping[str, float]:
        """Sums: ``energy`` of the contacts and ``spring_energy`` of friction, J; ``candidates``, pairs that were evaluated, and
        ``touching``, those in touch."""
        names = ("energy", "spring_energy", "candidates", "touching")
        return dict(zip(names, self._batch.totals, strict=True))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_bytes, (self.to_bytes(),)

    def __len__(self) -> int:
        return len(self._batch)

    def __repr__(self) -> str:
        return f"ContactBatch({len(self)} bodies, {len(self.walls)} walls, {self.totals['touching']} pairs in touch)"
