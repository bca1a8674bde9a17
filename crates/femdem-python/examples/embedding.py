"""A host moves a plate until it presses a cube with 100 N: docs/embedding.md, in Python."""

import femdem

world = femdem.World(time_step={"safety": 0.3})
world.add_wall("floor", plane={"normal": [0, 0, 1]})
(cube,) = world.add(femdem.Shape("box:width=1,height=1", size=0.1), [0, 0, 0.05, 1, 0, 0, 0], density=2000)
(plate,) = world.add_wall("plate", plane={"normal": [0, 0, -1], "offset": -0.1001})


def servo(world):
    """The plate comes down as long as the force is too small."""
    force = world.walls[plate]["force"][2]
    speed = 2e-4 * (force - 100)
    world.drive_wall(plate, {"linear": {"velocity": [0, 0, speed], "start": world.time, "end": world.time + 1}})


world.step(until=0.2, callback=servo, every=5)
force = world.walls[plate]["force"][2]
print(f"the plate bears {force:.2f} N")
assert abs(force - 100) < 2
