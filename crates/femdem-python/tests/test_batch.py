"""Contacts for hosts: against mechanics and worlds, and what they refuse."""

import pickle

import numpy as np
import pytest
from conftest import lattice, place

import femdem

CUBE = femdem.Shape("box:width=1,height=1", size=0.1)
BALL = femdem.Shape("sphere", diameter=0.1)
FLOOR = {"plane": {"normal": [0, 0, 1]}}


def test_faces_press_as_the_penalty_says():
    batch = femdem.ContactBatch(penalty=1e6)
    assert batch.add(CUBE, 2000, count=2).tolist() == [0, 1]
    forces, torques = batch.update([place(0, 0, 0), place(0, 0, 0.0999)], dt=0)
    # p a^2 d (1/h + 1/h), h half the side; the rim takes off a little.
    assert forces[1] == pytest.approx([0, 0, 1e6 * 0.01 * 1e-4 * 40], rel=3e-3, abs=1e-9)
    assert np.array_equal(forces[0], -forces[1]) and np.abs(torques).max() < 1e-12
    assert batch.masses == pytest.approx([2, 2])
    assert batch.inertias == pytest.approx(np.stack([np.eye(3) * 2 * 0.01 / 6] * 2))
    contacts = batch.contacts()
    assert (contacts["a"].tolist(), contacts["b"].tolist()) == ([0], [1])
    assert batch.totals["energy"] == pytest.approx(forces[1, 2] * 1e-4 / 2, rel=3e-3)
    # A spring of stiffness k between equal masses is stable up to 2 sqrt(m/2k); with dashpots less.
    assert 0 < batch.stable_step < 2 * np.sqrt(2 / (2 * forces[1, 2] / 1e-4))
    assert np.array_equal(batch.forces, forces) and np.array_equal(batch.torques, torques)


def test_a_force_beside_the_centroid_turns():
    batch = femdem.ContactBatch(friction=0)
    batch.add(CUBE, 2000)
    batch.add_wall("floor", **FLOOR)
    half = np.pi / 8
    # On an edge along y, turned by 45 degrees and put down a little to one side of it.
    forces, torques = batch.update([0, 0, 0.0699, np.cos(half - 0.01), 0, np.sin(half - 0.01), 0], dt=0)
    arm = batch.contacts()["point"][0] - [0, 0, 0.0699]
    assert forces[0, 2] > 0 and abs(torques[0, 1]) > 1e-4 * forces[0, 2]
    assert torques[0] == pytest.approx(np.cross(arm, forces[0]), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(
    ("shape", "side", "tolerance"),
    [(BALL, 3, 0), (femdem.Shape("A10", diameter=0.1), 3, 1e-9), (femdem.Shape("dolos", size=0.14), 2, 1e-9)],
)
def test_the_loads_are_those_of_a_world(shape, side, tolerance):
    """Balls, whose axes do not matter, to the last bit."""
    law = {"friction": 0.0, "damping_ratio": 0.0, "penalty": 1e6}
    box = {"lower": [-0.01, -0.01, 0], "upper": [0.31, 0.31, 2]}
    world, batch = femdem.World(**law), femdem.ContactBatch(**law)
    for one in (world, batch):
        one.add_wall("box", box=box)
    world.add(shape, lattice(side, 0.099, 0.055), 2000)
    world.step(100)
    batch.add(shape, 2000, count=side**3)
    batch.update(world.poses, dt=0)
    ours, theirs = batch.contacts(), world.contacts()
    assert len(ours["a"]) > side**3 // 2
    for name in ("a", "b", "force", "point"):
        scale = np.abs(theirs[name]).max()
        assert np.abs(ours[name] - theirs[name]).max() <= tolerance * scale, name


def product(w, q):
    """The quaternion of a vector, times another."""
    return np.concatenate([[-w @ q[1:]], q[0] * w + np.cross(w, q[1:])])


def test_a_host_that_integrates_keeps_pace_with_a_world():
    """Balls on a slope with friction: leapfrog in NumPy."""
    law = {"friction": 0.4, "penalty": 1e6}
    world = femdem.World(sleeping=False, time_step={"largest": 1e-4, "safety": 0.5}, **law)
    batch = femdem.ContactBatch(**law)
    gravity = np.array([3.0, 0, -9.81])
    world.set_gravity(gravity)
    at = np.array([[0, 0, 0.05, 1, 0, 0, 0], [0.03, 0, 0.146, 1, 0, 0, 0]])
    world.add(BALL, at, 2000)
    batch.add(BALL, 2000, count=2)
    for one in (world, batch):
        one.add_wall("floor", **FLOOR)
    world.step(until=0.2)
    dt, poses = 1e-4, at.copy()
    v, w = np.zeros((2, 3)), np.zeros((2, 3))
    for k in range(round(world.time / dt)):
        forces, torques = batch.update(poses, v, w, dt=dt if k else 0)
        part = 1 if k else 0.5
        v += part * dt * (forces / batch.masses[:, None] + gravity)
        w += part * dt * torques / batch.inertias[:, :1, 0]
        poses[:, :3] += v * dt
        poses[:, 3:] += 0.5 * dt * np.stack([product(spin, turn) for spin, turn in zip(w, poses[:, 3:], strict=True)])
        poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1)[:, None]
    assert np.abs(poses[:, :3] - world.positions).max() < 2e-3 * np.abs(world.positions - at[:, :3]).max()


