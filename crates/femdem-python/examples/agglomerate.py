"""Cemented grains are thrown on a plate and break apart: scenes/agglomerate.toml, smaller."""

import numpy as np

import femdem

grain = femdem.Shape("sphere", diameter=0.002)
world = femdem.World(friction=0.4, penalty=1e9)
world.add_wall("plate", plane={"normal": [0, 0, 1]})
poses = np.zeros((64, 7))
poses[:, :3] = 0.002 * np.stack(np.unravel_index(np.arange(64), (4, 4, 4)), axis=1) + [0, 0, 0.00101]
poses[:, 3] = 1
grains = world.add(grain, poses, density=2500, velocity=[6, 0, -6])
world.add_bonds(grains, gap=1e-6, ratio=0.5, tensile=1e6, cohesion=3e6, energy=[2, 10], stiffness=1e12, damping=0.05)
world.step(until=3e-4)

bonds = world.bonds()
pieces = sorted((len(piece) for piece in world.bonded_pieces()), reverse=True)
print(f"{bonds['broken'].sum()} of {len(bonds['bond'])} bonds are broken; pieces of {pieces[:5]} grains")
print(f"taken by them: {bonds['dissipated'].sum():.1e} J; by sliding {np.mean(bonds['mode'][bonds['broken']] > 0.5):.0%}")
assert len(bonds["bond"]) == 144 and bonds["broken"].any() and len(pieces) > 1 and sum(pieces) == 64
