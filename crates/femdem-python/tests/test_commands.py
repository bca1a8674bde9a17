"""The commands of the program, and their results."""

import hashlib
import subprocess

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
    page = femdem.report(packed)
    assert page.read_text().startswith("<!DOCTYPE html>")
    assert "srcdoc" in packed._repr_html_()
    resolved = femdem.resolve(packed, young=60e9, tolerance=1e-2, mesh_size=1)
    assert len(resolved.table("stress.csv")["body"]) == 12 and resolved.summary
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
    longer = femdem.resume(result, duration=0.06)
    assert longer.world.time >= 0.06
    written = femdem.run({**SCENE, "out": tmp_path / "run"})
    assert written.folder == tmp_path / "run"
    assert digest(written.folder / "members.csv") == digest(femdem.run(SCENE).folder / "members.csv")
    del result, longer
    assert not folder.exists()


def test_stages_have_results_each(tmp_path):
    stages = [{"name": "first", "duration": 0.01}, {"name": "then", "duration": 0.01}]
    scene = {key: value for key, value in SCENE.items() if key != "duration"}
    result = femdem.run({**scene, "stage": stages}, out=tmp_path / "run")
    assert list(result.stages) == ["first", "then"]
    assert len(result.stages["then"].poses) == 2


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
