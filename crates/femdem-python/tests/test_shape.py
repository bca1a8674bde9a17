"""Shapes: names, arrays, files."""

import pickle

import numpy as np
import pytest

import femdem

TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def test_a_name_gives_a_shape_by_size_or_diameter():
    cube = femdem.Shape("box:width=1,height=1", size=0.1)
    assert cube.volume == pytest.approx(1e-3)
    assert cube.area == pytest.approx(0.06)
    assert cube.diameter == pytest.approx(0.1 * 3**0.5)
    assert femdem.Shape("cube", diameter=cube.diameter).volume == pytest.approx(1e-3)
    assert (cube.is_convex, cube.is_ball, len(cube.vertices), len(cube.faces)) == (True, False, 8, 6)
    assert cube.vertices.dtype == np.float64 and cube.triangles.shape == (12, 3)
    assert "8 vertices" in repr(cube)


def test_the_sphere_is_the_exact_ball():
    ball = femdem.Shape("sphere", diameter=0.2)
    assert ball.is_ball and ball.volume == pytest.approx(4 / 3 * np.pi * 1e-3)


def test_arrays_give_a_surface_or_a_hull():
    tetrahedron = femdem.Shape.from_arrays(TETRAHEDRON, FACES, name="t")
    assert tetrahedron.volume == pytest.approx(1 / 6)
    assert np.allclose(tetrahedron.centroid, 0.25)
    hull = femdem.Shape.convex_hull([*TETRAHEDRON, [0.1, 0.1, 0.1]])
    assert hull.volume == pytest.approx(1 / 6) and len(hull.vertices) == 4
    assert femdem.Shape.from_arrays(np.array(TETRAHEDRON, dtype=np.float32), np.array(FACES)).name == "body"


def test_tetrahedra_are_those_of_deformable_bodies():
    corners = 0.1 * np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, 8).T
    # Six about a diagonal of the cube.
    tets = [[0, 4, 6, 7], [0, 6, 2, 7], [0, 2, 3, 7], [0, 3, 1, 7], [0, 1, 5, 7], [0, 5, 4, 7]]
    cube = femdem.Shape.from_tetrahedra(corners, tets, name="six")
    assert cube.volume == pytest.approx(1e-3) and cube.is_convex and len(cube.faces) == 6
    world = femdem.World()
    matter = {"density": 1000, "law": "neo-hookean", "young": 1e6, "poisson": 0.3}
    for one in (cube, pickle.loads(pickle.dumps(cube))):
        (soft,) = world.add_deformable(one, [0, 0, 1, 1, 0, 0, 0], matter)
        assert world.cells(soft)[0].tolist() == tets
        assert np.allclose(world.nodes(soft)[0], corners + [0, 0, 1])
    assert world.add(cube, [5, 0, 1, 1, 0, 0, 0], 1000).tolist() == [2]
    assert world.masses == pytest.approx([1, 1, 1])
    with pytest.raises(femdem.FemdemError, match="mesh_size = 0.3"):
        world.add_deformable(cube, [0, 0, 1, 1, 0, 0, 0], matter, mesh_size=0.3)


def test_a_file_of_gmsh_gives_tetrahedra(tmp_path):
    nodes = "\n".join(f"{k + 1} {x} {y} {z}" for k, (x, y, z) in enumerate(TETRAHEDRON))
    text = f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{nodes}\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
    path = tmp_path / "one.msh"
    path.write_text(text)
    one = femdem.Shape.from_file(path, unit="mm")
    assert one.volume == pytest.approx(1e-9 / 6) and one.name == "one"
    assert femdem.Shape.from_file(path, diameter=0.1).diameter == pytest.approx(0.1)
    with pytest.raises(femdem.FemdemError, match="leave them out"):
        femdem.Shape.from_file(path, mesh_size=0.2)


def test_a_file_gives_what_was_saved(tmp_path):
    shape = femdem.Shape("dolos:waist=0.36", size=0.3)
    assert not shape.is_convex
    shape.save(tmp_path / "dolos.obj")
    again = femdem.Shape.from_file(tmp_path / "dolos.obj")
    assert np.array_equal(again.vertices, shape.vertices) and again.name == "dolos"
    assert femdem.Shape.from_file(tmp_path / "dolos.obj", unit="mm").diameter == pytest.approx(1e-3 * shape.diameter)
    assert femdem.Shape.from_file(tmp_path / "dolos.obj", diameter=2.0).diameter == pytest.approx(2.0)


@pytest.mark.parametrize("name", ["cube", "sphere", "dolos"])
def test_pickling_keeps_shapes(name):
    shape = femdem.Shape(name, size=0.1)
    again = pickle.loads(pickle.dumps(shape))
    assert np.array_equal(again.vertices, shape.vertices) and again.faces == shape.faces
    assert (again.name, again.is_ball, again.volume) == (shape.name, shape.is_ball, shape.volume)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: femdem.Shape("A99", size=1), ["A99"]),
        (lambda: femdem.Shape("cube"), ["size", "diameter"]),
        (lambda: femdem.Shape("cube", size=-1), ["size = -1", "positive"]),
        (lambda: femdem.Shape("cube", size=float("nan")), ["size = NaN"]),
        (lambda: femdem.Shape("cylinder:aspect=-2", size=1), ["aspect"]),
        (lambda: femdem.Shape.convex_hull([[0, 0], [1, 1]]), ["(2, 2)", "(n, 3)"]),
        (lambda: femdem.Shape.convex_hull(TETRAHEDRON[:3]), ["3", "4"]),
        (lambda: femdem.Shape.convex_hull([[0, 0, np.nan], *TETRAHEDRON]), ["vertices", "NaN"]),
        (lambda: femdem.Shape.convex_hull("stone"), ["vertices", "numbers"]),
        (lambda: femdem.Shape.from_arrays(TETRAHEDRON, [*FACES[:3], FACES[0]]), ["edge"]),
        (lambda: femdem.Shape.from_arrays(TETRAHEDRON, [[0, -1, 2]]), ["faces[0] = -1"]),
        (lambda: femdem.Shape.from_arrays(TETRAHEDRON, [[0, 2**32, 2]]), ["faces[0] = 4294967296"]),
        (lambda: femdem.Shape.from_arrays(TETRAHEDRON, [*FACES[:3], [1, 2, 9]]), ["9"]),
        (lambda: femdem.Shape.from_file("nowhere.obj"), ["nowhere.obj"]),
        (lambda: femdem.Shape.from_file("nowhere.obj", unit="league"), ["league", "mm"]),
        (lambda: femdem.Shape.from_file("nowhere.obj", unit="m\u0301'"), ["m\u0301'", "mm"]),
    ],
)
def test_what_is_no_shape_is_refused_by_name(make, words):
    with pytest.raises(femdem.FemdemError) as refused:
        make()
    assert all(word in str(refused.value) for word in words), refused.value
