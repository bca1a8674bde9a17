"""The commands of the program, and their results."""

import hashlib
import multiprocessing
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT

import femdem

PACK = {"shape": "P5", "count": 12, "box": "3x3", "friction": 0.4, "seed": 7}
SCENE = {
    "duration": 0.05,
    "every": 0.025,
    "track": True,
    "contact": {"friction": 0.3},
    "material": {"steel": {"density": 7800}},
    "wall": [{"name": "floor", "plane": {"normal": [0, 0, 1]}}],
    "body": [
        {"name": "a", "shape": "cube", "size": 0.02, "material": "steel", "position": [0, 0, 0.012]},
        {"name": "b", "shape": "sphere", "diameter": 0.02, "material": "steel", "position": np.array([0, 0, 0.04])},
    ],
}


@pytest.fixture(scope="module")
def packed():
    return femdem.pack(**PACK)


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_pack_is_that_of_the_program(packed, program, tmp_path):
    options = "--shape P5 --count 12 --box 3x3 --friction 0.4 --seed 7 --quiet --threads 1".split()
    subprocess.run([program, "pack", *options, "--out", tmp_path / "pack"], check=True)
    for name in ("bodies.csv", "contacts.csv"):
        assert digest(tmp_path / "pack" / name) == digest(packed.folder / name)


def test_a_run_is_that_of_the_program(program, tmp_path):
    scene = ROOT / "scenes" / "bouncing-cube.toml"
    subprocess.run([program, "run", scene, "--quiet", "--out", tmp_path / "run"], check=True)
    result = femdem.run(scene, out=tmp_path / "own")
    assert digest(tmp_path / "run" / "history.csv") == digest(result.folder / "history.csv")


def test_a_deformable_body_is_that_of_the_program():
    dolos = femdem.Shape("dolos", size=0.05)
    # Half a millimetre above the floor.
    height = 0.0005 - dolos.vertices[:, 2].min()
    scene = {
        "duration": 0.004,
        "every": 0.002,
        "contact": {"friction": 0.3},
        "material": {"rubber": {"density": 1100, "law": "neo-hookean", "young": 1e6, "poisson": 0.4}},
        "wall": [{"name": "floor", "plane": {"normal": [0, 0, 1]}}],
        "body": [
            {
                "shape": "dolos",
                "size": 0.05,
                "material": "rubber",
                "behaviour": "deformable",
                "mesh-size": 0.3,
                "position": [0, 0, height],
                "velocity": [0, 0, -1],
            }
        ],
    }
    theirs = femdem.run(scene).world
    contact = {key: value for key, value in theirs.parameters["contact"].items() if value is not None}
    kept = {key: theirs.parameters[key] for key in ("gravity", "time_step", "sleeping", "medium")}
    world = femdem.World(**kept, **contact)
    world.add_wall("floor", **{"plane": {"normal": [0, 0, 1]}})
    place = [0, 0, height, 1, 0, 0, 0]
    (body,) = world.add_deformable(dolos, place, scene["material"]["rubber"], velocity=[0, 0, -1], mesh_size=0.3)
    assert world.masses == pytest.approx([1100 * dolos.volume])
    world.step(until=theirs.time)
    assert world.steps == theirs.steps and len(world.contacts()["a"]) > 0
    for ours, wanted in zip(world.nodes(body), theirs.nodes(0), strict=True):
        assert np.array_equal(ours, wanted)
    assert np.array_equal(world.stresses(body), theirs.stresses(0))


def test_a_pack_has_its_bodies_as_arrays(packed):
    assert packed.summary["settled"] and packed.poses.shape == (12, 7)
    assert np.allclose(np.linalg.norm(packed.poses[:, 3:], axis=1), 1)
    assert [shape.name for shape in packed.shapes] == ["P5"] and set(packed.shape_ids) == {0}
    assert packed.masses == pytest.approx(2560 * packed.shapes[0].volume)
    contacts = packed.contacts
    assert len(contacts["body"]) == len(contacts["class"]) == len(contacts["normal_force"]) > 12
    floor = np.array([wall == "floor" for wall in contacts["wall"]])
    pressed = contacts["normal_force"][floor] @ contacts["normal"][floor]
    assert -pressed[2] == pytest.approx(packed.masses.sum() * 9.81, rel=0.05)
    table = packed.table("bodies.csv")
    assert np.array_equal(table["x"], packed.poses[:, 0])


def test_a_pack_can_be_stepped_on(packed):
    world = packed.world
    assert np.array_equal(world.poses, packed.poses)
    world.step(100)
    assert np.abs(world.positions - packed.world.positions).max() < 1e-4


def test_a_pack_is_measured_drawn_and_resolved(packed):
    measured = femdem.analyse(packed)
    assert measured.folder == packed.folder and len(measured.analysis) > 3
    assert packed._repr_html_().startswith("<code>") and not (packed.folder / "report.html").exists()
    assert femdem.report(packed).report().startswith("<!DOCTYPE html>")
    assert "srcdoc" in packed._repr_html_()
    resolved = femdem.resolve(packed, young=60e9, tolerance=1e-2, mesh_size=1)
    assert len(resolved.table("stress.csv")["body"]) == 12 and resolved.summary
    inside = femdem.stresses(packed, strength=5e6, mesh_size=0.5, linear=True)
    assert inside.folder == packed.folder / "stresses" and len(inside.table("stress.csv")["body"]) == 12
    assert inside.summary["bodies"]
    void = femdem.pores(packed, voxel=0.1, no_surface=True)
    assert void.folder == packed.folder / "pores" and void.summary
    femdem.command("picture", packed.folder, out=packed.folder / "a.png", quiet=True)
    assert (packed.folder / "a.png").stat().st_size > 1000


