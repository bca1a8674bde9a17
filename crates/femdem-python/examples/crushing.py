"""A disc is pressed across its diameter until it splits: docs/tutorials/crushing.md, coarser and faster."""

import femdem

scene = {
    "duration": 1e-3,
    "every": 5e-4,
    "gravity": [0, 0, 0],
    "contact": {"friction": 0.3},
    "material": {
        "concrete": {
            "density": 2400,
            "law": "neo-hookean",
            "young": 2e10,
            "poisson": 0.2,
            "fracture": {"tensile": 4e6, "cohesion": 1.6e7, "friction-angle": 35, "energy": [40, 200], "coarse": True},
        }
    },
    "wall": [
        {"name": "anvil", "plane": {"normal": [0, 0, 1], "offset": -0.2}},
        {
            "name": "platen",
            "plane": {"normal": [0, 0, -1], "offset": -0.2},
            "motion": {"linear": {"velocity": [0, 0, -1.5]}},
        },
    ],
    "body": [
        {
            "name": "disc",
            "shape": "cylinder:aspect=0.2",
            "size": 0.4,
            "material": "concrete",
            "behaviour": "breakable",
            "contact-ratio": 2,
            "mesh-size": 0.1,
            "rotation": {"axis": [1, 0, 0], "angle": 90},
        }
    ],
}

test = femdem.run(scene)
events = test.table("events.csv")
print({name: values[:3] for name, values in events.items()})
assert len(next(iter(events.values()))) > 0