def test_the_batch_measures_how_far_bodies_travel():
    batch = femdem.ContactBatch()
    batch.add(CUBE, 2000, count=2)
    batch.update([place(0, 0, 0), place(5, 0, 0)], dt=0)
    assert batch.totals["touching"] == 0
    # A jump, without a velocity; and a creep.
    batch.update([place(0, 0, 0), place(0.0999, 0, 0)], dt=1e-4)
    assert batch.totals["touching"] == 1
    for x in np.linspace(0.2, 0.0999, 200):
        batch.update([place(0, 0, 0), place(x, 0, 0)], dt=1e-4)
    assert batch.totals["touching"] == 1
    # A turn alone brings an edge into the other.
    batch.update([place(0, 0, 0), place(0.11, 0, 0)], dt=1e-4)
    assert batch.totals["touching"] == 0
    batch.update([place(0, 0, 0), [0.11, 0, 0, np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)]], dt=1e-4)
    assert batch.totals["touching"] == 1


def test_bodies_and_walls_come_and_go():
    batch = femdem.ContactBatch()
    ids = batch.add(CUBE, 1000, count=3)
    batch.add(BALL, 1000)
    (floor,) = batch.add_wall("floor", **FLOOR)
    poses = np.array([place(0, 0, 0.0499), place(0, 0, 0.1498), place(1, 0, 0.0499), place(2, 0, 0.0499)])
    batch.update(poses, dt=0)
    assert batch.walls[floor]["force"][2] == pytest.approx(-batch.contacts()["normal_force"][batch.contacts()["a"] < 0].sum())
    assert batch.remove(ids[0]).tolist() == [1]
    assert batch.ids.tolist() == [1, 2, 3] and len(batch) == 3
    assert [shape.name for shape in batch.shapes] == [CUBE.name, CUBE.name, BALL.name]
    forces, _ = batch.update(poses[1:], dt=1e-4)
    assert forces[0].tolist() == [0, 0, 0] and forces[1, 2] > 0 and forces[2, 2] > 0
    assert batch.add(CUBE, 1000).tolist() == [0]
    assert batch.remove_wall(floor).tolist() == [2, 3]
    forces, _ = batch.update(poses, dt=1e-4)
    assert batch.walls == {} and forces[0, 2] == -forces[1, 2] < 0


