"""Dice in a drum that turns, stepped from Python: docs/tutorials/silo-and-drum.md, smaller."""

import numpy as np

import femdem

world = femdem.World(friction=0.5)
world.add_wall(
    "drum",
    cylinder={"diameter": 0.16, "from": [0, -0.04, 0], "to": [0, 0.04, 0], "ends": "both"},
    motion={"turn": {"axis": [0, 1, 0], "rate": 4, "start": 0.1}},
)
grid = np.stack(np.meshgrid(*[np.arange(n) for n in (4, 3, 2)], indexing="ij"), -1).reshape(-1, 3)
poses = np.zeros((len(grid), 7))
poses[:, :3] = grid * 0.021 + [-0.03, -0.021, -0.05]
poses[:, 3] = 1
world.add(femdem.Shape("cube", size=0.012), poses, density=700)

work = []
world.step(until=0.3, callback=lambda world: work.append(world.ledger()["work_in"]), every=200)
ledger = world.ledger()
print(f"after {world.time:.2f} s the drum has done {work[-1]:.2e} J, the ledger misses {ledger['error_relative']:.1e}")
assert work[-1] > 0 and abs(ledger["error_relative"]) < 0.05
# No die has left the drum.
assert np.linalg.norm(world.positions[:, [0, 2]], axis=1).max() < 0.08
