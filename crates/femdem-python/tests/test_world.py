"""Worlds against mechanics, and what they refuse."""

import pickle

import numpy as np
import pytest
from conftest import place

import femdem

CUBE = femdem.Shape("box:width=1,height=1", size=0.1)
FLOOR = {"plane": {"normal": [0, 0, 1]}}


def test_a_thrown_body_follows_its_parabola():
    world = femdem.World(gravity=(0, 0, -10))
    (stone,) = world.add(CUBE, place(0, 0, 1), 2000, velocity=[1, 0, 5], angular_velocity=[0, 0, 2])
    taken = world.step(until=0.5)
    t = world.time
    assert taken == world.steps and 0.5 <= t < 0.5 + 2 * world.time_step
    assert np.allclose(world.positions, [[t, 0, 1 + 5 * t - 5 * t * t]], atol=1e-12)
    assert np.allclose(world.velocities, [[1, 0, 5 - 10 * t]])
    assert np.allclose(world.poses[0, 3:], [np.cos(t), 0, 0, np.sin(t)], atol=1e-12)
    assert world.masses == pytest.approx([2.0]) and stone == 0


@pytest.mark.parametrize("shape", [CUBE, femdem.Shape("sphere", diameter=0.1)])
def test_the_floor_bears_the_weight(shape):
    world = femdem.World(friction=0.5, time_step={"safety": 0.2})
    (floor,) = world.add_wall("floor", **FLOOR)
    world.add(shape, place(0, 0, 0.0501), 2000)
    world.step(until=2)
    weight = world.masses[0] * 9.81
    assert world.masses[0] == pytest.approx(shape.volume * 2000)
    assert world.walls[floor]["name"] == "floor"
    assert world.walls[floor]["force"] == pytest.approx([0, 0, -weight], rel=1e-3, abs=1e-3 * weight)
    contacts = world.contacts()
    assert contacts["a"].tolist() == [-1] and contacts["b"].tolist() == [0]
    assert contacts["force"].sum(axis=0) == pytest.approx([0, 0, weight], rel=1e-3, abs=1e-3 * weight)
    ledger = world.ledger()
    assert abs(ledger["error_relative"]) < 0.05 and ledger["kinetic"] < 1e-6
    assert world.residuals()["max_over_weight"] < 0.01


def test_a_force_of_a_host_moves_a_body_and_a_torque_turns_it():
    world = femdem.World(gravity=(0, 0, 0))
    body = world.add(CUBE, place(0, 0, 0), 1000)
    world.set_load(body, force=[2, 0, 0], torque=[0, 0, 0.01])
    world.step(until=0.1)
    t, inertia = world.time, 1.0 * 0.1**2 / 6
    assert np.allclose(world.positions, [[t * t, 0, 0]], rtol=1e-9)
    assert np.allclose(world.angular_velocities, [[0, 0, 0.01 / inertia * t]], rtol=1e-9)
    world.set_load(body)
    world.set_velocity(body, velocity=[0, 0, 3])
    assert np.allclose(world.angular_velocities, [[0, 0, 0.01 / inertia * t]], rtol=1e-9)
    world.set_pose(body, [place(5, 0, 0)])
    world.step(1)
    assert np.allclose(world.positions[0], [5, 0, 3 * world.time_step], atol=1e-9)


def test_bodies_and_walls_go_and_their_numbers_come_again():
    world = femdem.World()
    (floor,) = world.add_wall("floor", **FLOOR)
    ids = world.add(CUBE, [place(x, 0, 1) for x in range(4)], [1000, 2000, 3000, 4000])
    assert world.masses == pytest.approx([1, 2, 3, 4])
    world.remove(ids[1:3])
    assert world.ids.tolist() == [0, 3] and len(world) == 2
    assert world.add(CUBE, place(9, 0, 1), 1000).tolist() == [1]
    world.remove_wall(floor)
    assert world.walls == {}


