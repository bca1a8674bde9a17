"""A soft cube bounces, and stresses inside the bodies of a pack: docs/tutorials/impact-and-stress.md, smaller."""

import numpy as np

import femdem

world = femdem.World(friction=0.0)
world.add_wall("floor", plane={"normal": [0, 0, 1]})
rubber = {"density": 1100, "law": "neo-hookean", "young": 1e6, "poisson": 0.4}
cube = femdem.Shape("cube", size=0.02)
(body,) = world.add_deformable(cube, [0, 0, 0.0101, 1, 0, 0, 0], rubber, velocity=[0, 0, -1], mesh_size=0.5)
heights = []
world.step(until=0.01, callback=lambda world: heights.append(world.positions[0, 2]), every=20)
print(f"pressed to {min(heights) * 1e3:.2f} mm, then back at {world.velocities[0, 2]:.2f} m/s")
assert min(heights) < 0.0095 and world.velocities[0, 2] > 0

pack = femdem.pack(shape="A10", count=8, box="2.5x2.5", seed=1)
stress = femdem.resolve(pack, young=60e9, poisson=0.22, mesh_size=1, tolerance=1e-2).table("stress.csv")
print("columns of the mean stresses:", ", ".join(stress))
assert all(np.isfinite(values).all() for values in stress.values() if values.dtype.kind == "f")
