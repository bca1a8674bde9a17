"""Permeability along z of what `femdem pores DIR` wrote, by lbmpy's lattice Boltzmann method: permeability.py DIR/pores"""

import json
import sys
from pathlib import Path

import numpy as np
from lbmpy import LBMConfig, LBStencil, Method, Stencil
from lbmpy.boundaries import NoSlip
from lbmpy.lbstep import LatticeBoltzmannStep

VISCOSITY = 1 / 6  # of the lattice: relaxation rate 1
FORCE = 1e-6  # along z, small enough for creeping flow
BUFFER = 10  # empty layers where z does not repeat itself
STEADY = 1e-5  # relative change of the flow in 100 steps

pores = Path(sys.argv[1])
found = json.loads((pores / "pores.json").read_text())
if found["sides"] == "open":
    sys.exit("the sides are cuts: give `femdem pores` the option --sides wall, or a periodic pack")
phases = np.fromfile(pores / "phases.raw", np.uint8).reshape(found["counts"][::-1]).transpose()
outside = np.all(phases == 2, axis=2)
solid, height = phases != 0, phases.shape[2]
if not found["periodic"][2]:
    solid = np.concatenate([solid, np.repeat(outside[:, :, None], BUFFER, axis=2)], axis=2)

# The lattice repeats itself along z; along x and y there are walls where the pack does not repeat itself.
repeats = (*found["periodic"][:2], True)
around = solid
for axis, repeat in enumerate(repeats):
    width = [(int(k == axis),) * 2 for k in range(3)]
    around = np.pad(around, width, "wrap") if repeat else np.pad(around, width, constant_values=True)


def cell(x: np.ndarray) -> np.ndarray:
    return np.floor(x).astype(int) + 1


config = LBMConfig(
    stencil=LBStencil(Stencil.D3Q19), method=Method.TRT, relaxation_rate=1 / (3 * VISCOSITY + 0.5), force=(0, 0, FORCE)
)
lattice = LatticeBoltzmannStep(domain_size=solid.shape, periodicity=repeats, lbm_config=config)
lattice.boundary_handling.set_boundary(NoSlip(), mask_callback=lambda x, y, z: around[cell(x), cell(y), cell(z)])
flow, before = 0.0, np.inf
while abs(flow - before) > STEADY * abs(flow):
    lattice.run(100)
    speeds = np.where(solid, 0, lattice.velocity[:, :, :, 2])
    before, flow = flow, float(speeds.sum()) / solid.shape[2] / np.count_nonzero(~outside)

# Darcy: flow = k/viscosity x drop, where the force on all layers is balanced by those of the bed.
drop = FORCE * solid.shape[2] / height
print("permeability in m2:", VISCOSITY * flow / drop * float(np.prod(found["spacing"])) ** (2 / 3))
