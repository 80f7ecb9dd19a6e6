"""Contact and friction here and in MuJoCo, Drake and Exudyn, on scenes with closed forms: prints tables.

``pip install mujoco drake exudyn``, then ``python other-codes.py PATH_TO_COSTATE``, some seven minutes; a code that is
not there is left out. Scenes of costate are in the folder ``other-codes``.
"""

import cmath
import json
import logging
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from importlib.metadata import distributions, version
from math import cos, log, pi, sin, sqrt

os.environ.update(RAYON_NUM_THREADS="1", OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
import numpy as np  # noqa: E402

NOTES = """Errors are relative to the closed form, but of the way that is zero, in m. Letters tell how a derivative was
found: a adjoint; c chain of the matrices of mjd_transitionFD (centred, eps 1e-6 and 1e-8); f forward by AutoDiffXd;
d central differences of whole runs (relative steps 1e-2, 1e-4, 1e-6). Of several eps or steps the one nearest to the
closed form is shown, which nobody could choose without it. Times are milliseconds of one thread's processor: building
the model and running it, the least of up to three, and this with all derivatives, by the first letter. Those of costate
are of its whole process, which starts, reads a file, compiles, and writes histories."""

GRAVITY, RADIUS = 9.81, 0.1

# name: title, end, parameters (of a law, then of the start), outputs, derivatives
SCENES = {
    "bounce": ("Ball dropped from h = 1 m with e = 0.8, height after four bounces, at 2.5 s", 2.5,
               {"e": 0.8, "h": 1.0}, ["z"], [("z", "e"), ("z", "h")]),
    "slide": ("Block that slides at v = 2 m/s with mu = 0.4 and stops: v^2/(2 mu g), at 1 s", 1.0,
              {"mu": 0.4, "v": 2.0}, ["x"], [("x", "mu"), ("x", "v")]),
    "creep": ("Block at rest on a slope of 0.3 rad with mu = 0.4: its way in 10 s", 10.0, {"mu": 0.4}, ["x"], []),
    "bowl": ("Ball that slides at v = 8 m/s with mu = 0.2, then rolls: time 2 v/(7 mu g), speed 5/7 v, way in 4 s", 4.0,
             {"mu": 0.2, "v": 8.0}, ["time", "speed", "x"], [("time", "mu"), ("x", "mu"), ("x", "v")]),
    "roll": ("Ball that rolls at v = 1 m/s down a slope of a = 0.3 rad, mu = 0.5: v t + 5/14 g sin(a) t^2, at 2 s", 2.0,
             {"a": 0.3, "v": 1.0}, ["x"], [("x", "a"), ("x", "v")]),
    "collide": ("Ball of 1 kg at v = 2 m/s hits one of r = 0.5 kg with e = 1: v (1 - r)/(1 + r), 2 v/(1 + r)", 0.5,
                {"r": 0.5, "v": 2.0}, ["v1", "v2"], [("v2", "r"), ("v2", "v")]),
}  # fmt: skip


def exact(name, p):
    """Closed forms, of complex parameters, too."""
    end, v, mu, g = SCENES[name][1], p.get("v"), p.get("mu"), GRAVITY
    if name == "bounce":
        speed, t = cmath.sqrt(2 * g * p["h"]), cmath.sqrt(2 * p["h"] / g)
        for hit in range(4):
            speed *= p["e"]
            t += 2 * speed / g if hit < 3 else 0
        return {"z": speed * (end - t) - g / 2 * (end - t) ** 2}
    if name == "bowl":
        return {"time": 2 * v / (7 * mu * g), "speed": 5 / 7 * v, "x": 5 / 7 * v * end + 2 / 49 * v**2 / (mu * g)}
    if name == "roll":
        return {"x": v * end + 5 / 14 * g * cmath.sin(p["a"]) * end**2}
    if name == "collide":
        return {"v1": v * (1 - p["r"]) / (1 + p["r"]), "v2": 2 * v / (1 + p["r"])}
    return {"x": v**2 / (2 * mu * g) if name == "slide" else 0.0}


def exact_derivative(name, output, parameter):
    p = SCENES[name][2]
    return exact(name, {**p, parameter: p[parameter] + 1e-30j})[output].imag / 1e-30


def describe(name, p):
    """Balls (place, velocity, angular velocity, mass), whether they turn, weight, mu, e, whether there is a floor."""
    rest, angle = [0, 0, 0], p.get("a", 0.3) if name in ("creep", "roll") else 0
    weight = [GRAVITY * sin(angle), 0, -GRAVITY * cos(angle)]
    if name == "collide":
        return [(rest, [p["v"], 0, 0], rest, 1.0), ([0.7, 0, 0], rest, rest, p["r"])], True, rest, 0.0, 1.0, False
    v = p.get("v", 0.0)
    spin = v / RADIUS if name == "roll" else 0
    ball = ([0, 0, RADIUS + p.get("h", 0.0)], [v, 0, 0], [0, spin, 0], 1.0)
    return [ball], name not in ("slide", "creep"), weight, p.get("mu", 0.5 * (name == "roll")), p.get("e", 0.0), True


def outputs_of(name, places, speeds, samples):
    """Outputs from the end of a run; the time of rolling from rows (t, speed, angular speed) of its steps."""
    if name == "bounce":
        return {"z": places[0][2] - RADIUS}
    if name == "collide":
        return {"v1": speeds[0][0], "v2": speeds[1][0]}
    found = {"x": places[0][0], "speed": speeds[0][0]}
    if samples is not None:
        # slip falls along a line: its zero, by where it is half and where it is a twentieth of the first
        t, slip = samples[:, 0], samples[:, 1] - RADIUS * samples[:, 2]
        i, j = np.argmax(slip < slip[0] / 2), np.argmax(slip < slip[0] / 20)
        found["time"] = t[j] + slip[j] * (t[j] - t[i]) / (slip[i] - slip[j])
    return found


# --- laws of contact for a given restitution

HITS = ("bounce", "collide")
# the steps of a hit in the bounce, by hand: of 5 to 160, with which errors change without order
STEPS_OF_HIT = {"MuJoCo": 20, "Drake": 40, "Exudyn": 20}
# impact speed in the middle of the four
SPEED = sqrt(2 * GRAVITY) * 0.8**1.5


def omega(name, code, h):
    """pi by the duration of a hit: some steps in the bounce, which is late by it, 20 ms where only speeds count."""
    return pi / (0.02 if name == "collide" else STEPS_OF_HIT[code] * h)


def solve(f, low, high):
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if (f(middle) > 0) == (f(low) > 0) else (low, middle)
    return low


def damping_ratio(e):
    """Of a linear spring and damper that does not pull, at any speed (Schwager & Poeschel, 2007)."""

    def restitution(zeta):
        root = sqrt(1 - zeta**2)
        return np.exp(-zeta / root * (pi - np.arctan2(2 * zeta * root, 1 - 2 * zeta**2)))

    return solve(lambda zeta: restitution(zeta) - e, 0.0, 0.99) if e < 1 else 0.0


def hunt_crossley(e, speed=SPEED):
    """Dissipation d, which has this e at one speed: d v - ln(1 + d v) is the same at v and -e v."""

    rest = lambda d: d * speed * (1 + e) - log(1 + d * speed) + log(1 - d * e * speed)  # noqa: E731
    return solve(rest, 1e-3, (1 - 1e-9) / (e * speed)) if e < 1 else 0.0


# --- codes: rows (label, steps, run(p) -> outputs, ways to derivatives(p) -> {(output, parameter): d}, their letter)


def mujoco_rows(name):
    import mujoco

    def build(p, h, second):
        balls, turns, weight, mu, e, plane = describe(name, p)
        solref, solimp = (f"{2 * h} 1", "0.9999 0.9999 0.001") if second else ("0.02 1", "0.9 0.95 0.001")
        if name in HITS:
            w = omega(name, "MuJoCo", h)
            solref, solimp = f"{-w * w} {-2 * damping_ratio(e) * w}", "0.9999 0.9999 0.001"
        integrator = "RK4" if second and name in HITS else "implicitfast"
        slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
        bodies = "".join(f"""<body pos="{x[0]} 0 {x[2]!r}">{"<freejoint/>" if turns else slides}<geom size="{RADIUS}"/>
            <inertial pos="0 0 0" mass="{m!r}" diaginertia="{0.004 * m!r} {0.004 * m!r} {0.004 * m!r}"/></body>"""
            for x, _, _, m in balls)  # fmt: skip
        model = mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="{h}" cone="elliptic" tolerance="1e-12"
            gravity="{weight[0]!r} 0 {weight[2]!r}" integrator="{integrator}"
            noslip_iterations="{10 * second}" impratio="{10 if second else 1}"/>
            <default><geom friction="{mu!r} 0 0" condim="{3 if mu else 1}" solref="{solref}" solimp="{solimp}"/>
            </default><worldbody>{'<geom type="plane" size="99 99 1"/>' * plane}{bodies}</worldbody></mujoco>""")
        data = mujoco.MjData(model)
        data.qvel[:] = np.concatenate([[*v, *w][: 6 if turns else 3] for _, v, w, _ in balls])
        return model, data

    def run(p, h, second):
        model, data = build(p, h, second)
        samples = np.empty((round(SCENES[name][1] / h), 3))
        if name == "bowl":
            for row in samples:
                row[:] = data.time, data.qvel[0], data.qvel[4]
                mujoco.mj_step(model, data)
        else:
            mujoco.mj_step(model, data, len(samples))
        mujoco.mj_kinematics(model, data)
        places, speeds = data.xpos[1:], [data.qvel[6 * i :] for i in range(model.nbody - 1)]
        return outputs_of(name, places, speeds, samples if name == "bowl" else None)

    def chain(p, h, second, eps):
        """For the parameter of the start."""
        model, data = build(p, h, second)
        nv, start = model.nv, list(p)[-1]
        seed, matrix = np.zeros(2 * nv), np.zeros((2 * nv, 2 * nv))
        seed[2 if start == "h" else nv] = 1
        if name == "roll":
            seed[nv + 4] = 1 / RADIUS
        for _ in range(round(SCENES[name][1] / h)):
            mujoco.mjd_transitionFD(model, data, eps, True, matrix, None, None, None)
            with np.errstate(all="ignore"):
                seed = matrix @ seed
            mujoco.mj_step(model, data)
        place = {"z": 2, "x": 0, "v2": nv + 6}
        return {(o, q): seed[place[o]] for o, q in SCENES[name][4] if q == start and o in place}

    hit = {"bounce": "solref -k -b: hit of 20 steps with this e", "collide": "solref -k 0: hit of 20 ms"}.get(name)
    for second in (False, True):
        law = f"{'RK4' if second else 'implicitfast'}, {hit}, solimp .9999"
        if not hit:
            law = "noslip 10, impratio 10, solref 2h 1, solimp .9999" if second else "default solref and solimp"
            law = f"implicitfast, {law}"
        for h in (2e-3, 5e-4, 1e-4):
            a = (h, second)
            ways = [lambda p, a=a, eps=eps: chain(p, *a, eps) for eps in (1e-6, 1e-8) if not (hit and second)]
            yield f"MuJoCo: elliptic, {law}", h, lambda p, a=a: run(p, *a), ways, "c"


def drake_rows(name):
    import pydrake.all as drake

    logging.getLogger("drake").setLevel(logging.ERROR)

    def build(p, h, solver):
        balls, turns, weight, mu, e, plane = describe(name, p)
        k, relaxation, dissipation, near_rigid = 1e7, 0.1, 10.0, 1.0
        if name in HITS:
            # an implicit step damps by itself, as a relaxation time h: less of that, as far as there is any
            w = omega(name, "Drake", h)
            k, near_rigid = (1 if plane else 1 / 3) * w**2, 0.0
            relaxation = max(2 * damping_ratio(e) / w - h, 0)
            dissipation = max(hunt_crossley(e) - 3 * pi / 4 * h * w / SPEED, 0)
        builder = drake.DiagramBuilder()
        config = drake.MultibodyPlantConfig(time_step=h, contact_model="point", discrete_contact_approximation=solver,
                                            stiction_tolerance=1e-6, sap_near_rigid_threshold=near_rigid)  # fmt: skip
        plant, _ = drake.AddMultibodyPlant(config, builder)
        # both surfaces have these properties: springs in series, and relaxation times add up
        surface = drake.ProximityProperties()
        drake.AddContactMaterial(dissipation=dissipation, point_stiffness=2 * k, properties=surface,
                                 friction=drake.CoulombFriction(mu, mu))  # fmt: skip
        surface.AddProperty("material", "relaxation_time", relaxation / 2)
        for i, (*_, m) in enumerate(balls):
            mass = m.value() if hasattr(m, "value") else m
            body = plant.AddRigidBody(f"ball {i}", drake.SpatialInertia.SolidSphereWithMass(mass, RADIUS))
            plant.RegisterCollisionGeometry(body, drake.RigidTransform(), drake.Sphere(RADIUS), "ball", surface)
        if not turns:
            middle = plant.AddRigidBody("middle", drake.SpatialInertia.Zero())
            plant.AddJoint(drake.PrismaticJoint("x", plant.world_frame(), middle.body_frame(), [1, 0, 0]))
            plant.AddJoint(drake.PrismaticJoint("z", middle.body_frame(), body.body_frame(), [0, 0, 1]))
        if plane:
            world = plant.world_body()
            plant.RegisterCollisionGeometry(world, drake.RigidTransform(), drake.HalfSpace(), "plane", surface)
        plant.mutable_gravity_field().set_gravity_vector(weight)
        plant.Finalize()
        log = drake.LogVectorOutput(plant.get_state_output_port(), builder) if name == "bowl" else None
        state = [[1, 0, 0, 0, *x] for x, *_ in balls] + [[*w, *v] for _, v, w, _ in balls]
        if not turns:
            state = [[0, balls[0][0][2], balls[0][1][0], 0]]
        return builder.Build(), sum(state, []), log, balls[-1][-1]

    def simulate(diagram, Simulator, state, number, mass):
        plant, simulator = diagram.GetSubsystemByName("plant"), Simulator(diagram)
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        if name == "collide":
            plant.GetBodyByName("ball 1").SetMass(context, number(mass))
        plant.SetPositionsAndVelocities(context, np.array([number(x) for x in state]))
        simulator.AdvanceTo(SCENES[name][1])
        return simulator, plant.GetPositionsAndVelocities(context)

    def outputs(x, samples=None):
        if len(x) == 4:
            return outputs_of(name, [[x[0], 0, x[1]]], [[x[2], 0, x[3]]], None)
        balls = range(len(x) // 13)
        v = x[7 * len(balls) :]
        return outputs_of(name, [x[7 * i + 4 :] for i in balls], [v[6 * i + 3 :] for i in balls], samples)

    def run(p, *a):
        diagram, state, log, mass = build(p, *a)
        simulator, x = simulate(diagram, drake.Simulator, state, float, mass)
        rows = log and log.FindLog(simulator.get_context())
        return outputs(x, rows and np.column_stack([rows.sample_times(), rows.data()[10], rows.data()[8]]))

    def forward(p, *a):
        """For the parameter of the start, and for mass."""
        free = [q for q in p if q in ("h", "v", "r")]
        p = {q: drake.AutoDiffXd(x, np.eye(len(free))[free.index(q)]) if q in free else x for q, x in p.items()}
        diagram, state, _, mass = build(p, *a)
        number = lambda x: x if hasattr(x, "derivatives") else drake.AutoDiffXd(x)  # noqa: E731
        found = outputs(simulate(diagram.ToAutoDiffXd(), drake.Simulator_[drake.AutoDiffXd], state, number, mass)[1])
        return {(o, q): (*found[o].derivatives(), 0, 0)[free.index(q)] for o, q in SCENES[name][4] if q in free}

    for solver in ("tamsi", "lagged", "sap"):
        law = "relaxation_time .1 s" if solver == "sap" else "dissipation 10 s/m, stiction_tolerance 1e-6 m/s"
        law = f"1e7 N/m, {law}"
        if name == "bounce":
            law = "relaxation_time with this e" if solver == "sap" else "Hunt-Crossley with this e at one speed"
            law = f"hit of 40 steps, {law}, less the step's own damping, near_rigid_threshold 0"
        elif name == "collide":
            law = "hit of 20 ms, no damping, near_rigid_threshold 0"
        for h in (1e-3, 1e-4):
            a = (h, solver)
            yield f"Drake: {solver}, {law}", h, lambda p, a=a: run(p, *a), [lambda p, a=a: forward(p, *a)], "f"


def exudyn_rows(name):
    import exudyn as exu
    import exudyn.itemInterface as items
    from exudyn.rigidBodyUtilities import RigidBodyInertia

    kind, hits = exu.OutputVariableType, name in HITS

    def run(p, h, zone):
        balls, turns, weight, mu, e, plane = describe(name, p)
        container = exu.SystemContainer()
        system = container.AddSystem()
        bodies = [system.CreateRigidBody(referencePosition=x, initialVelocity=v, initialAngularVelocity=w,
                  gravity=weight, inertia=RigidBodyInertia(m, np.eye(3) * 0.004 * m))
                  for x, v, w, m in balls]  # fmt: skip
        both = [*bodies, system.CreateGround()][:2]
        markers = [system.AddMarker(items.MarkerBodyRigid(bodyNumber=body)) for body in both]
        if not turns:
            system.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[0, 0, 0, 1, 1, 1]))
        k = (1 if plane else 1 / 3) * omega(name, "Exudyn", h) ** 2 if hits else 1e6
        node = system.AddNode(items.NodeGenericData(initialCoordinates=[0.1, 0, 0, 0], numberOfDataCoordinates=4))
        law = dict(markerNumbers=markers, nodeNumber=node, contactStiffness=k, contactDamping=0 if hits else 100.0,
                   dynamicFriction=mu, frictionProportionalZone=zone, restitutionCoefficient=e if hits else 1.0,
                   impactModel=2 if hits and e < 1 else 0)  # fmt: skip
        if plane:
            corners = exu.Vector3DList([[-99, -99, 0], [99, -99, 0], [0, 99, 0]])
            system.AddObject(items.ObjectContactSphereTriangle(sphereRadius=RADIUS, trianglePoints=corners, **law))
        else:
            system.AddObject(items.ObjectContactSphereSphere(spheresRadii=[RADIUS, RADIUS], **law))
        what = (kind.Velocity, kind.AngularVelocity) if name == "bowl" else ()
        sensors = [system.AddSensor(items.SensorBody(bodyNumber=bodies[0], storeInternal=True, outputVariableType=k))
                   for k in what]  # fmt: skip
        system.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.endTime = SCENES[name][1]
        settings.timeIntegration.numberOfSteps = round(SCENES[name][1] / h)
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = h
        system.SolveDynamic(settings)
        ends = [[system.GetObjectOutputBody(b, k) for b in bodies] for k in (kind.Position, kind.Velocity)]
        rows = [system.GetSensorStoredData(s) for s in sensors]
        samples = np.column_stack([rows[0][:, :2], rows[1][:, 2]]) if rows else None
        return outputs_of(name, *ends, samples)

    law = {"bounce": "hit of 20 steps, impactModel 2 with this e", "collide": "hit of 20 ms, no damping"}.get(name)
    for zone in (1e-3,) if law else (1e-3, 1e-5):
        label = law or f"1e6 N/m, 100 N s/m, frictionProportionalZone {zone:.0e} m/s"
        for h in (1e-3, 1e-4):
            yield f"Exudyn: generalized-alpha, {label}", h, lambda p, a=(h, zone): run(p, *a), [], ""


def costate_rows(name):
    def call(command, scene, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "other-codes", scene + ".toml")
            words = [sys.argv[1], command, path, "--no-report", "--json", "--out", folder, *options]
            done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)
        return json.loads(done.stdout.splitlines()[-1])["functionals"]

    turns = ("--steps 400", "--steps 1600", "--tolerance 1e-10")
    steps = turns if name in ("bowl", "roll") else ("--steps 20", "--steps 200")
    rows = [("rigid", name, *s.split()) for s in steps]
    if name == "bounce":
        rows += [("1e6 N/m, Hunt-Crossley as Drake's", "bounce-soft", "--tolerance", t) for t in ("1e-6", "1e-9")]
    for label, *a in rows:
        yield (f"costate: esdirk4, {label}", f"{a[1][2:]} {a[2]}",
               lambda _, a=a: {f["name"]: f["value"] for f in call("run", *a)},
               [lambda _, a=a: {(f["name"], q): d for f in call("gradient", *a) for q, d in f["gradient"].items()}],
               "a")  # fmt: skip


# --- tables


def timed(work, *arguments):
    def clock():
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + children.ru_utime + children.ru_stime

    taken = []
    while len(taken) < 3 and sum(taken) < 0.3:
        start = clock()
        result = work(*arguments)
        taken.append(clock() - start)
    return result, min(taken)


def differences(run, p, parameter, step):
    above, below = (run({**p, parameter: p[parameter] * (1 + sign * step)}) for sign in (1, -1))
    return {(o, parameter): (above[o] - below[o]) / (2 * step * p[parameter]) for o in above}


def measure(name, label, step, run, ways, letter):
    _, _, p, outputs, derivatives = SCENES[name]
    right, (value, seconds) = exact(name, p), timed(run, p)
    letters, total = {key: [] for key in derivatives}, 0.0 if letter == "a" else seconds  # the adjoint's run has it

    def gather(ways, letter):
        tried = [timed(way, p) for way in ways]
        for key in derivatives:
            errors = [abs(found[key] / exact_derivative(name, *key) - 1) for found, _ in tried if key in found]
            if errors:
                letters[key].append(f"{min(errors, key=lambda x: (x != x, x)):.1e} {letter}")
        return sum(taken for _, taken in tried) / max(len(tried), 1)

    if derivatives:
        total += gather(ways, letter)
    for q in p if derivatives and letter != "a" else ():
        missing = any(not letters[o, of] for o, of in derivatives if of == q)
        taken = gather([lambda p, q=q, s=s: differences(run, p, q, s) for s in (1e-2, 1e-4, 1e-6)], "d")
        total += taken * missing
    cells = [f"{value[o]:.6g} | {abs(value[o] / right[o] - 1 if right[o] else value[o]):.1e}" for o in outputs]
    cells += [", ".join(letters[key]) or "-" for key in derivatives] + [f"{1e3 * seconds:.0f}"]
    cells += [f"{1e3 * total:.0f}"] if derivatives else []
    print(f"| {label} | {step if isinstance(step, str) else f'h = {step:g} s'} | {' | '.join(cells)} |", flush=True)


def main():
    own = subprocess.run([sys.argv[1], "--version"], capture_output=True, text=True).stdout.strip()
    there = {package.metadata["Name"] for package in distributions()}
    others = ", ".join(f"{code} {version(code)}" for code in ("mujoco", "drake", "exudyn", "numpy") if code in there)
    print(f"{own}, {others}, Python {platform.python_version()}\n\n{NOTES}")
    for name, (title, _, p, outputs, derivatives) in SCENES.items():
        right = [f"{o} = {complex(x).real:.10g}" for o, x in exact(name, p).items()]
        right += [f"d{o}/d{q} = {exact_derivative(name, o, q):.10g}" for o, q in derivatives]
        heads = ["code and settings", "steps", *(head for o in outputs for head in (o, "error"))]
        heads += [f"d{o}/d{q}" for o, q in derivatives] + ["value ms"] + ["and derivatives ms"] * bool(derivatives)
        print(f"\n## {title}\n\nClosed form: {', '.join(right)}\n\n| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
        for rows in (costate_rows, mujoco_rows, drake_rows, exudyn_rows):
            try:
                for row in rows(name):
                    measure(name, *row)
            except ImportError as error:
                print(f"| not installed: {error} |")


if __name__ == "__main__":
    main()