def test_driven_things_follow_their_motion():
    world = femdem.World()
    lift = {"linear": {"velocity": [0, 0, 0.5]}}
    world.add(CUBE, place(0, 0, 1), 1000, motion=lift)
    (plate,) = world.add_wall("plate", **FLOOR, motion={"shake": {"stroke": [0, 0, 0.01], "frequency": 10}})
    world.step(until=0.1)
    assert world.positions[0, 2] == pytest.approx(1 + 0.5 * world.time)
    world.drive([0], None)
    world.drive_wall(plate, None)
    world.step(1)
    assert world.velocities[0, 2] == pytest.approx(0.5 - 9.81 * world.time_step)


def test_materials_have_their_own_laws():
    slope = np.radians(20)
    world = femdem.World(gravity=(9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)), friction=0.6)
    world.set_law(0, 1, friction=0.05)
    world.add_wall("ramp", **FLOOR)
    world.add(CUBE, place(0, 0, 0.05), 1000)
    world.add(CUBE, place(0, 1, 0.05), 1000, material=1)
    world.step(until=0.3)
    moved = world.positions[:, 0]
    assert moved[0] < 1e-3
    fall = 0.5 * 9.81 * (np.sin(slope) - 0.05 * np.cos(slope)) * world.time**2
    assert moved[1] == pytest.approx(fall, rel=0.03)
    world.set_contact(friction=0.0)
    assert world.parameters["contact"]["friction"] == 0


def test_a_deformable_block_is_compressed_by_its_weight():
    world = femdem.World()
    world.add_wall("floor", **FLOOR)
    rubber = {"density": 1100, "law": "neo-hookean", "young": 1e5, "poisson": 0.3, "shear_viscosity": 20}
    (block,) = world.add_deformable(CUBE, place(0, 0, 0.0501), rubber, mesh_size=0.3)
    world.step(until=0.6)
    nodes, velocities = world.nodes(block)
    tets, skin = world.cells(block)
    assert nodes.shape == velocities.shape and tets.shape[1] == 4 and skin.shape[1] == 3
    assert world.walls[0]["force"][2] == pytest.approx(-1.1 * 9.81, rel=0.03)
    stresses = world.stresses(block)
    assert stresses.shape == (len(tets), 6)
    # Half of the weight over the face.
    assert stresses[:, 2].mean() == pytest.approx(-0.5 * 1.1 * 9.81 / 0.01, rel=0.1)
    assert world.deformable_ids.tolist() == [block] and world.poses.shape == (0, 7)


def test_callbacks_come_at_their_steps_and_may_end_it(box_of_stones):
    seen = []
    assert box_of_stones.step(10, callback=lambda world: seen.append(world.steps), every=4) == 10
    assert seen == [4, 8, 10]
    assert box_of_stones.step(100, callback=lambda world: world.steps < 20, every=5) == 10
    assert box_of_stones.step(100, callback=lambda world: np.bool_(False), every=1) == 1
    with pytest.raises(ZeroDivisionError):
        box_of_stones.step(10, callback=lambda world: 1 / 0, every=2)
    assert box_of_stones.steps == 23


def test_pickling_goes_on_with_the_same_bits(box_of_stones):
    box_of_stones.step(700)
    again = pickle.loads(pickle.dumps(box_of_stones))
    for world in (box_of_stones, again):
        world.step(500)
    assert again.state_hash() == box_of_stones.state_hash()
    assert np.array_equal(again.poses, box_of_stones.poses)
    # The shape is added again without harm.
    assert again.add(CUBE, place(0.15, 0.15, 1.5), 1000).tolist() == [27]


@pytest.mark.parametrize("name", ["sphere", "dolos", "cube"])
def test_the_shapes_of_a_world_are_for_more_bodies(name):
    def twins():
        return [pickle.loads(data), femdem.World(gravity=(0, 0, 0))]

    world = femdem.World(gravity=(0, 0, 0))
    world.add(femdem.Shape(name, size=0.1), place(0, 0, 0), 1000)
    data = pickle.dumps(world)
    (known,) = pickle.loads(data).shapes
    assert known.is_ball == (name == "sphere") and known.is_convex == (name != "dolos")
    for other in twins():
        other.add(known, place(1, 0, 0), 1000)
        assert other.shapes[-1].is_ball == known.is_ball and other.masses[-1] == world.masses[0]
    # In the same world it is the same shape, and bodies go on with the same bits.
    own, again = world, pickle.loads(data)
    for one in (own, again):
        one.add(one.shapes[0], place(0.098, 0, 0), 1000)
        one.step(20)
    assert len(own.shapes) == len(again.shapes) == 1
    assert own.state_hash() == again.state_hash()


