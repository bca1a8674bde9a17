"""Worlds: bodies between walls that you step yourself."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _femdem
from ._options import MATERIALS, as_json, bodies_list, entries, entry, index, vector
from ._others import Bodies, Surface, need, placed
from ._shape import Shape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ids = int | Sequence[int] | NDArray[Any]
_STEPS = 2**63
# Bonds of scenes name their groups.
_GROUPS = ["bodies", "others"]


class World(Bodies):
    """Rigid and deformable bodies between walls.

    ``gravity`` is in m/s^2. ``contact`` are parameters of the contact law between all materials without a law of their own:
    ``friction``, ``wall_friction``, ``penalty`` (Pa), ``rolling_friction``, ``damping_ratio``, ``tangential_ratio``,
    ``tangential_damping``, ``cohesion`` (Pa), ``adhesion_energy`` (J/m^2), ``liquid_bridge``. ``time_step`` has ``safety``,
    ``largest`` (s) and ``implicit``; ``sleeping`` is ``False`` or a dict of rules; ``medium`` has ``drag`` (1/s) and
    ``local_damping``. The Rust documentation of ``WorldParameters`` has their meanings and defaults.

    Bodies have numbers, which stay until they are removed; arrays of all bodies are in the order of :attr:`ids`. While
    another thread steps a world, it cannot be used. It is pickled through its checkpoint, and goes on with the same bits.
    """

    __slots__ = ("_world",)
    _world: _femdem.World

    def __init__(
        self,
        *,
        gravity: Sequence[float] = (0.0, 0.0, -9.81),
        time_step: Mapping[str, Any] | None = None,
        sleeping: bool | Mapping[str, Any] = True,
        medium: Mapping[str, Any] | None = None,
        **contact: Any,
    ) -> None:
        if isinstance(sleeping, bool):
            sleeping = {"enabled": sleeping}
        parameters = {
            "gravity": vector("gravity", gravity),
            "contact": contact,
            "time_step": time_step,
            "sleeping": sleeping,
            "medium": medium,
        }
        self._world = _femdem.World(as_json("World", parameters))

    @classmethod
    def _of(cls, world: _femdem.World) -> World:
        made = cls.__new__(cls)
        made._world = world
        return made

    @classmethod
    def from_folder(cls, folder: str | os.PathLike[str]) -> World:
        """The world in the checkpoint of a pack or a run, with its controlled walls. Sources, openings and loads that turn or
        change stay behind."""
        return cls._of(_femdem.World.from_folder(os.fspath(folder)))

    @classmethod
    def from_bytes(cls, data: bytes) -> World:
        """The world of :meth:`to_bytes`."""
        return cls._of(_femdem.World.from_bytes(data))

    def to_bytes(self) -> bytes:
        """The whole state, for :meth:`from_bytes` of the same version."""
        return self._world.to_bytes()

    # Bodies and walls.

    def add(
        self,
        shape: Shape,
        poses: ArrayLike,
        density: float | Sequence[float],
        *,
        velocity: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        material: int = 0,
        motion: Mapping[str, Any] | None = None,
    ) -> NDArray[np.uint32]:
        """Adds rigid bodies of one shape at poses (n, 7) and returns their numbers; all of them, or none.

        ``density`` is in kg/m^3, velocities (n, 3) in m/s and rad/s, or (3,) for all. ``material`` chooses their contact
        laws (:meth:`set_law`). ``motion`` prescribes their motion, as the key ``motion`` of a body in a scene does.
        """
        text = None if motion is None else entry("motion", motion)
        kind = index("material", material, MATERIALS)
        return self._world.add(shape._shape, poses, density, velocity, angular_velocity, kind, text)

    def add_deformable(
        self,
        shape: Shape,
        poses: ArrayLike,
        matter: Mapping[str, Any],
        *,
        velocity: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        material: int = 0,
        mesh_size: float | None = None,
        element: str = "t4",
        contact_ratio: float = 1.0,
        boundary: Sequence[Mapping[str, Any]] = (),
    ) -> NDArray[np.uint32]:
        """Adds deformable bodies of one shape at poses (n, 7) and returns their numbers; all of them, or none.

        ``matter`` has the keys of a material in a scene: ``density``, ``law``, ``young``, ``poisson`` and those of the law.
        With a ``fracture`` (``tensile``, ``cohesion``, ``friction_angle``, ``energy`` ...) they break: :meth:`cracks`.
        ``mesh_size`` is the edge length of the tetrahedra over the diameter, 0.2 if left out; a shape of tetrahedra has its
        own. ``element`` is ``t4``, ``t4_nodal_pressure``, ``t10`` or ``t10_fbar``; ``contact_ratio`` the stiffness of the
        contacts over that of the body, which scenes with prescribed motions take as 10. ``boundary`` are
        conditions as in a scene, on nodes chosen in the coordinates of the shape:
        ``[{"select": {"plane": {"normal": [0, 0, 1], "offset": -0.05}}, "fix": True}]``; see :meth:`release`. The times of
        ``rise`` and ``table`` are those of the world, not since the body was added.
        """
        text = entry("matter", matter)
        kind = index("material", material, MATERIALS)
        conditions = entries("boundary", boundary)
        options = (velocity, angular_velocity, kind, mesh_size, element, contact_ratio, conditions)
        return self._world.add_deformable(shape._shape, poses, text, *options)

    def add_wall(self, name: str, *, material: int = 0, **wall: Any) -> list[int]:
        """Adds a wall, described by one of the keys of a wall in a scene, and returns its number; a box has several.

        ``plane={"normal": [0, 0, 1], "offset": 0}``, ``box={"lower": [...], "upper": [...], "open": True}``, ``cylinder``,
        ``cone``, ``silo``, ``hopper``, ``plate``, ``file``; and ``motion``, or ``control``: a servo that moves a plane so that it
        presses with ``control={"force": 20, "speed": 0.1}``, N and m/s, or the walls of a box under a ``stress`` (Pa) or
        ``strain_rate`` (1/s) along ``x``, ``y`` and ``z``; see :attr:`controlled_cells`.
        """
        if "opens" in wall:
            raise _femdem.FemdemError("opens is for the walls of scenes: leave it out, and use remove_wall")
        return self._world.add_wall(name, entry("wall", wall), index("material", material, MATERIALS))

    def drive_wall(self, wall: int, motion: Mapping[str, Any] | None) -> None:
        """Gives a wall another motion, counted from where it is; ``None`` holds it. The control of it ends, and that of walls
        which move with it: they stand."""
        self._world.drive_wall(index("wall", wall), None if motion is None else entry("motion", motion))

    def remove_wall(self, wall: int) -> None:
        """Removes a wall."""
        self._world.remove_wall(index("wall", wall))

    def remove(self, bodies: Ids) -> None:
        """Removes bodies; all of them, or none. Their numbers are given to the next ones."""
        self._world.remove(bodies_list(bodies))

    def release(self, body: int) -> None:
        """Takes all boundary conditions off a deformable body."""
        self._world.release(index("body", body))

    def add_bonds(self, bodies: Ids, others: Ids | None = None, *, gap: float, **law: Any) -> NDArray[np.uint32]:
        """Bonds the rigid bodies of two groups that nearly touch, as they lie, and returns the numbers of the bonds.

        As ``[[bond]]`` in a scene, with its keys: two spheres, or two facing faces of convex bodies, at most ``gap`` (m) apart get
        a bond of ``stiffness`` (Pa/m), the strengths ``tensile`` and ``cohesion`` (Pa) and the energies of fracture
        ``energy=[opening, sliding]`` (J/m^2); further ``ratio`` of the section to the smaller radius or to the common face,
        ``friction``, ``mix``, ``softening``, ``damping``. Without ``others`` it bonds ``bodies`` with each other.
        """
        if "between" in law:
            raise _femdem.FemdemError("between is for scenes: give bodies and others")
        group = bodies_list(bodies)
        second = group if others is None else bodies_list(others)
        return self._world.add_bonds(group, second, entry("bonds", {"between": _GROUPS, "gap": gap, **law}))

    def add_bond(self, a: int, b: int, corners: ArrayLike, **law: Any) -> int:
        """Bonds two rigid bodies of any shape over a convex polygon of corners (n, 3) in the world, m, and returns the number.

        ``law`` has the keys of :meth:`add_bonds` but for ``gap`` and ``ratio``. Several polygons between two bodies are the parts
        of one section, a bond each: they must not overlap.
        """
        for key in ("between", "gap", "ratio"):
            if key in law:
                raise _femdem.FemdemError(f"{key} is for add_bonds: leave it out, the corners are the section")
        text = entry("bond", {"between": _GROUPS, "gap": 0.0, **law})
        return self._world.add_bond([index("a", a), index("b", b)], corners, text)

    # What a host changes: all of the bodies that are given, or none.

    def set_pose(self, bodies: Ids, poses: ArrayLike) -> None:
        """Puts rigid bodies at poses (n, 7), with their velocities. Their contacts end."""
        self._world.set_pose(bodies_list(bodies), poses)

    def set_velocity(
        self, bodies: Ids, velocity: ArrayLike | None = None, angular_velocity: ArrayLike | None = None
    ) -> None:
        """Sets velocities (n, 3), m/s, and angular velocities, rad/s, of rigid bodies; what is left out stays."""
        self._world.set_velocity(bodies_list(bodies), velocity, angular_velocity)

    def set_load(self, bodies: Ids, force: ArrayLike | None = None, torque: ArrayLike | None = None) -> None:
        """Loads bodies with forces (n, 3), N, and torques about their centroids, N m, until they are set again."""
        self._world.set_load(bodies_list(bodies), force, torque)

    def drive(self, bodies: Ids, motion: Mapping[str, Any] | None) -> None:
        """Gives rigid bodies a prescribed motion, counted from where they are; ``None`` sets them free."""
        self._world.drive(bodies_list(bodies), None if motion is None else entry("motion", motion))

    def set_contact(self, **contact: Any) -> None:
        """Replaces parameters of the contact law of all materials without a law of their own; the others stay."""
        self._world.set_contact(as_json("contact", {**self.parameters["contact"], **contact}))

    def set_law(self, a: int, b: int, **contact: Any) -> None:
        """Gives two materials a contact law: that of the world with these parameters changed; without any, it is that again."""
        law = as_json("law", {**self.parameters["contact"], **contact}) if contact else None
        self._world.set_law(index("a", a, MATERIALS), index("b", b, MATERIALS), law)

    def set_gravity(self, gravity: Sequence[float]) -> None:
        """Replaces the acceleration of gravity, m/s^2. Bodies wake."""
        self._world.set_gravity(vector("gravity", gravity))

    def set_cell(self, sides: Sequence[float | None]) -> None:
        """Makes space periodic over three lengths, m; ``None`` for those along which it is not."""
        lengths = [None if x is None else float(x) for x in sides]
        if len(lengths) != 3:
            raise _femdem.FemdemError(f"sides = {lengths} is not allowed: give three lengths or None")
        self._world.set_cell(lengths)

    def deform_cell(self, rates: ArrayLike) -> None:
        """Lets the edges of the cell move with velocities (3, 3), m/s, its columns, and all free bodies with space. A control of
        the cell ends."""
        matrix = np.asarray(rates, dtype=np.float64)
        if matrix.shape != (3, 3):
            raise _femdem.FemdemError(f"rates has the shape {matrix.shape}, and (3, 3) is needed")
        self._world.deform_cell(matrix.tolist())

    def control_cell(self, **control: Any) -> None:
        """Lets a cell that repeats itself along all axes follow ``x``, ``y`` and ``z``, each a dict of a ``stress`` (Pa) with the
        largest ``speed`` (m/s) or of a ``strain_rate`` (1/s), and ``shear={"rate": ...}`` (1/s), as in a scene. Without any it
        keeps its edges."""
        self._world.control_cell(entry("control", control) if control else None)

    def set_sleeping(self, enabled: bool) -> None:
        """Whether bodies at rest are frozen."""
        self._world.set_sleeping(enabled)

    def restart_ledger(self) -> None:
        """Begins the energy ledger anew."""
        self._world.restart_ledger()

    # The step.

    def step(
        self,
        steps: int | None = None,
        *,
        until: float | None = None,
        callback: Callable[[World], Any] | None = None,
        every: int | None = None,
    ) -> int:
        """Takes ``steps`` steps (1 if nothing is said), or as many as the time ``until`` (s) needs; returns their number.

        The interpreter lock is released. ``callback(world)`` is called after every ``every`` steps and at the end; if it
        returns ``False``, stepping ends. Ctrl-C ends it between two steps; the world can go on.
        """
        if steps is None:
            steps = 1 if until is None else _STEPS
        steps = index("steps", steps, _STEPS + 1)
        if until is not None and math.isnan(until):
            raise _femdem.FemdemError(f"until = {until} is not allowed: give a time in s")
        end = math.inf if until is None else until
        if callback is None:
            if every is not None:
                raise _femdem.FemdemError(f"every = {every} is for a callback: give one, or leave it out")
            return self._world.step(steps, end)
        if every is not None and index("every", every, _STEPS) == 0:
            raise _femdem.FemdemError(f"every = {every} is not allowed: give 1 or more")
        taken = 0
        while taken < steps:
            some = self._world.step(min(every or steps, steps - taken), end)
            taken += some
            if some == 0 or _is_false(callback(self)):
                break
        return taken

    # The state.

    @property
    def parameters(self) -> dict[str, Any]:
        """Gravity, contact law, time step, rules of sleep and medium."""
        found: dict[str, Any] = json.loads(self._world.parameters())
        return found

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self._world.time

    @property
    def steps(self) -> int:
        """Steps taken."""
        return self._world.steps

    @property
    def time_step(self) -> float:
        """The present step, s; 0 before the first."""
        return self._world.time_step

    @property
    def stable_step(self) -> float:
        """The bound of stability from which the step was chosen, s; infinite without contact."""
        return self._world.stable_step

    def stability(self) -> tuple[float, float] | None:
        """The measured limit of the step, and the present step, s; ``None`` without contacts. Costs about 60 steps."""
        return self._world.stability()

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Numbers of all bodies, ascending."""
        return self._world.ids

    @property
    def rigid_ids(self) -> NDArray[np.uint32]:
        """Numbers of the rigid bodies."""
        return self._world.rigid_ids

    @property
    def deformable_ids(self) -> NDArray[np.uint32]:
        """Numbers of the deformable bodies."""
        return self._world.deformable_ids

    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses (n, 7) of the rigid bodies: x, y, z, qw, qx, qy, qz."""
        return self._world.poses

    @property
    def positions(self) -> NDArray[np.float64]:
        """Centres of mass (n, 3) of all bodies, m."""
        return self._world.positions

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities (n, 3) of the centres of mass of all bodies, m/s."""
        return self._world.velocities

    @property
    def angular_velocities(self) -> NDArray[np.float64]:
        """Angular velocities (n, 3) of the rigid bodies, rad/s."""
        return self._world.angular_velocities

    @property
    def masses(self) -> NDArray[np.float64]:
        """Masses (n,) of all bodies, kg."""
        return self._world.masses

    @property
    def kinetic_energies(self) -> NDArray[np.float64]:
        """Kinetic energies (n,) of all bodies, J."""
        return self._world.kinetic_energies

    @property
    def asleep(self) -> NDArray[np.bool_]:
        """Whether each body is frozen."""
        return self._world.asleep

    @property
    def shapes(self) -> list[Shape]:
        """The rigid shapes, to add more bodies of them; :attr:`shape_ids` tells which bodies have which."""
        return [Shape._of(shape) for shape in self._world.shapes]

    @property
    def shape_ids(self) -> NDArray[np.uint32]:
        """Index of the shape of each rigid body."""
        return self._world.shape_ids

    def contacts(self) -> dict[str, NDArray[Any]]:
        """The contacts as columns: partners ``a`` and ``b``, ``point`` (m), ``normal`` from a to b, ``force`` on b (N) and its
        parts ``normal_force`` and ``friction``, ``area`` (m^2), ``volume`` (m^3), ``energy`` (J), ``slides``. A wall w is
        a = -1 - w."""
        return self._world.contacts()

    @property
    def walls(self) -> dict[int, dict[str, Any]]:
        """The walls by number: ``name``, and the ``force`` (N) and ``torque`` (N m) about the origin that bear on it."""
        return {
            number: {"name": name, "force": np.array(force), "torque": np.array(torque)}
            for number, name, force, torque in self._world.walls()
        }

    def nodes(self, body: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities (n, 3) of the nodes of a deformable body, m and m/s."""
        places, velocities = self._world.nodes(index("body", body))
        return places, velocities

    def cells(self, body: int) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Tetrahedra (n, 4) of a deformable body and triangles (m, 3) of its skin, by its nodes."""
        return self._world.cells(index("body", body))

    def stresses(self, body: int) -> NDArray[np.float64]:
        """Cauchy stresses (n, 6) in the tetrahedra of a deformable body, Pa: xx, yy, zz, xy, yz, zx."""
        return self._world.stresses(index("body", body))

    def bonds(self) -> dict[str, NDArray[Any]]:
        """All bonds as columns, those that have ended too: ``bond``, its bodies ``a`` and ``b``, ``area`` (m^2), ``centre`` (m),
        ``normal`` from a to b, ``force`` with which b pulls a (N), ``moment`` on a about the centre (N m), ``tension`` (Pa),
        ``energy`` and ``dissipated`` (J), ``damage`` from 0 to 1, ``mode`` (0 gave way by opening, 1 by sliding), ``broken``,
        ``broken_at`` (s, NaN before), and ``ended``: the bodies meet by contact again."""
        return self._world.bonds()

    def bonded_with(self, body: int) -> NDArray[np.uint32]:
        """The bodies that bonds which have not ended, broken ones too, link with one; itself included."""
        return self._world.bonded_with(index("body", body))

    def bonded_pieces(self) -> list[NDArray[np.uint32]]:
        """The bodies that were ever bonded, by the pieces that bonds which are not broken hold together."""
        return self._world.bonded_pieces()

    def cracks(self, body: int) -> dict[str, NDArray[Any]]:
        """The facets of a breakable body that are cut, as columns: ``elements`` beside them (n, 2; -1 for one of another
        body, which has the facet too), ``corners`` (n, 3, 3) midway between the sides (m),
        ``opening`` and ``slip`` (m), ``damage`` from 0 to 1, ``sheared`` or pulled apart, ``birth`` and ``broken_at`` (s, NaN
        before), ``dissipated`` (J)."""
        columns = self._world.cracks(index("body", body))
        return {**columns, "corners": columns["corners"].reshape(-1, 3, 3)}

    def crack_facts(self, body: int) -> dict[str, float]:
        """Of a breakable body: ``process_zone`` of its material and ``element_height``, which should be at most
        ``largest_height`` (m), ``highest`` stress over strength at the last look, ``energy`` stored in its cracks (J)."""
        names = ("process_zone", "element_height", "largest_height", "highest", "energy")
        return dict(zip(names, self._world.crack_facts(index("body", body)), strict=True))

    def fragments(self, body: int) -> NDArray[np.uint32]:
        """The fragment (n,) of each tetrahedron of a breakable body: facets join them that are not broken."""
        return self._world.fragments(index("body", body))

    def fragment_bodies(self) -> list[tuple[int, list[int]]]:
        """Makes bodies of the fragments of broken bodies, unless their fracture says ``fragments: "pieces"``: each body that had
        some, which is its largest fragment from then on, with the new bodies."""
        return self._world.fragment_bodies()

    @property
    def cell(self) -> NDArray[np.float64] | None:
        """The edges of the periodic cell as columns (3, 3), m; ``None`` without one."""
        edges = self._world.cell()
        return None if edges is None else np.array(edges)

    def cell_stress(self) -> NDArray[np.float64] | None:
        """Mean stress (3, 3) in a cell that repeats itself along all axes, Pa, positive in compression."""
        stress = self._world.cell_stress()
        return None if stress is None else np.array(stress)

    @property
    def controlled_cells(self) -> list[dict[str, Any]]:
        """The boxes with controlled walls, and a controlled cell: ``name``, ``sides`` (m), ``stress`` (Pa, positive in compression),
        ``strain``, ``solid_fraction``, and ``errors`` of the stresses that are controlled, over them."""
        found: list[dict[str, Any]] = json.loads(self._world.controlled_cells())
        return found

    def ledger(self) -> dict[str, float]:
        """The energy ledger, J; ``error`` is what is missing in it, and ``error_relative`` that over the energy turned over."""
        text, error, relative = self._world.ledger()
        return {**json.loads(text), "error": error, "error_relative": relative}

    def residuals(self) -> dict[str, Any]:
        """How far the bodies are from equilibrium."""
        found: dict[str, Any] = json.loads(self._world.residuals())
        return found

    def state_hash(self) -> int:
        """A checksum of the state of bodies, walls and contacts, to compare runs."""
        return self._world.state_hash()

    def to_meshio(self, body: int | None = None) -> Any:
        """The surfaces of all bodies as one ``meshio.Mesh``, with the number of the body in each cell; or the tetrahedra of a
        deformable ``body``, with the ``velocity`` of its nodes (m/s) and the ``stress`` in its cells (Pa)."""
        if body is None:
            return super().to_meshio()
        points, velocities = self.nodes(body)
        cells, data = [("tetra", self.cells(body)[0])], {"stress": [self.stresses(body)]}
        return need("meshio").Mesh(points, cells, point_data={"velocity": velocities}, cell_data=data)

    def _surfaces(self) -> tuple[list[int], list[Surface]]:
        ids, surfaces = self.rigid_ids.tolist(), placed(self.shapes, self.shape_ids, self.poses)
        for body in self.deformable_ids.tolist():
            ids.append(body)
            surfaces.append((self.nodes(body)[0], self.cells(body)[1]))
        return ids, surfaces

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"body": self.ids, "mass": self.masses, "asleep": self.asleep}
        for name, values in (("", self.positions), ("v", self.velocities)):
            columns.update({name + axis: values[:, k] for k, axis in enumerate("xyz")})
        return columns

    def __len__(self) -> int:
        return len(self._world)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_bytes, (self.to_bytes(),)

    def __repr__(self) -> str:
        contacts = len(self.contacts()["b"])
        return f"World({len(self)} bodies, {contacts} contacts, t = {self.time:.6g} s)"

    def _repr_html_(self) -> str:
        ledger = self.ledger()
        facts = {
            "bodies": len(self),
            "deformable": len(self.deformable_ids),
            "walls": ", ".join(wall["name"] for wall in self.walls.values()) or "none",
            "contacts": len(self.contacts()["b"]),
            "time": f"{self.time:.6g} s, {self.steps} steps",
            "kinetic energy": f"{ledger['kinetic']:.4g} J",
            "error of the ledger": f"{ledger['error_relative']:.1e}",
        }
        rows = "".join(f"<tr><th>{name}</th><td>{escape(str(value))}</td></tr>" for name, value in facts.items())
        return f"<table>{rows}</table>"


def _is_false(answer: Any) -> bool:
    return isinstance(answer, (bool, np.bool_)) and not answer
