"""Values and gradients are those of the command line, to the last bit."""

import json
import subprocess

import numpy as np
import pytest
from conftest import SCENES, same_bits

import costate

NAMES = ["five-bar", "pendulum", "slider-crank", "gear-train", "heavy-top", "flyball-governor", "quarter-car"]


def printed(command_line, scene, folder, *options):
    line = [command_line, "gradient", str(scene), "--json", "--no-report", "--out", str(folder), *options]
    done = subprocess.run(line, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.strip().splitlines()[-1])


def compare(said, scene, x=None):
    run = scene.run(x)
    gradient = run.gradient()
    functionals = said["functionals"]
    values = [own["value"] for own in functionals]
    assert same_bits(values, run.values), (values, run.values)
    rows = np.array([[own["gradient"][v.name] for v in scene.variables] for own in functionals])
    assert same_bits(rows, gradient.rows)


@pytest.mark.parametrize("name", NAMES)
def test_scene_files_give_the_bits_of_the_command_line(name, command_line, tmp_path):
    file = SCENES / f"{name}.toml"
    compare(printed(command_line, file, tmp_path), costate.load(file))


@pytest.mark.parametrize("name", ["five-bar", "double-pendulum"])
def test_built_in_scenes_do_too(name, command_line, tmp_path):
    compare(printed(command_line, name, tmp_path), costate.built_in(name))


def test_so_does_another_design(command_line, tmp_path):
    said = printed(command_line, "five-bar", tmp_path, "--set", "k1=123.4")
    compare(said, costate.built_in("five-bar"), {"k1": 123.4})