def test_poses_are_normalised_as_in_rust():
    world = femdem.World(gravity=(0, 0, 0))
    # Of unit length to rounding, in the eyes of Rust, and so left as it is; and not.
    near, far = 1 + 4e-15, 1 + 1e-8
    world.add(CUBE, [[0, 0, 0, near, 0, 0, 0], [1, 0, 0, far, 0, 0, 0]], 1000)
    assert world.poses[:, 3].tolist() == [near, 1]


@pytest.mark.parametrize("soft", [False, True])
def test_a_bad_row_leaves_no_body(soft):
    world = femdem.World()
    rubber = {"density": 1100, "law": "neo-hookean", "young": 1e5, "poisson": 0.3}

    def add(speed):
        places = [place(0, 0, 1), place(0, 0, 2)]
        velocity = [[0, 0, 0], [speed, 0, 0]]
        if soft:
            return world.add_deformable(CUBE, places, rubber, mesh_size=0.5, velocity=velocity)
        return world.add(CUBE, places, 1000, velocity=velocity)

    # Finite, and longer than numbers can say.
    with pytest.raises(femdem.FemdemError, match="velocity"):
        add(1e200)
    assert len(world) == 0
    assert add(1).tolist() == [0, 1]
    assert world.ledger()["error"] == pytest.approx(0, abs=1e-9)


def test_a_driven_body_has_no_velocity_of_its_own_and_a_soft_one_no_torque():
    world = femdem.World()
    world.add(CUBE, place(0, 0, 1), 1000)
    world.add(CUBE, place(0, 0, 2), 1000, motion={"linear": {"velocity": [0, 0, 0.5]}})
    rubber = {"density": 1100, "law": "neo-hookean", "young": 1e5, "poisson": 0.3}
    world.add_deformable(CUBE, place(0, 0, 3), rubber, mesh_size=0.5)
    before = world.state_hash()
    with pytest.raises(femdem.FemdemError, match="body 1 follows a drive"):
        world.set_velocity([0, 1], velocity=[1, 0, 0])
    with pytest.raises(femdem.FemdemError, match="body 2 .*no torque"):
        world.set_load([0, 2], torque=[1, 0, 0])
    with pytest.raises(femdem.FemdemError, match="no rigid body 2"):
        world.drive([0, 2], None)
    assert world.state_hash() == before


def test_any_number_of_threads_gives_the_same_bits(box_of_stones):
    copy = pickle.loads(pickle.dumps(box_of_stones))
    femdem.set_threads(1)
    box_of_stones.step(800)
    femdem.set_threads(3)
    copy.step(800)
    assert copy.state_hash() == box_of_stones.state_hash()


def test_a_world_tells_what_it_is(box_of_stones):
    box_of_stones.step(1)
    assert repr(box_of_stones) == f"World(27 bodies, 0 contacts, t = {box_of_stones.time:.6g} s)"
    page = box_of_stones._repr_html_()
    assert "<th>bodies</th><td>27</td>" in page and "box x-" in page
    assert box_of_stones.stable_step > 0 and box_of_stones.stability() is None
    assert not box_of_stones.asleep.any() and box_of_stones.kinetic_energies.shape == (27,)


