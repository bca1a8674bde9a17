"""Boulders of 40 kg in a bin: docs/tutorials/rock-armour.md, smaller."""

import numpy as np

import femdem

rocks = femdem.pack(
    shape="boulder", variety=10, count=20, mass=40, density=2700, box="1.5x1.5m", protocol="pour", height="1.5m", rate=50, seed=1
)
assert np.allclose(rocks.masses, 40)
forces = np.sort(rocks.contacts["normal_force"])
print(f"{len(rocks.shapes)} forms of boulders; the largest of {len(forces)} contacts bears {forces[-1]:.0f} N")
assert forces[-1] < rocks.masses.sum() * 9.81
