"""Servos: walls that press, boxes under stress, periodic cells."""

import pickle

import numpy as np
import pytest
from conftest import lattice, place

import femdem

BALL = femdem.Shape("sphere", diameter=0.1)
FLOOR = {"plane": {"normal": [0, 0, 1]}}
LID = {"plane": {"normal": [0, 0, -1], "offset": -0.1005}, "control": {"force": 20, "speed": 0.1}}


def pressed():
    """A ball between a floor and a lid that presses with 20 N, without gravity."""
    world = femdem.World(gravity=(0, 0, 0))
    world.add_wall("floor", **FLOOR)
    (lid,) = world.add_wall("lid", **LID)
    world.add(BALL, place(0, 0, 0.05), 2000)
    return world, lid


def test_a_lid_presses_with_its_force_until_it_is_driven_or_held():
    world, lid = pressed()
    world.step(until=3)
    assert world.walls[lid]["force"] == pytest.approx([0, 0, 20], rel=0.01, abs=0.1)
    assert world.walls[0]["force"] == pytest.approx([0, 0, -20], rel=0.01, abs=0.1)
    world.drive_wall(lid, {"linear": {"velocity": [0, 0, 1]}})
    world.step(20)
    assert world.walls[lid]["force"][2] == 0
    world.remove_wall(lid)
    world.step(20)


def test_a_pickled_servo_goes_on_with_the_same_bits():
    world, lid = pressed()
    world.step(until=0.02)
    again = pickle.loads(pickle.dumps(world))
    for one in (world, again):
        one.step(100)
    assert again.state_hash() == world.state_hash() and again.walls[lid]["force"][2] > 0


def test_a_box_keeps_a_stress():
    world = femdem.World(friction=0.3)
    axis = {"stress": 2000, "speed": 0.2}
    space = {"lower": [0, 0, 0], "upper": [0.3, 0.3, 0.3]}
    assert len(world.add_wall("cell", box=space, control={"z": {**axis, "sides": "upper"}})) == 6
    world.add(femdem.Shape("sphere", diameter=0.07), lattice(4, 0.072, 0.04), 2000)
    world.step(until=2)
    (cell,) = world.controlled_cells
    assert cell["name"] == "cell" and cell["sides"][2] < 0.3 == cell["sides"][0]
    assert cell["errors"] == [None, None, pytest.approx(0, abs=0.02)]
    # The upper wall has it; the lower one bears the weight besides, but for what friction gives to the sides.
    forces = [wall["force"][2] for wall in world.walls.values()]
    weight = world.masses.sum() * 9.81
    assert max(forces) == pytest.approx(2000 * 0.09, rel=0.02)
    assert -sum(forces) == pytest.approx(weight, rel=0.02) and -min(forces) == pytest.approx(2000 * 0.09 + weight, rel=0.1)


def test_a_periodic_cell_is_compressed_to_a_stress():
    world = femdem.World(gravity=(0, 0, 0), friction=0.3)
    world.set_cell([0.4, 0.4, 0.4])
    world.add(femdem.Shape("sphere", diameter=0.079), lattice(5, 0.08, 0.04), 2000)
    axis = {"stress": 500, "speed": 0.2}
    world.control_cell(x=axis, y=axis, z=axis)
    world.step(until=0.2)
    assert np.diag(world.cell_stress()) == pytest.approx([500] * 3, rel=0.02)
    assert world.controlled_cells[0]["errors"] == pytest.approx([0] * 3, abs=0.02)
    world.control_cell()
    edges = world.cell
    world.step(10)
    assert np.array_equal(world.cell, edges) and world.controlled_cells == []
    world.control_cell(shear={"rate": 1.0})
    world.deform_cell(np.zeros((3, 3)))
    world.step(10)
    assert np.array_equal(world.cell, edges)


def test_the_servo_of_a_scene_goes_on_with_its_bits():
    scene = {
        "duration": 0.03,
        "every": 0.01,
        "gravity": [0, 0, 0],
        "material": {"steel": {"density": 2000}},
        "wall": [{"name": "floor", **FLOOR}, {"name": "lid", **LID}],
        "body": [{"shape": "sphere", "diameter": 0.1, "material": "steel", "position": [0, 0, 0.05]}],
    }
    world, longer = femdem.run(scene).world, femdem.run({**scene, "duration": 0.06}).world
    world.step(until=longer.time)
    assert world.steps == longer.steps and world.state_hash() == longer.state_hash()
    assert world.walls[1]["force"][2] > 0


@pytest.mark.parametrize(
    ("misuse", "words"),
    [
        (lambda w: w.add_wall("lid", **{**LID, "control": {"force": -1, "speed": 1}}), ["control.force = -1"]),
        (lambda w: w.add_wall("lid", **{**LID, "control": {"force": 1}}), ["speed = none"]),
        (lambda w: w.add_wall("lid", **LID, motion={"linear": {"velocity": [0, 0, 1]}}), ["control", "motion"]),
        (lambda w: w.add_wall("lid", **{**LID, "control": {"x": {"stress": 1, "speed": 1}}}), ["control.x"]),
        (lambda w: w.add_wall("lid", **FLOOR, opens=1.0), ["opens"]),
        (lambda w: w.control_cell(x={"stress": 1, "speed": 1}), ["cell.control"]),
        (lambda w: w.drive_wall(1, {"turn": {"axis": [0, 0, 0], "point": [0, 0, 0], "rate": 1}}), ["axis"]),
    ],
)
def test_misuse_is_refused_by_name_and_changes_nothing(misuse, words):
    world, _ = pressed()
    world.step(10)
    again = pickle.loads(pickle.dumps(world))
    with pytest.raises(femdem.FemdemError) as refused:
        misuse(world)
    assert all(word in str(refused.value) for word in words), refused.value
    for one in (world, again):
        one.step(10)
    assert world.state_hash() == again.state_hash() and len(world.walls) == 2