WORLD_REFUSALS = [
    (lambda w: femdem.World(friction=-1), ["friction = -1"]),
    (lambda w: femdem.World(frictoin=0.5), ["frictoin", "friction"]),
    (lambda w: femdem.World(friction=float("nan")), ["friction = nan", "finite"]),
    (lambda w: femdem.World(gravity=(0, 0)), ["gravity = [0.0, 0.0]", "three"]),
    (lambda w: femdem.World(time_step={"safety": 2}), ["safety = 2"]),
    (lambda w: w.add(CUBE, np.zeros((3, 6)), 1000), ["poses", "(3, 6)", "(n, 7)"]),
    (lambda w: w.add(CUBE, np.zeros(7), 1000), ["quaternion", "0"]),
    (lambda w: w.add(CUBE, place(0, np.inf, 0), 1000), ["poses", "inf"]),
    (lambda w: w.add(CUBE, place(0, 0, 0), -5), ["density = -5", "positive"]),
    (lambda w: w.add(CUBE, place(0, 0, 0), [1, 2]), ["density", "2"]),
    (lambda w: w.add(CUBE, [place(0, 0, 0)] * 3, 1, velocity=np.zeros((2, 3))), ["velocity", "2", "3"]),
    (lambda w: w.add(CUBE, place(0, 0, 0), 1, motion={"lienar": {}}), ["lienar", "linear"]),
    (lambda w: w.add_wall("floor"), ["exactly one of plane"]),
    (lambda w: w.add_wall("floor", plane={"normal": [0, 0, 0]}), ["plane.normal"]),
    (lambda w: w.add_wall("floor", **FLOOR, opens=1.0), ["opens", "remove_wall"]),
    (lambda w: w.add_deformable(CUBE, place(0, 0, 0), {"density": 1000}), ["law"]),
    (lambda w: w.add_deformable(CUBE, place(0, 0, 0), {"density": 1}, element="t5"), ["t5"]),
    (lambda w: w.remove(7), ["body", "7"]),
    (lambda w: w.remove(-1), ["-1"]),
    (lambda w: w.remove([0.5]), ["0.5"]),
    (lambda w: w.set_pose([0], np.zeros(7)), ["quaternion", "qw"]),
    (lambda w: w.set_pose([0], [place(0, 0, 0)] * 2), ["poses has 2 rows", "1 are needed"]),
    (lambda w: w.set_pose([0, 99], [place(0, 0, 0)] * 2), ["99"]),
    (lambda w: w.set_velocity([0, 99], velocity=[1, 0, 0]), ["99"]),
    (lambda w: w.set_load([0, 99], force=[1, 0, 0]), ["99"]),
    (lambda w: w.drive([0, 99], {"linear": {"velocity": [0, 0, 1]}}), ["99"]),
    (lambda w: w.remove([0, 99]), ["99"]),
    (lambda w: w.remove([0, 0]), ["body 0", "twice"]),
    (lambda w: w.remove(True), ["truth", "mask"]),
    (lambda w: w.remove(w.asleep), ["truth", "mask"]),
    (lambda w: w.set_load([True], force=[1, 0, 0]), ["truth", "mask"]),
    (lambda w: w.remove(2**32), ["bodies = 4294967296"]),
    (lambda w: w.nodes(-1), ["body = -1"]),
    (lambda w: w.remove_wall(-1), ["wall = -1"]),
    (lambda w: w.add(CUBE, place(0, 0, 0), 1, material=256), ["material = 256"]),
    (lambda w: w.set_law(0, -1, friction=0.1), ["b = -1"]),
    (lambda w: w.add(CUBE, [place(0, 0, 0)] * 2, [1, -5]), ["density = -5"]),
    (lambda w: w.step(2**70), ["steps = 1180591620717411303424"]),
    (lambda w: w.step(1.5), ["steps = 1.5"]),
    (lambda w: w.step(10, every=2), ["every = 2", "callback"]),
    (lambda w: w.set_load([0], force=[np.nan, 0, 0]), ["force", "NaN"]),
    (lambda w: w.set_velocity([9], velocity=[0, 0, 0]), ["9"]),
    (lambda w: w.nodes(0), ["0"]),
    (lambda w: w.step(-1), ["steps = -1"]),
    (lambda w: w.step(until=float("nan")), ["until = nan"]),
    (lambda w: w.step(1, callback=print, every=0), ["every = 0"]),
    (lambda w: femdem.World.from_bytes(b"abc"), ["decoded"]),
    (lambda w: femdem.set_threads(0), ["threads = 0"]),
    (lambda w: femdem.set_threads(-1), ["threads = -1"]),
]


@pytest.mark.parametrize(("misuse", "words"), WORLD_REFUSALS)
def test_misuse_is_refused_by_name(misuse, words):
    world = femdem.World()
    world.add(CUBE, place(0, 0, 1), 1000)
    before = world.state_hash()
    with pytest.raises(femdem.FemdemError) as refused:
        misuse(world)
    assert all(word in str(refused.value) for word in words), refused.value
    assert len(world) == 1 and world.state_hash() == before
