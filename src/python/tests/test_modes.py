"""Modes and frequency responses: the same as the command line has, derivatives against closed forms."""

import json
import subprocess

import numpy as np
import pytest
from conftest import same_bits

import costate

SLIDER = """
version = 1
name = "slider"
settings = { end = 1, steps = 10 }
variable.m = { initial = 2, bounds = [0, 100], unit = "kg" }
variable.c = { initial = 8, bounds = [0, 100], unit = "N s/m" }
variable.k = { initial = 200, bounds = [0, 1000], unit = "N/m" }
variable.push = { initial = 0, bounds = [-10, 10], unit = "N" }
body = [{ name = "mass", mass = "m", inertia = [1, 1, 1] }]
joint = [{ name = "slide", type = "prismatic", between = ["ground", "mass"], axis = [1, 0, 0] }]
spring = [{ name = "spring", type = "slide", between = ["ground", "mass"], axis = [1, 0, 0], stiffness = "k", damping = "c" }]
force = [{ name = "push", on = "mass", direction = [1, 0, 0], size = "push" }]
functional = [{ name = "x", type = "position", on = "mass", direction = [1, 0, 0], over = "terminal" }]
"""


@pytest.fixture(scope="module")
def slider():
    return costate.loads(SLIDER)


def test_undamped_modes_have_the_derivatives_of_their_closed_form(slider):
    (mode,) = slider.modes(count=3, gradients=True)
    assert mode.frequency == pytest.approx(10, rel=1e-13) and mode.growth == 0 and mode.damping_ratio == 0
    np.testing.assert_allclose(mode.frequency_gradient, [-2.5, 0, 0.025, 0], rtol=1e-12, atol=1e-14)
    assert mode.equal == 1 and mode.whirl is None


def test_damped_modes_follow_the_design(slider):
    for c in (0.0, 8.0, 20.0):
        (mode,) = slider.modes({"c": c}, count=1, damped=True, gradients=True)
        value = mode.growth + 1j * mode.frequency
        assert abs(2 * value**2 + c * value + 200) < 1e-10
        own = np.array(mode.growth_gradient) + 1j * np.array(mode.frequency_gradient)
        np.testing.assert_allclose(own, -np.array([value**2, value, 1, 0]) / (4 * value + c), rtol=1e-11, atol=1e-12)
        assert mode.damping_ratio == pytest.approx(c / 40, abs=1e-12)


def test_without_derivatives_there_are_none(slider):
    (mode,) = slider.modes(count=1)
    assert mode.frequency_gradient is None and mode.growth_gradient is None and mode.equal is None


def test_what_stands_still_is_a_motion_of_any_period(slider):
    (mode,) = costate.loads(SLIDER.replace("end = 1, steps = 10", "end = 0.2, steps = 100")).modes(periodic=True)
    assert mode.growth == pytest.approx(-2, rel=1e-6) and mode.frequency == pytest.approx(96**0.5, rel=1e-6)
    for others in ({"damped": True}, {"gradients": True}, {"static": True}):
        with pytest.raises(costate.InputError, match="leave the others out"):
            slider.modes(periodic=True, **others)


def test_a_response_is_the_receptance(slider):
    rates = np.array([0.0, 3.0, 10.0, 50.0])
    own = slider.response("push", rates)
    assert own.shape == (4, 1)
    np.testing.assert_allclose(own[:, 0], 1 / (200 + 8j * rates - 2 * rates**2), rtol=1e-12)
    assert slider.response("push", 3.0).shape == (1, 1)


@pytest.mark.parametrize("count", [0, -1, 1.5, True, "six"])
def test_wrong_counts_are_said(slider, count):
    with pytest.raises(costate.InputError, match="whole number from 1"):
        slider.modes(count=count)


def test_what_is_wrong_is_said_in_the_words_of_the_library(slider):
    with pytest.raises(costate.InputError, match="wind"):
        slider.response("wind", [1.0])
    with pytest.raises(costate.Error, match="equilibrium"):
        costate.built_in("pendulum").modes()


def test_the_command_line_has_the_same_bits(command_line, tmp_path):
    own = costate.built_in("von-mises-truss").modes(gradients=True)
    command = [command_line, "modes", "von-mises-truss", "--gradients", "--json", "--out", str(tmp_path)]
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1])
    assert same_bits(
        np.array([mode.frequency for mode in own]), np.array([mode["omega_rad_s"] for mode in told["modes"]])
    )
    rows = np.array([list(mode["omega_rad_s"].values()) for mode in told["gradients"]])
    assert same_bits(np.array([mode.frequency_gradient for mode in own]), rows)
