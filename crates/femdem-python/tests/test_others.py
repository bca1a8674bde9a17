"""Bodies for other packages, where they are installed."""

import numpy as np
import pytest
from conftest import place

import femdem


@pytest.fixture
def world():
    world = femdem.World()
    half = np.sqrt(0.5)
    world.add(femdem.Shape("box:width=0.5,height=1", size=0.2), [place(1, 2, 3), [0, 0, 0, half, 0, 0, half]], 1000)
    matter = {"density": 1000, "law": "hencky", "young": 1e6, "poisson": 0.2}
    world.add_deformable(femdem.Shape("box:width=1,height=1", size=0.1), place(5, 5, 5), matter, mesh_size=0.5)
    return world


def test_surfaces_are_where_the_bodies_are(world):
    ids, surfaces = world._surfaces()
    assert ids == [0, 1, 2]
    for (points, _), position in zip(surfaces, world.positions, strict=True):
        low, high = points.min(axis=0), points.max(axis=0)
        assert np.allclose(0.5 * (low + high), position, atol=1e-9)
    # A quarter turn about z exchanges the extents along x and y.
    first, second = (np.ptp(points, axis=0) for points, _ in surfaces[:2])
    assert np.allclose(first, second[[1, 0, 2]]) and not np.allclose(first, second)


def test_trimesh(world):
    pytest.importorskip("trimesh")
    shape = femdem.Shape("dolos", size=0.3)
    mesh = shape.to_trimesh()
    assert mesh.is_watertight and mesh.volume == pytest.approx(shape.volume)
    scene = world.to_trimesh()
    assert len(scene.geometry) == 3 and scene.geometry["body 2"].is_watertight


def test_meshio(world):
    pytest.importorskip("meshio")
    assert len(femdem.Shape("cube", size=1).to_meshio().cells[0].data) == 12
    mesh = world.to_meshio()
    assert set(mesh.cell_data["body"][0]) == {0, 1, 2}
    inside = world.to_meshio(2)
    assert inside.cells[0].type == "tetra" and inside.cell_data["stress"][0].shape == (len(inside.cells[0].data), 6)
    assert inside.point_data["velocity"].shape == inside.points.shape
    again = femdem.Shape.from_tetrahedra(inside.points, inside.cells_dict["tetra"])
    assert again.volume == pytest.approx(1e-3)


def test_pandas(world):
    pytest.importorskip("pandas")
    frame = world.to_dataframe()
    assert len(frame) == 3 and frame["x"].tolist() == pytest.approx([1, 0, 5])


def test_pyvista(world):
    pytest.importorskip("pyvista")
    assert world.to_pyvista().n_cells == len(world.to_pyvista()["body"])


@pytest.mark.parametrize("package", ["trimesh", "meshio", "pandas", "pyvista"])
def test_a_package_that_is_missing_is_named(world, package, monkeypatch):
    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr("importlib.import_module", absent)
    ways = {"trimesh": world.to_trimesh, "meshio": world.to_meshio, "pandas": world.to_dataframe}
    with pytest.raises(ImportError, match=f"pip install {package}"):
        ways.get(package, world.to_pyvista)()
