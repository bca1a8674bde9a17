"""A disc is pressed across its diameter until it splits: docs/tutorials/crushing.md, coarser."""

import tomllib
from pathlib import Path

import femdem

scene = tomllib.loads((Path(__file__).parents[3] / "scenes" / "brazilian.toml").read_text(encoding="utf-8"))
scene["body"][0]["mesh-size"] = 0.1
scene["material"]["concrete"]["fracture"]["coarse"] = True
scene["wall"][1]["motion"]["linear"]["velocity"] = [0, 0, -1.5]
scene.update(duration=1e-3, every=5e-4, out=None)

test = femdem.run(scene)
events = test.table("events.csv")
print({name: values[:3] for name, values in events.items()})
assert len(next(iter(events.values()))) > 0
