"""MuJoCo moves polyhedra whose contacts femdem computes: docs/embedding.md, "A real host". Takes a number of bodies, 500."""

import sys
import time

import mujoco
import numpy as np

import femdem

G = 9.81
DENSITY = 2500.0


class Host:
    """Free bodies of MuJoCo, with the contacts of a batch.

    The origin of each shape is its centroid, so that it is the centre of mass of MuJoCo's body, too.
    """

    def __init__(self, batch, poses, dt, gravity=G):
        self.batch, self.dt = batch, dt
        rows = []
        for pose, mass, inertia in zip(poses, batch.masses, batch.inertias, strict=True):
            x, y, z, *quaternion = pose
            i = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            rows.append(
                f'<body pos="{x} {y} {z}" quat="{" ".join(map(repr, map(float, quaternion)))}"><freejoint/>'
                f'<inertial pos="0 0 0" mass="{mass}" fullinertia="{" ".join(map(repr, i.tolist()))}"/></body>'
            )
        # Semi-implicit Euler: velocities lead places by half a step, as those that the dashpots expect.
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option integrator="Euler" timestep="{dt}" gravity="0 0 {-gravity}"><flag contact="disable"/></option>'
            f"<worldbody>{''.join(rows)}</worldbody></mujoco>"
        )
        self.data = mujoco.MjData(self.model)

    @property
    def poses(self):
        """x, y, z, qw, qx, qy, qz: MuJoCo has the order of femdem."""
        return self.data.qpos.reshape(-1, 7)

    @property
    def velocities(self):
        """Those of the centres of mass, world axes."""
        return self.data.qvel.reshape(-1, 6)[:, :3]

    @property
    def spins(self):
        """Angular velocities in world axes: MuJoCo has those of free joints in the axes of the body."""
        return np.einsum("nij,nj->ni", self.turns(), self.data.qvel.reshape(-1, 6)[:, 3:])

    def turns(self):
        """Rotation matrices, as of the last kinematics."""
        return self.data.xmat[1:].reshape(-1, 3, 3)

    def step(self, count=1):
        """Takes steps: forces at the present places, then velocities, then places."""
        for _ in range(count):
            mujoco.mj_step1(self.model, self.data)
            forces, torques = self.batch.update(self.poses, self.velocities, self.spins, dt=self.dt)
            # At the centre of mass, world axes.
            self.data.xfrc_applied[1:, :3], self.data.xfrc_applied[1:, 3:] = forces, torques
            mujoco.mj_step2(self.model, self.data)

    def kinetic_energy(self):
        """J."""
        w = self.data.qvel.reshape(-1, 6)[:, 3:]
        turning = np.einsum("ni,nij,nj", w, self.batch.inertias, w)
        return 0.5 * (self.batch.masses @ (self.velocities**2).sum(axis=1) + turning)

    def potential_energy(self):
        """Of gravity, J."""
        return G * self.batch.masses @ self.poses[:, 2]