def test_walls_move_and_their_speed_is_felt():
    batch = femdem.ContactBatch(friction=0.5)
    batch.add(CUBE, 2000)
    (floor,) = batch.add_wall("floor", **FLOOR)
    at = place(0, 0, 0.06)
    assert batch.update(at, dt=0)[0][0, 2] == 0
    batch.move_wall(floor, place(0, 0, 0.0101))
    still = batch.update(at, dt=1e-4)[0][0, 2]
    assert still > 0
    batch.move_wall(floor, place(0, 0, 0.0101), velocity=[0, 0, 0.1])
    assert batch.update(at, dt=1e-4)[0][0, 2] > 1.1 * still
    batch.move_wall(floor, place(0, 0, 0.0101), velocity=[0.1, 0, 0])
    assert batch.update(at, dt=1e-4)[0][0, 0] > 0
    # Upside down, and far away.
    batch.move_wall(floor, [0, 0, 5, 0, 1, 0, 0])
    assert batch.update(at, dt=1e-4)[0][0, 2] == 0


def test_materials_have_laws_and_friction_a_history():
    batch = femdem.ContactBatch(friction=0.5, damping_ratio=0, tangential_damping=0)
    batch.add(CUBE, 2000)
    batch.add(CUBE, 2000, material=1)
    batch.add_wall("floor", **FLOOR)
    batch.set_law(0, 1, friction=0.0)
    poses = np.array([place(0, 0, 0.0499), place(1, 0, 0.0499)])
    batch.update(poses, dt=0)
    poses[:, 0] += 1e-3
    pulled, _ = batch.update(poses, dt=1e-3, velocities=[1, 0, 0])
    assert pulled[0, 0] == pytest.approx(-0.5 * pulled[0, 2]) and pulled[1, 0] == 0
    # At rest the spring is still stretched; moved by hand it is gone.
    held, _ = batch.update(poses, dt=1e-3)
    assert held[0, 0] == pytest.approx(pulled[0, 0], rel=0.01)
    batch.put_elsewhere(0)
    assert batch.update(poses, dt=1e-3)[0][0, 0] == pytest.approx(0, abs=1e-9)
    batch.set_contact(friction=0.1)
    assert batch.contact["friction"] == 0.1 and batch.contact["damping_ratio"] == 0


def _shaken(batch, steps, start=0):
    poses = lattice(4, 0.0985, 0.05)
    found = []
    for k in range(start, start + steps):
        moved = poses.copy()
        moved[:, :3] += 1e-3 * np.sin(0.3 * k + np.arange(64 * 3).reshape(64, 3))
        found += batch.update(moved, 0.1 * np.cos(poses[:, :3] + k), dt=1e-4)
    return np.concatenate(found)


def test_threads_and_pickling_keep_the_bits():
    def made():
        batch = femdem.ContactBatch(friction=0.3)
        batch.add(femdem.Shape("A10", diameter=0.1), 2000, count=32)
        batch.add(CUBE, 2000, count=31)
        batch.add(BALL, 2000)
        batch.add_wall("box", box={"lower": [0, 0, 0], "upper": [0.4, 0.4, 0.4]})
        return batch

    femdem.set_threads(1)
    one = made()
    alone = _shaken(one, 30)
    again = pickle.loads(pickle.dumps(one))
    femdem.set_threads(3)
    assert np.array_equal(_shaken(made(), 30), alone)
    assert np.array_equal(_shaken(again, 20, 30), _shaken(one, 20, 30))
    assert again.remove(5).tolist() == one.remove(5).tolist()
    assert again.add(CUBE, 2000).tolist() == [5]


def test_a_batch_tells_what_it_is():
    batch = femdem.ContactBatch()
    batch.add(CUBE, 2000, count=2)
    batch.add_wall("floor", **FLOOR)
    batch.update([place(0, 0, 0.0499), place(1, 0, 1)], dt=0)
    assert repr(batch) == "ContactBatch(2 bodies, 1 walls, 1 pairs in touch)"
    assert np.abs(batch.centroids).max() < 1e-15 and femdem.ContactBatch().stable_step == np.inf


