"""Bonds between bodies, cracks in them, and periodic space."""

import numpy as np
import pytest
from conftest import place

import femdem

CUBE = femdem.Shape("box:width=1,height=1", size=0.1)
MORTAR = {"tensile": 1e6, "cohesion": 3e6, "energy": [20, 100], "stiffness": 1e11}
AREA = 0.01
PULL = {"linear": {"velocity": [0, 0, 0.02]}}


def glued(**options):
    """Two cubes face on face: the lower one is held, the upper one moves as it is told."""
    world = femdem.World(gravity=(0, 0, 0), time_step={"largest": 1e-6}, sleeping=False)
    world.add(CUBE, place(0, 0, 0), 2000, motion={"linear": {"velocity": [0, 0, 0]}})
    world.add(CUBE, place(0, 0, 0.1), 2000, **options)
    return world


def test_a_bond_bears_its_strength_times_its_area_and_takes_its_energy():
    world = glued(motion=PULL)
    (bond,) = world.add_bonds([0, 1], gap=1e-6, **MORTAR)
    forces = []
    for _ in range(260):
        world.step(10)
        state = world.bonds()
        forces.append(state["force"][0, 2])
    # Tension pulls the lower body up: k A d, up to f A.
    assert forces[9] == pytest.approx(1e11 * AREA * 0.02 * world.time / 26, rel=0.02)
    assert max(forces) == pytest.approx(1e6 * AREA, rel=0.02)
    assert state["bond"].tolist() == [bond] and (state["a"][0], state["b"][0]) == (0, 1)
    assert state["area"][0] == pytest.approx(AREA) and state["normal"][0] == pytest.approx([0, 0, 1])
    # Linear softening ends at 2 G/f.
    assert state["broken"][0] and state["broken_at"][0] == pytest.approx(2 * 20 / 1e6 / 0.02, rel=0.05)
    assert state["dissipated"][0] == pytest.approx(20 * AREA, rel=1e-3)
    assert state["damage"][0] == pytest.approx(1) and state["mode"][0] == pytest.approx(0, abs=1e-6)
    assert state["ended"][0] and forces[-1] == 0
    assert [piece.tolist() for piece in world.bonded_pieces()] == [[0], [1]]


def test_a_bonded_body_hangs_on_a_polygon():
    world = glued()
    world.set_gravity((0, 0, 9.81))
    corners = 0.02 * np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]) + [0, 0, 0.05]
    assert world.add_bond(0, 1, corners, **MORTAR, damping=0.5) == 0
    assert world.bonded_with(1).tolist() == [0, 1]
    world.step(until=0.003)
    state = world.bonds()
    assert state["area"] == pytest.approx([0.0016])
    assert state["force"][0] == pytest.approx([0, 0, 2 * 9.81], rel=0.02, abs=0.1)
    assert np.isnan(state["broken_at"][0]) and not state["broken"][0]
    world.remove(1)
    assert len(world.bonds()["bond"]) == 0


def test_two_polygons_between_two_bodies_hold_together():
    world = glued()
    world.set_gravity((0, 0, 9.81))
    corners = 0.01 * np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]) + [0, 0, 0.05]
    for x in (-0.02, 0.02):
        world.add_bond(0, 1, corners + [x, 0, 0], **MORTAR, damping=0.5)
    world.step(until=0.003)
    state = world.bonds()
    assert state["area"] == pytest.approx([4e-4] * 2) and not state["ended"].any()
    assert state["force"][:, 2] == pytest.approx([9.81] * 2, rel=0.02)