def shapes(size):
    """Five shapes of one diameter."""
    points = np.random.default_rng(7).normal(size=(14, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    stone = femdem.Shape.convex_hull(points * size / 2)
    stone = femdem.Shape.convex_hull(stone.vertices - stone.centroid, name="stone")
    return [stone, *(femdem.Shape(name, diameter=size) for name in ("P1", "P3", "P5", "A10"))]


def falls_and_spins():
    """Without contact: the path of semi-implicit Euler, and the angular momentum."""
    brick = femdem.Shape("box:width=0.5,height=0.25", size=0.2)
    lost = []
    for dt in (1e-3, 5e-4):
        batch = femdem.ContactBatch()
        batch.add(brick, DENSITY)
        host = Host(batch, [[0, 0, 10, 1, 0, 0, 0]], dt)
        host.data.qvel[:] = [1, 0, 0, 3, 4, 5]
        momentum = batch.inertias[0] @ [3, 4, 5]
        host.step(round(1 / dt))
        t = host.data.time
        assert np.allclose(host.poses[0, :3], [t, 0, 10 - G * t * (t + dt) / 2], rtol=0, atol=1e-10)
        mujoco.mj_kinematics(host.model, host.data)
        turn = host.turns()[0]
        now = turn @ batch.inertias[0] @ turn.T @ host.spins[0]
        lost.append(np.linalg.norm(now - momentum) / np.linalg.norm(momentum))
    # What MuJoCo loses is of first order in its step.
    assert lost[0] < 0.03 and 1.7 < lost[0] / lost[1] < 2.3, lost
    print(f"fall exact; angular momentum off by {lost[0]:.1e}, {lost[1]:.1e} at half the step")


def rests():
    """A cube on a floor sinks by h m g/(2 p a^2): a wall is as stiff as an equal face that meets it."""
    side, penalty = 0.1, 1e6
    batch = femdem.ContactBatch(penalty=penalty)
    batch.add(femdem.Shape("box:width=1,height=1", size=side), DENSITY)
    (floor,) = batch.add_wall("floor", plane={"normal": [0, 0, 1]})
    host = Host(batch, [[0, 0, side / 2, 1, 0, 0, 0]], 1e-4)
    host.step(10000)
    depth = side / 2 - host.poses[0, 2]
    weight = G * batch.masses[0]
    said = side / 2 * weight / (2 * penalty * side**2)
    assert abs(depth / said - 1) < 0.01, (depth, said)
    assert abs(batch.walls[floor]["force"][2] / -weight - 1) < 1e-6
    print(f"cube at rest {depth * 1e6:.2f} um deep, {said * 1e6:.2f} um by the formula")


def bounces():
    """Without friction and dashpots energy is kept."""
    batch = femdem.ContactBatch(penalty=5e6, friction=0, damping_ratio=0)
    poses = start(batch, 27, 0.1)
    batch.add_wall("box", box={"lower": [0, 0, 0], "upper": [0.36, 0.36, 0.5]})
    host = Host(batch, poses, 1e-5)
    host.data.qvel[:] = np.random.default_rng(3).normal(size=host.data.qvel.shape)
    batch.update(host.poses, dt=0)
    energies = []
    for _ in range(100):
        host.step(100)
        energies.append(host.kinetic_energy() + host.potential_energy() + batch.totals["energy"])
    worst = np.abs(np.array(energies) / energies[0] - 1).max()
    assert worst < 2e-3, worst
    print(f"27 bodies bounce: energy off by {worst:.1e} at most")


def start(batch, count, size):
    """Adds bodies of all shapes, and returns their poses on a lattice."""
    side = 3 if count < 100 else 6
    turn = np.random.default_rng(1)
    kinds = shapes(size)
    for k, shape in enumerate(kinds):
        batch.add(shape, DENSITY, count=(count - k + len(kinds) - 1) // len(kinds))
    order = np.random.default_rng(2).permutation(count)
    cells = np.stack([order % side, order // side % side, order // side**2], axis=1)
    quaternions = turn.normal(size=(count, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    return np.hstack([1.15 * size * (cells + 0.5), quaternions])


def fill(count, dt=2e-4, until=1.5):
    """Bodies fall into a box and come to rest, moved by MuJoCo and by femdem's own world."""
    law = {"penalty": 1e6, "friction": 0.5}
    size, side = 0.1, 3 if count < 100 else 6
    box = {"lower": [0, 0, 0], "upper": [1.15 * size * side, 1.15 * size * side, 100], "open": True}
    batch = femdem.ContactBatch(**law)
    poses = start(batch, count, size)
    batch.add_wall("box", box=box)
    host = Host(batch, poses, dt)
    began = time.perf_counter()
    host.step(round(until / dt))
    took = time.perf_counter() - began

    world = femdem.World(sleeping=False, time_step={"largest": dt}, **law)
    world.add_wall("box", box=box)
    first = 0
    for shape in shapes(size):
        some = sum(own.name == shape.name for own in batch.shapes)
        world.add(shape, poses[first : first + some], DENSITY)
        first += some
    world.step(until=until)

    heights = [host.poses[:, 2].mean(), world.poses[:, 2].mean()]
    volume = sum(shape.volume for shape in batch.shapes)
    # The heap is as high as twice the mean height of its mass.
    densities = [volume / (box["upper"][0] ** 2 * 2 * z) for z in heights]
    moving = host.kinetic_energy() / (batch.masses.sum() * G * size)
    fell = [batch.masses @ (poses[:, 2] - z) for z in (host.poses[:, 2], world.poses[:, 2])]
    print(f"{count} bodies: density {densities[0]:.3f}, {densities[1]:.3f} by femdem's world; {took:.0f} s for {until} s")
    print(f"energy lost {fell[0] * G:.1f} J and {fell[1] * G:.1f} J; what still moves {moving:.0e} of m g d")
    assert moving < 1e-3 and abs(densities[0] / densities[1] - 1) < 0.03 and abs(fell[0] / fell[1] - 1) < 0.03
    borne = -sum(wall["force"][2] for wall in batch.walls.values())
    assert abs(borne / (batch.masses.sum() * G) - 1) < 0.01, borne


if __name__ == "__main__":
    falls_and_spins()
    rests()
    bounces()
    fill(int(sys.argv[1]) if len(sys.argv) > 1 else 500)