def test_shapes_of_arrays_are_packed():
    points = [[0, 0, 0], [0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.02]]
    stone = femdem.Shape.convex_hull(points, name="shard")
    pack = femdem.pack(shape=[stone, "P5"], count=6, box="4x4", seed=1, unit="m")
    assert pack.shapes[0].name == "shard"
    assert pack.shapes[0].volume == pytest.approx(stone.volume)


def test_a_dict_is_a_scene(tmp_path):
    result = femdem.run(SCENE)
    assert len(result.poses) == 2 and result.summary["bodies"]
    history = result.table("history.csv")
    assert history["time"][-1] == pytest.approx(0.05, rel=1e-2)
    folder = result.folder
    earlier, height = result.summary, result.poses[1, 2]
    longer = femdem.resume(result, duration=0.06)
    assert longer.world.time >= 0.06
    # Both are of what the folder holds now.
    assert result.summary == longer.summary != earlier
    assert result.poses[1, 2] == longer.poses[1, 2] != height
    written = femdem.run({**SCENE, "out": tmp_path / "run"})
    assert written.folder == tmp_path / "run"
    assert digest(written.folder / "members.csv") == digest(femdem.run(SCENE).folder / "members.csv")
    del result, longer
    assert not folder.exists()


def test_a_temporary_folder_lasts_as_long_as_its_results(packed, tmp_path):
    assert femdem.report(femdem.run(SCENE)).folder.is_dir()
    with pytest.raises(femdem.FemdemError, match="removed with its result"):
        pickle.dumps(packed)
    kept = pickle.loads(pickle.dumps(femdem.run(SCENE, out=tmp_path / "run")))
    assert kept.folder == tmp_path / "run" and len(kept.poses) == 2


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_leaves_the_folder_to_its_parent():
    results = [femdem.run(SCENE)]
    folder = results[0].folder
    child = multiprocessing.get_context("fork").Process(target=results.clear)
    child.start()
    child.join()
    assert child.exitcode == 0 and folder.is_dir()
    results.clear()
    assert not folder.exists()


def test_the_shapes_of_a_result_are_pictures(packed):
    (shape,) = packed.shapes
    world = femdem.World()
    for refused in (
        lambda: world.add(shape, [0, 0, 0, 1, 0, 0, 0], 1000),
        lambda: femdem.pack(shape=shape, count=3),
    ):
        with pytest.raises(femdem.FemdemError, match="shapes of its world"):
            refused()
    assert pickle.loads(pickle.dumps(shape)).is_picture and not world.shapes
    world.add(packed.world.shapes[0], [0, 0, 0, 1, 0, 0, 0], 1000)


def test_help_and_the_version_are_told(capfd):
    femdem.command("pack", "--help")
    femdem.command("--version")
    told = capfd.readouterr().out
    assert "--friction" in told and femdem.__version__ in told


def test_stages_have_results_each(tmp_path):
    # Their names are not in the order of letters.
    stages = [{"name": "then", "duration": 0.01}, {"name": "first", "duration": 0.01}]
    scene = {key: value for key, value in SCENE.items() if key != "duration"}
    result = femdem.run({**scene, "stage": stages}, out=tmp_path / "run")
    # Nor are their files, where an earlier one went on.
    (tmp_path / "run" / "then" / "run.ckpt").touch()
    assert list(result.stages) == ["then", "first"]
    assert len(result.stages["first"].poses) == 2


@pytest.mark.parametrize(
    ("misuse", "words"),
    [
        (lambda: femdem.pack(count=0), ["count"]),
        (lambda: femdem.pack(count=2.5), ["2.5", "--count"]),
        (lambda: femdem.pack(frictoin=0.5), ["--frictoin", "--friction"]),
        (lambda: femdem.pack(friction=-0.5), ["friction", "-0.5"]),
        (lambda: femdem.pack(friction=float("nan")), ["friction = nan"]),
        (lambda: femdem.pack(check=True), ["check"]),
        (lambda: femdem.pack(shape=femdem.Shape("sphere", size=1)), ["ball"]),
        (lambda: femdem.run({**SCENE, "durations": 1}), ["durations", "duration"]),
        (lambda: femdem.run({**SCENE, "body": []}), ["body"]),
        (lambda: femdem.run("nowhere.toml"), ["nowhere.toml"]),
        (lambda: femdem.run({**SCENE, "title": object()}), ["scene.title"]),
        (lambda: femdem.run({**SCENE, "gravity": [0, 0, None]}), ["scene.gravity[2] = None"]),
        (lambda: femdem.pack(shape={"name": "P5"}), ["shape"]),
        (lambda: femdem.pack(count={"number": 3}), ["count"]),
        (lambda: femdem.pack(share=[1, True]), ["share"]),
        (lambda: femdem.analyse("nowhere"), ["nowhere"]),
        (lambda: femdem.command("fly"), ["fly"]),
        (lambda: femdem.Result("nowhere"), ["nowhere"]),
    ],
)
def test_misuse_is_refused_by_name(misuse, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(femdem.FemdemError) as refused:
        misuse()
    assert all(word in str(refused.value) for word in words), refused.value
    assert "Usage" not in str(refused.value) and not list(tmp_path.iterdir())


def test_what_is_not_there_is_named(packed):
    with pytest.raises(femdem.FemdemError, match="bodies.csv"):
        packed.table("history.csv")
    with pytest.raises(femdem.FemdemError, match=r"summary\.json"):
        femdem.Result(packed.folder / "plots").summary  # noqa: B018