def test_a_cluster_has_the_bits_of_the_program():
    scene = {
        "duration": 1e-4,
        "every": 5e-5,
        "gravity": [0, 0, -9.81],
        "contact": {"friction": 0.4, "penalty": 1e9},
        "material": {"grain": {"density": 2500}},
        "wall": [{"name": "plate", "plane": {"normal": [0, 0, 1]}}],
        "body": [
            {
                "name": f"g{k}",
                "shape": "sphere",
                "diameter": 0.002,
                "material": "grain",
                "position": [0.002 * (k % 2), 0.002 * (k // 2 % 2), 0.00101 + 0.002 * (k // 4)],
                "velocity": [6, 0, -6],
            }
            for k in range(8)
        ],
        "bond": [{"between": ["grain", "grain"], "gap": 1e-6, "ratio": 0.5, "damping": 0.05, **MORTAR, "stiffness": 1e12}],
    }
    result = femdem.run(scene)
    theirs = result.world
    world = femdem.World(**_keywords(theirs.parameters))
    ball = femdem.Shape("sphere", diameter=0.002)
    world.add_wall("plate", plane={"normal": [0, 0, 1]})
    for body in scene["body"]:
        world.add(ball, place(*body["position"]), 2500, velocity=body["velocity"])
    law = {key: value for key, value in scene["bond"][0].items() if key != "between"}
    assert len(world.add_bonds(world.ids, **law)) == 12
    world.step(until=theirs.time)
    assert world.steps == theirs.steps and np.array_equal(world.poses, theirs.poses)
    ours, bonds = world.bonds(), theirs.bonds()
    assert all(np.array_equal(ours[name], bonds[name], equal_nan=ours[name].dtype.kind == "f") for name in ours)
    table = result.table("bonds.csv")
    assert table["damage"] == pytest.approx(ours["damage"]) and table["tension"] == pytest.approx(ours["tension"])


def _keywords(parameters):
    """What makes a world with these parameters."""
    contact = {key: value for key, value in parameters["contact"].items() if value is not None}
    return {**{key: parameters[key] for key in ("gravity", "time_step", "sleeping", "medium")}, **contact}


BRITTLE = {
    "density": 2400,
    "law": "neo-hookean",
    "young": 1e9,
    "poisson": 0.2,
    "fracture": {"tensile": 1e6, "cohesion": 4e6, "friction_angle": 35, "energy": [100, 500]},
}
STRONG = {**BRITTLE, "fracture": {**BRITTLE["fracture"], "tensile": 1e7, "cohesion": 4e7}}
BAR = femdem.Shape("box:width=0.2,height=0.2", size=0.1)
ENDS = [
    {"select": {"plane": {"normal": [1, 0, 0], "offset": -0.05}}, "fix": True},
    {"select": {"plane": {"normal": [1, 0, 0], "offset": 0.05}}, "motion": {"linear": {"velocity": [0.1, 0, 0]}}},
]


def test_a_bar_that_is_pulled_breaks_at_its_strength():
    world = femdem.World(gravity=(0, 0, 0))
    low, high = BAR.vertices.min(axis=0), BAR.vertices.max(axis=0)
    assert high - low == pytest.approx([0.1, 0.02, 0.02])
    (bar,) = world.add_deformable(BAR, place(0, 0, 0), BRITTLE, mesh_size=0.25, boundary=ENDS)
    facts = world.crack_facts(bar)
    assert facts["process_zone"] == pytest.approx(0.1) and facts["element_height"] < facts["largest_height"]
    elements = len(world.cells(bar)[0])
    assert world.fragments(bar).tolist() == [0] * elements and len(world.cracks(bar)["elements"]) == 0
    world.step(until=0.0042)
    cracks = world.cracks(bar)
    # The strain f/E at the strength.
    assert cracks["birth"].min() == pytest.approx(1e-3 * 0.1 / 0.1, rel=0.1)
    assert cracks["corners"].shape == (len(cracks["elements"]), 3, 3) and not cracks["sheared"].all()
    assert np.isfinite(cracks["broken_at"]).any() and len(set(world.fragments(bar))) >= 2
    # The energy of fracture over one section at least.
    assert cracks["dissipated"].sum() > 0.8 * 100 * 0.02**2
    nodes, velocities = world.nodes(bar)
    far = nodes[:, 0] > 0.05
    assert far.any() and velocities[far, 0] == pytest.approx(0.1, rel=0.5)
    world.release(bar)
    world.step(1)
    # Its halves go on as bodies.
    ((body, others),) = world.fragment_bodies()
    assert body == bar and len(others) >= 1 and world.fragment_bodies() == []
    assert sum(len(world.cells(i)[0]) for i in [body, *others]) == elements
    world.step(10)


def test_space_repeats_itself():
    world = femdem.World(gravity=(0, 0, 0), friction=0.0)
    world.set_cell([0.4, 0.4, 0.4])
    assert world.cell == pytest.approx(np.eye(3) * 0.4)
    world.add(CUBE, [place(0.05, 0.15, 0.15), place(0.3495, 0.15, 0.15)], 2000)
    world.step(1)
    # Through the face of the cell.
    assert len(world.contacts()["a"]) == 0
    world.set_pose([1], [place(0.3501, 0.15, 0.15)])
    world.set_velocity([1], velocity=[1, 0, 0])
    world.step(until=world.time + 5e-4)
    assert len(world.contacts()["a"]) == 1 and world.cell_stress()[0, 0] > 0
    world.deform_cell([[-0.1, 0, 0], [0, 0, 0], [0, 0, 0]])
    before = world.time
    world.step(20)
    assert world.cell[0, 0] == pytest.approx(0.4 - 0.1 * (world.time - before))
    assert femdem.World().cell is None and femdem.World().cell_stress() is None


REFUSALS = [
    (lambda w: w.add_bonds([0, 1], gap=1e-6), ["bonds", "tensile"]),
    (lambda w: w.add_bonds([0, 1], gap=1e-6, **MORTAR, tensil=1), ["tensil", "tensile"]),
    (lambda w: w.add_bonds([0, 1], gap=1e-6, **{**MORTAR, "tensile": -1}), ["tensile", "-1"]),
    (lambda w: w.add_bonds([0, 1], gap=-1, **MORTAR), ["gap"]),
    (lambda w: w.add_bonds([0, 7], gap=1e-6, **MORTAR), ["7"]),
    (lambda w: w.add_bonds([0], [2], gap=1e-6, **MORTAR), ["gap", "larger"]),
    (lambda w: w.add_bond(0, 0, CUBE.vertices[:3], **MORTAR), ["bodies of a bond", "two different numbers"]),
    (lambda w: w.add_bond(0, 1, np.zeros((4, 3)), **MORTAR), ["area of a bond", "above 0"]),
    (lambda w: w.add_bond(0, 1, np.zeros((2, 2)), **MORTAR), ["corners", "(2, 2)"]),
    (lambda w: w.add_bond(0, 1, np.zeros((4, 3)), gap=1, **MORTAR), ["gap", "add_bonds"]),
    (lambda w: w.bonded_with(9), ["9"]),
    (lambda w: w.cracks(0), ["0"]),
    (lambda w: w.fragments(-1), ["body = -1"]),
    (lambda w: w.release(0), ["0"]),
    (lambda w: w.set_cell([1, 1]), ["sides", "three"]),
    (lambda w: w.set_cell([0.1, None, None]), ["periodic", "before the bodies"]),
    (lambda w: w.deform_cell(np.eye(3)), ["cell"]),
    (lambda w: w.deform_cell([1, 2]), ["rates", "(2,)"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), BRITTLE, mesh_size=-1), ["edge length", "positive"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), STRONG, mesh_size=0.5), ["elements", "m high", "mesh"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), BRITTLE, element="t10"), ["T4", "T10"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), BRITTLE, boundary={"fix": True}), ["boundary", "list"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), BRITTLE, boundary=[{"fix": True}]), ["boundary", "select"]),
    (lambda w: w.add_deformable(BAR, place(0, 0, 9), BRITTLE, boundary=[{**ENDS[0], "name": "a"}]), ["boundary.name", '"a"']),
]


@pytest.mark.parametrize(("misuse", "words"), REFUSALS)
def test_misuse_is_refused_by_name(misuse, words):
    world = glued()
    world.add(CUBE, place(0, 0, 3), 1000)
    with pytest.raises((femdem.FemdemError, TypeError)) as refused:
        misuse(world)
    assert all(word in str(refused.value) for word in words), refused.value
    assert len(world) == 3 and len(world.bonds()["bond"]) == 0


def test_two_bonds_between_two_bodies_are_refused_and_a_whole_body_has_no_cracks():
    world = glued()
    world.add_bonds([0, 1], gap=1e-6, **MORTAR)
    with pytest.raises(femdem.FemdemError, match="bodies 0 and 1 are bonded already"):
        world.add_bonds([0, 1], gap=1e-6, **MORTAR)
    rubber = {"density": 1100, "law": "neo-hookean", "young": 1e5, "poisson": 0.3}
    (soft,) = world.add_deformable(CUBE, place(0, 0, 9), rubber, mesh_size=0.5)
    with pytest.raises(femdem.FemdemError, match="cannot break"):
        world.cracks(soft)
    with pytest.raises(femdem.FemdemError):
        world.add_bonds([0, soft], gap=1e-6, **MORTAR)