def test_centroids_off_the_origin():
    """A shape whose origin is a corner: the same forces, and torques about its centroid."""
    corner = femdem.Shape.from_arrays(CUBE.vertices + 0.05, CUBE.faces)
    pair = []
    for shape, shift in ((CUBE, 0.0), (corner, 0.05)):
        batch = femdem.ContactBatch()
        batch.add(shape, 2000)
        batch.add_wall("floor", **FLOOR)
        pair.append(batch.update(np.array(place(0, 0, 0.0499)) - [shift, shift, shift, 0, 0, 0, 0], dt=0))
    assert np.allclose(pair[0], pair[1], rtol=1e-9, atol=1e-9)


def test_turned_about_a_skew_axis_it_is_still_the_same_body():
    """Two in touch, off their origins and turned: forces, torques and inertias of the centred shape."""
    axis, angle = np.array([1.0, 2, -3]) / np.sqrt(14), 0.7
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    quaternion = [np.cos(angle / 2), *(np.sin(angle / 2) * axis)]
    slab, offset = CUBE.vertices * [1, 1.5, 0.5], np.array([0.05, -0.2, 0.3])
    centres = np.array([[0, 0, 0], turn @ [0.01, 0.02, 0.0499]])
    spins, found = [[1, 2, 3], [-2, 0, 1]], []
    for shift in (np.zeros(3), offset):
        batch = femdem.ContactBatch(friction=0.5, penalty=1e6)
        batch.add(femdem.Shape.from_arrays(slab + shift, CUBE.faces), 2000, count=2)
        assert batch.centroids == pytest.approx(np.stack([shift] * 2), abs=1e-12)
        for step in (0, 1e-4):
            poses = np.hstack([centres - turn @ shift + [step, 0, 0], [quaternion] * 2])
            forces, torques = batch.update(poses, [[1, 0, 0], [1, 0.5, 0]], spins, dt=step)
        found.append((forces, torques, batch.inertias))
    for centred, off in zip(*found, strict=True):
        assert np.abs(centred).max() > 0 and off == pytest.approx(centred, abs=1e-7 * np.abs(centred).max())
    # The push is along the turned normal of the faces, friction in their plane.
    push = turn.T @ found[0][0][1]
    assert push[2] > 0 and 0 < np.hypot(*push[:2]) <= 0.5001 * push[2]


def test_a_place_without_a_finite_way_spoils_nothing():
    batch = femdem.ContactBatch()
    batch.add(CUBE, 2000)
    (floor,) = batch.add_wall("floor", **FLOOR)
    at = place(0, 0, 0.0499)
    before, _ = batch.update(at, dt=0)
    far = place(0, 0, 1.3e154), place(0, 0, -1.3e154)
    batch.update(far[0], dt=0)
    with pytest.raises(femdem.FemdemError, match="pose of body 0 = .*-1.3e154.*must be finite"):
        batch.update(far[1], dt=1e-4)
    assert np.array_equal(batch.update(at, dt=1e-4)[0], before)
    batch.move_wall(floor, far[0])
    batch.update(far[0], dt=1e-4)
    batch.move_wall(floor, far[1])
    with pytest.raises(femdem.FemdemError, match="pose of wall 0 = .*-1.3e154.*must be finite"):
        batch.update(far[0], dt=1e-4)
    batch.move_wall(floor, place(0, 0, 0))
    assert np.array_equal(batch.update(at, dt=0)[0], before)
    # Nor does a wall that leaves without having moved.
    batch.move_wall(floor, far[1])
    batch.remove_wall(floor)
    assert batch.update(at, dt=1e-4)[0].tolist() == [[0, 0, 0]]


