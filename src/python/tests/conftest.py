"""What several tests need."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import costate

ROOT = Path(__file__).parents[3]
SCENES = ROOT / "examples" / "scenes"


class Duffing(costate.Element):
    """An oscillator whose spring has a cubic part."""

    nodes = ["coordinate"]
    parameters = {"mass": costate.positive("kg"), "stiffness": "N/m", "cubic": "N/m3"}

    def residual(self, s, p, t):
        q = s.q[0]
        return [p.mass * s.a[0] + p.stiffness * q + p.cubic * q * q * q]


PENDULUM = """
version = 1
gravity = [0, -9.81, 0]
settings = { end = 1.0, steps = 50 }
variable.length = { initial = 1.0, bounds = [0.1, 10], unit = "m" }
variable.mass = { initial = 2.0, bounds = [0.1, 10], unit = "kg" }
point = [{ name = "bob", position = ["-length", 0, 0], mass = "mass" }]
joint = [{ name = "rod", type = "distance", between = ["ground", "bob"] }]
functional = [
    { name = "height", type = "position", on = "bob", direction = [0, 1, 0], over = "terminal" },
    { name = "force", type = "reaction", joint = "rod", weights = [1], over = "integral" },
]
"""


@pytest.fixture(scope="session")
def pendulum():
    return costate.loads(PENDULUM, "pendulum.toml")


@pytest.fixture(scope="session")
def five_bar():
    return costate.built_in("five-bar")


@pytest.fixture(scope="session")
def command_line():
    """The command line that was built beside the package: COSTATE, or in a target folder of the repository."""
    found = os.environ.get("COSTATE") or shutil.which("costate") or str(ROOT / "target" / "release" / "costate")
    if not Path(found).exists():
        pytest.skip("no command line is built; COSTATE says where one is")
    return found


def same_bits(a, b):
    """Whether numbers are the same to the last bit."""
    return np.array_equal(np.asarray(a).view(np.int64), np.asarray(b).view(np.int64))
