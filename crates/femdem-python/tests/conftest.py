"""What several tests need."""

import os
from pathlib import Path

import numpy as np
import pytest

import femdem

ROOT = Path(__file__).resolve().parents[3]


def place(x, y, z):
    """A pose without rotation."""
    return [x, y, z, 1, 0, 0, 0]


def lattice(n, spacing, low):
    """Poses of n^3 bodies without rotation."""
    grid = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    poses = np.zeros((n**3, 7))
    poses[:, :3] = grid * spacing + low
    poses[:, 3] = 1
    return poses


@pytest.fixture
def box_of_stones():
    """27 stones above the floor of a box."""
    world = femdem.World(friction=0.5)
    world.add_wall("box", box={"lower": [0, 0, 0], "upper": [0.3, 0.3, 2]})
    world.add(femdem.Shape("A10", diameter=0.05), lattice(3, 0.08, 0.06), 2560)
    return world


@pytest.fixture
def program():
    """The Rust program, if there is one: FEMDEM names it."""
    path = os.environ.get("FEMDEM")
    if not path:
        pytest.skip("FEMDEM does not name the program")
    return path
