"""Grains are compressed by a lid that is moved to reach a stress: docs/tutorials/soil-tests.md, smaller."""

import femdem

scene = {
    "duration": 0.15,
    "every": 0.05,
    "contact": {"friction": 0.4},
    "material": {"grain": {"density": 2600}},
    "wall": [
        {
            "name": "cell",
            "box": {"lower": [0, 0, 0], "upper": [0.075, 0.075, 0.06]},
            "control": {"z": {"stress": 2e4, "speed": 0.2, "sides": "upper", "table": [[0, 1]]}},
        }
    ],
    "body": [
        {
            "name": "grain",
            "shape": "A13",
            "diameter": 0.02,
            "material": "grain",
            "position": [0.0125, 0.0125, 0.012],
            "copies": {"count": [3, 3, 2], "spacing": [0.025, 0.025, 0.0225], "seed": 1},
        }
    ],
}

test = femdem.run(scene)
cells = test.table("cells.csv")
print({name: values[-1] for name, values in cells.items() if values.dtype.kind == "f"})
assert test.summary and len(test.poses) == 18
