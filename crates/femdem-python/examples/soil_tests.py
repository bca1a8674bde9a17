"""Grains are compressed by a lid that is moved to reach a stress: docs/tutorials/soil-tests.md, smaller.

The scene file is changed as a dict, which has the same keys.
"""

import tomllib
from pathlib import Path

import femdem

scene = tomllib.loads((Path(__file__).parents[3] / "scenes" / "oedometer.toml").read_text(encoding="utf-8"))
scene["body"][0]["copies"]["count"] = [3, 3, 2]
scene["wall"][0]["box"] = {"lower": [0, 0, 0], "upper": [0.075, 0.075, 0.06]}
scene["wall"][0]["control"]["z"]["table"] = [[0, 1]]
scene.update(duration=0.15, every=0.05, rest=None, out=None)

test = femdem.run(scene)
cells = test.table("cells.csv")
print({name: values[-1] for name, values in cells.items() if values.dtype.kind == "f"})
assert test.summary and len(test.poses) == 18
