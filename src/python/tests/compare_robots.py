"""The robots of the Python packages example-robot-data and mujoco as ``costate import`` writes them, and in Pinocchio.

``python src/python/tests/compare_robots.py [--program target/release/costate] [FOLDER or FILE.urdf ..]``

Without folders or files the packages are fetched by pip into ``target/robots``, and the script runs itself there. Of
each URDF that Pinocchio can read: import, check and a short run, held at its root and free; masses, mass centres and
tensors of all bodies; accelerations from rest; and, all joints driven to drawn positions, the place of every link and
its derivatives by all joints. Pinocchio takes the tensors that the import says it had to change, and its joints follow
those they mimic. Accelerations are compared where two algorithms of Pinocchio agree on them; what is undetermined is
refused here by name.
"""

import argparse
import csv
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import venv
import xml.etree.ElementTree as Xml

import tomllib

TOLERANCE = 1e-10
PACKAGES = ["example-robot-data", "mujoco", "pin", "numpy"]
ROOT = pathlib.Path(__file__).resolve().parents[3]
# names that a scene cannot take
LINK = {"ground_link": "ground"}


def run_in_own_environment():
    folder = ROOT / "target" / "robots"
    python = folder / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    os.execv(python, [str(python), *sys.argv])


if importlib.util.find_spec("pinocchio") is None:
    run_in_own_environment()

import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402


class Refused(Exception):
    """What costate says."""


