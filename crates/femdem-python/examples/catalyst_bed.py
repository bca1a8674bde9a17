"""A bed of catalyst pellets in a tube, and its void fraction: docs/tutorials/catalyst-bed.md, smaller."""

import femdem

bed = femdem.pack(shape="cylinder", diameter="5mm", cylinder="25mm", count=30, friction=0.4, seed=1)
print("at rest:", bed.summary["settled"], "solid fraction:", bed.summary["packing_density"]["exact"])

touching = bed.contacts["partner"] >= 0
print(f"{touching.sum()} contacts between pellets, {(~touching).sum()} with the tube")
assert len(bed.poses) == 30
# The floor bears nearly all of the weight of so low a bed.
floor = [wall == "floor" for wall in bed.contacts["wall"]]
assert -(bed.contacts["normal_force"] * bed.contacts["normal"][:, 2])[floor].sum() > 0.5 * 9.81 * bed.masses.sum()
