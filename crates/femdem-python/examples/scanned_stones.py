"""Stones from a scan: docs/tutorials/scanned-stones.md, smaller."""

from pathlib import Path

import femdem

scan = Path(__file__).parents[3] / "records" / "stone.stl"
stone = femdem.Shape.from_file(scan, unit="mm")
print(stone, "convex" if stone.is_convex else "not convex")

stones = femdem.pack(shape=scan, unit="mm", count=4, cylinder=3.5, seed=1)
assert abs(stones.masses[0] / (2560 * stone.volume) - 1) < 1e-9