class Robot:
    """A URDF in both programs."""

    def __init__(self, file, program, folder, is_free):
        self.program, self.file, self.folder = program, file, folder
        root = [pin.JointModelFreeFlyer()] if is_free else []
        self.model = pin.buildModelFromUrdf(str(file), *root)
        self.scene = folder / "robot.toml"
        self.scene.unlink(missing_ok=True)
        free = ["--free"] if is_free else []
        # what Pinocchio cannot compute either has places only
        self.said, self.refused = "", None
        try:
            self.said = self.costate("import", file, "--out", self.scene, *free)
        except Refused as why:
            if computes(file, is_free) or not self.scene.exists():
                raise
            self.refused, self.said = why.args
        self.parts = tomllib.loads(self.scene.read_text())
        self.data = self.model.createData()
        self.joints = {joint["name"]: joint for joint in self.parts.get("joint", [])}
        self.follow()
        self.compare_inertia()

    def costate(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Refused((done.stderr or done.stdout).strip().splitlines()[-1][:300], done.stdout)
        return done.stdout

    def follow(self):
        """q = G independent + q0 by the formulas of the scene that make joints follow others."""
        mimics = {}
        for joint in Xml.parse(self.file).getroot().iter("joint"):
            mimic = joint.find("mimic")
            if mimic is not None and f"{joint.get('name')} follows {mimic.get('joint')}" in self.joints:
                numbers = [float(mimic.get(key, default)) for key, default in [("multiplier", 1), ("offset", 0)]]
                mimics[joint.get("name")] = (mimic.get("joint"), *numbers)
        model = self.model
        rows, self.q0, self.followers = np.eye(model.nv), pin.neutral(model), set(mimics)

        def resolve(name):
            """The row of a joint, and where it stands while all others are at zero."""
            joint = model.getJointId(name)
            if name not in mimics:
                return np.eye(model.nv)[model.joints[joint].idx_v], 0.0
            leader, multiplier, offset = mimics[name]
            row, place = resolve(leader)
            return multiplier * row, multiplier * place + offset

        for name in mimics:
            row, place = resolve(name)
            joint = model.joints[model.getJointId(name)]
            rows[joint.idx_v] = row
            self.place(self.q0, joint, place)
        columns = {name: model.joints[model.getJointId(name)].idx_v for name in model.names[1:]}
        self.map = np.delete(rows, [columns[name] for name in mimics], axis=1)
        # what drivers hold, as it moves nothing that has inertia
        self.held = {driver["name"].removesuffix(" held") for driver in self.parts.get("driver", [])}
        self.moving = np.delete(rows, [columns[name] for name in [*mimics, *self.held]], axis=1)

    @staticmethod
    def place(q, joint, value):
        # a continuous joint has cosine and sine
        q[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]

    def compare_inertia(self):
        """The numbers of all bodies; Pinocchio takes those that were changed, as the import says."""
        self.inertia, model = 0.0, self.model
        changed = [line for line in self.said.splitlines() if "no body can have" in line]
        for body, (name, link) in zip(self.parts["body"], self.bodies(), strict=True):
            joint = model.frames[self.frame(link)].parentJoint
            own, there = body.get("mass", 0.0), model.inertias[joint]
            xx, yy, zz, xy, xz, yz = [*body.get("inertia", [0, 0, 0]), 0, 0, 0][:6]
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            centre = np.array(body.get("mass_centre", [0.0] * 3))
            if any(json.dumps(name) in line.rpartition(":")[2] for line in changed):
                model.inertias[joint] = pin.Inertia(own, centre, tensor)
            elif joint > 0:
                size = np.abs(there.inertia).max() + own * centre @ centre
                off = [abs(own - there.mass), own * np.abs(centre - there.lever).max()]
                off = [*(figure / (own or 1) for figure in off), np.abs(tensor - there.inertia).max() / (size or 1)]
                self.inertia = max(self.inertia, *off)

    def histories(self, scene):
        out = self.folder / "out"
        self.costate("run", scene, "--no-report", "--out", out)
        with open(out / "histories.csv", newline="") as file:
            rows = csv.reader(file)
            names = [name.split(" [")[0] for name in next(rows)]
            return [dict(zip(names, map(float, row), strict=True)) for row in rows]

    def accelerations(self):
        """Largest difference of accelerations from rest, by the largest and gravity: of each body at three points."""
        model, data = self.model, self.data
        zero = np.zeros(model.nv)
        if self.moving.shape[1] == model.nv:
            acceleration = pin.aba(model, data, self.q0, zero, zero)
        else:
            mass, weight = np.triu(pin.crba(model, data, self.q0)), pin.rnea(model, data, self.q0, zero, zero)
            mass += np.triu(mass, 1).T
            acceleration = self.moving @ np.linalg.solve(self.moving.T @ mass @ self.moving, -self.moving.T @ weight)
        pin.forwardKinematics(model, data, self.q0, zero, acceleration)
        expected, points, links = {}, [], []
        for body, link in self.bodies():
            moved = pin.getFrameClassicalAcceleration(model, data, self.frame(link), pin.LOCAL_WORLD_ALIGNED)
            expected[body] = moved.linear
            for axis in np.eye(3)[:2]:
                name = f"{body} {len(points)}"
                place = (np.array(self.parts["body"][len(points) // 2]["position"]) + axis).tolist()
                expected[name] = moved.linear + np.cross(moved.angular, axis)
                points.append({"name": name, "position": place})
                links.append({"name": name, "type": "rigid_link", "between": [body, name]})
        rows = self.histories(self.extended("settings = { end = 0.01, steps = 10 }", point=points, joint=links))
        given = {name: np.array([rows[0][f"{name}.d2{x}/dt2"] for x in "xyz"]) for name in expected}
        # of a robot in equilibrium they are small beside gravity
        size = max(np.linalg.norm(model.gravity.linear), *(np.abs(own).max() for own in expected.values()))
        return max(np.abs(given[name] - expected[name]).max() for name in expected) / size

    def places(self, draw):
        """Largest differences of places of links and of their derivatives by the joints, all of which are driven; none
        without joints, and with such of several freedoms."""
        model, data = self.model, self.data
        single = [name for joint, name in list(zip(model.joints, model.names))[1:] if joint.nv == 1]
        free = [name for name in single if name not in self.followers]
        if not free or len(free) != self.map.shape[1]:
            return {}
        drivers, values, variables = [], [], ["settings = { end = 1, steps = 10 }"]
        for k, name in enumerate(free):
            joint = self.joints[name]
            slides = joint["type"] == "prismatic"
            values.append(draw.uniform(-1, 1) * (0.2 if slides else 1.0))
            ramp = {"type": "smooth_ramp", "to": f"to_{k}", "duration": 1}
            own = {"type": "translation", "origin": joint["point"], "point": joint["point"], "displacement": ramp}
            own = own if slides else {"type": "rotation", "angle": ramp}
            own["name"] = f"{name} held" if name in self.held else f"to {name}"
            drivers.append({**own, "between": joint["between"], "axis": joint["axis"]})
            variables.append(f"variable.to_{k} = {{ initial = {values[k]!r}, bounds = [-2, 2] }}")
        pin.computeJointJacobians(model, data, pin.integrate(model, self.q0, self.map @ values))
        pin.updateFramePlacements(model, data)
        expected, functionals = {}, []
        for link, on in self.points().items():
            frame, direction = self.frame(link), draw.normal(size=3)
            jacobian = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            # of one joint it has one column, and comes as a list
            slopes = direction @ np.reshape(jacobian, (6, -1))[:3] @ self.map
            expected[link] = direction @ data.oMf[frame].translation, slopes
            position = {"name": link, "type": "position", "over": "terminal", **on}
            functionals.append({**position, "direction": direction.tolist()})
        scene = self.extended(*variables, driver=drivers, functional=functionals)
        said = self.costate("gradient", scene, "--json", "--no-report", "--out", self.folder / "out")
        given = {own["name"]: own for own in json.loads(said.splitlines()[-1])["functionals"]}
        size = max(1.0, *(np.abs(data.oMf[self.frame(link)].translation).max() for link in expected))
        off = slope = 0.0
        for link, (value, derivatives) in expected.items():
            gradient = np.array([given[link]["gradient"][f"to_{k}"] for k in range(len(free))])
            off = max(off, abs(given[link]["value"] - value) / size)
            slope = max(slope, np.abs(gradient - derivatives).max(initial=0.0) / size)
        return {"places": off, "gradients": slope}

    def frame(self, link):
        return self.model.getFrameId(link, pin.FrameType.BODY)

    def bodies(self):
        """Bodies with the links after which they are named."""
        return [(body["name"], LINK.get(body["name"], body["name"])) for body in self.parts["body"]]

    def points(self):
        """Links with where they are in the scene: a body, and the name of the place if they are welded to another."""
        points = {link: {"on": body} for body, link in self.bodies()}
        for line in self.scene.read_text().splitlines():
            name, is_frame, comment = line.partition("] # ")
            if is_frame:
                name = name.split(" = ")[0]
                link, _, body = comment.rpartition("on ")
                points[json.loads(link.rstrip(", ")) if link else name] = {"on": json.loads(body), "point": name}
        return points

    def extended(self, *lines, **lists):
        """A scene with more in it."""
        text = ["version = 1", f"extends = {json.dumps(self.scene.name)}", *lines]
        for key, entries in lists.items():
            text += [f"{key} = [", *(f"    {toml(entry)}," for entry in entries), "]"]
        scene = self.folder / "extended.toml"
        scene.write_text("\n".join(text))
        return scene


def toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(own)}" for key, own in value.items()) + " }"
    return json.dumps(value)


def compare(file, program, folder):
    """A line of the table, and whether all is right."""
    figures, worst, word = [], 0.0, "right"
    for is_free in [False, True]:
        try:
            robot = Robot(file, program, folder, is_free)
            off = {"inertia": robot.inertia}
            if robot.refused:
                word = "refused"
                figures.append(f"no accelerations in Pinocchio, and here: {robot.refused}")
            else:
                off["accelerations"] = robot.accelerations()
            if not is_free:
                off |= robot.places(np.random.default_rng(len(file.read_bytes())))
            figures += [f"{name} {figure:.0e}" for name, figure in off.items()]
            worst = max(worst, *off.values())
        except Refused as why:
            figures.append(f"{'free' if is_free else 'held'}: {why.args[0]}")
            worst = np.inf
    word = word if worst < TOLERANCE else "WRONG"
    return f"{word}  {file.stem}: {'; '.join(figures)}", worst < TOLERANCE


def computes(file, is_free):
    """Whether Pinocchio has accelerations: two of its algorithms say the same."""
    model = pin.buildModelFromUrdf(str(file), *([pin.JointModelFreeFlyer()] if is_free else []))
    data, q, zero = model.createData(), pin.neutral(model), np.zeros(model.nv)
    by_bodies = pin.aba(model, data, q, zero, zero)
    mass, weight = np.triu(pin.crba(model, data, q)), pin.rnea(model, data, q, zero, zero)
    try:
        by_mass = np.linalg.solve(mass + np.triu(mass, 1).T, -weight)
    except np.linalg.LinAlgError:
        return False
    return bool(np.abs(by_bodies - by_mass).max(initial=0) <= 1e-6 * np.abs(by_bodies).max(initial=0))


def readable(file):
    # in a process of its own, which some files end
    reads = "import sys, pinocchio; pinocchio.buildModelFromUrdf(sys.argv[1])"
    return subprocess.run([sys.executable, "-c", reads, file], capture_output=True, check=False).returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "target" / "release" / "costate", type=pathlib.Path)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    files = options.files or [pathlib.Path(sys.prefix)]
    files = sorted({file for given in files for file in ([given] if given.is_file() else given.rglob("*.urdf"))})
    right = []
    for file in filter(readable, files):
        with tempfile.TemporaryDirectory() as folder:
            line, is_right = compare(file, options.program.resolve(), pathlib.Path(folder))
        print(line, flush=True)
        right.append(is_right)
    print(f"{sum(right)} of {len(right)} right; {len(files) - len(right)} files that Pinocchio cannot read")
    sys.exit(0 if all(right) else 1)


if __name__ == "__main__":
    main()
