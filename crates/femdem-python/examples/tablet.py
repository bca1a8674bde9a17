"""A tablet is squeezed across its diameter: docs/tutorials/tablet.md, coarser and shorter."""

import numpy as np

import femdem

disc = femdem.Shape("cylinder:aspect=0.4", size=0.01)
world = femdem.World(gravity=(0, 0, 0), friction=0.3)
world.add_wall("anvil", plane={"normal": [0, 0, 1], "offset": -0.00497})
world.add_wall(
    "platen",
    plane={"normal": [0, 0, -1], "offset": -0.00497},
    motion={"linear": {"velocity": [0, 0, -1]}},
)
compact = {"density": 1500, "law": "neo-hookean", "young": 1e9, "poisson": 0.25}
turned = [0, 0, 0, np.sqrt(0.5), np.sqrt(0.5), 0, 0]
(tablet,) = world.add_deformable(disc, turned, compact, mesh_size=0.15)
world.step(until=1e-4)

load = world.walls[1]["force"][2]
stresses = world.stresses(tablet)
print(f"{load:.1f} N; mean stress along the load {stresses[:, 2].mean() / 1e6:.2f} MPa")
assert load > 1 and stresses[:, 2].mean() < 0