def test_damaged_bytes_are_refused_by_name():
    batch = femdem.ContactBatch(friction=0.5)
    batch.add(CUBE, 2000, count=2)
    batch.update([place(0, 0, 0), place(0, 0, 0.0999)], dt=0)
    shape = CUBE._shape
    for data, read in ((batch.to_bytes(), femdem.ContactBatch.from_bytes), (shape.to_bytes(), type(shape).from_bytes)):
        read(data)
        flipped = [data[:k] + bytes([data[k] ^ 16]) + data[k + 1 :] for k in (0, len(data) // 2, len(data) - 1)]
        for bad in (*flipped, data[:-1], data[: len(data) // 2], data + b"\0"):
            with pytest.raises(femdem.FemdemError, match="could not be decoded: its checksum does not match"):
                read(bad)
        with pytest.raises(femdem.FemdemError, match="it ends before its checksum"):
            read(data[:7])


REFUSALS = [
    (lambda b: femdem.ContactBatch(frictoin=1), ["frictoin", "friction"]),
    (lambda b: femdem.ContactBatch(penalty=-1), ["penalty = -1"]),
    (lambda b: b.add(CUBE, -1), ["density = -1", "positive"]),
    (lambda b: b.add(CUBE, 1e-320), ["mass"]),
    (lambda b: b.add(CUBE, 1, count=0), ["count = 0"]),
    (lambda b: b.add(CUBE, 1, count=-2), ["count = -2"]),
    (lambda b: b.add(CUBE, 1, material=256), ["material = 256"]),
    (lambda b: b.add_wall("floor"), ["exactly one of plane"]),
    (lambda b: b.add_wall("floor", **FLOOR, motion={}), ["motion", "move_wall"]),
    (lambda b: b.move_wall(3, place(0, 0, 0)), ["wall", "3"]),
    (lambda b: b.move_wall(0, np.zeros((2, 7))), ["quaternion"]),
    (lambda b: b.move_wall(0, [place(0, 0, 0)] * 2), ["rows of pose = 2"]),
    (lambda b: b.move_wall(0, place(0, 0, 0), velocity=[1, 2]), ["velocity", "three"]),
    (lambda b: b.remove(7), ["body 7"]),
    (lambda b: b.remove([0, 0]), ["body 0", "twice"]),
    (lambda b: b.remove(True), ["truth"]),
    (lambda b: b.remove_wall(5), ["wall 5"]),
    (lambda b: b.put_elsewhere([0, 9]), ["body 9"]),
    (lambda b: b.set_law(0, 300, friction=1), ["b = 300"]),
    (lambda b: b.set_contact(friction=-2), ["friction = -2"]),
    (lambda b: b.update([place(0, 0, 0)] * 2, dt=0), ["rows of poses = 2", "1 are needed"]),
    (lambda b: b.update(np.zeros((1, 6)), dt=0), ["poses", "(1, 6)", "(n, 7)"]),
    (lambda b: b.update(np.zeros((1, 7)), dt=0), ["quaternion"]),
    (lambda b: b.update(place(0, np.nan, 1), dt=0), ["poses.flat[1] = NaN"]),
    (lambda b: b.update(place(0, 0, 1), np.zeros((3, 3)), dt=0), ["velocities has 3 rows"]),
    (lambda b: b.update(place(0, 0, 1), None, [0, 1], dt=0), ["angular_velocities", "(2,)"]),
    (lambda b: b.update(place(0, 0, 1), [1e200, 0, 0], dt=0), ["velocity"]),
    (lambda b: b.update(place(0, 0, 1), dt=-1), ["dt = -1"]),
    (lambda b: b.update(place(0, 0, 1), dt=np.nan), ["dt = NaN"]),
    (lambda b: b.update(place(0, 1e200, 1), dt=0), ["pose.translation", "finite"]),
    (lambda b: femdem.ContactBatch.from_bytes(b"abc"), ["decoded", "checksum"]),
]


@pytest.mark.parametrize(("misuse", "words"), REFUSALS)
def test_misuse_is_refused_by_name(misuse, words):
    batch = femdem.ContactBatch()
    batch.add(CUBE, 1000)
    batch.add_wall("floor", **FLOOR)
    with pytest.raises(femdem.FemdemError) as refused:
        misuse(batch)
    assert all(word in str(refused.value) for word in words), refused.value
    assert batch.ids.tolist() == [0] and list(batch.walls) == [0]
    # It goes on.
    forces, _ = batch.update(place(0, 0, 0.0499), dt=1e-4)
    assert forces[0, 2] > 0
