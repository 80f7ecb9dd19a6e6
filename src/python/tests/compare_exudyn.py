"""The same chain and the same flexible four-bar mechanism here and in Exudyn, from Python: prints lines of each model,
times and gradients.

``pip install exudyn``, then ``python src/python/tests/compare_exudyn.py``. Seconds of one processor, medians of runs in
turn. Exudyn has no derivatives: its gradient is by central differences of whole runs, as good as their step is.
"""

import inspect
import os
import statistics
import time

os.environ.setdefault("RAYON_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia, RotationMatrix2EulerParameters, RotationMatrixY, RotationMatrixZ

import costate

GRAVITY = [0, 0, -9.81]
BARS = 20
STEPS = 1000
# bars with sides of 16 mm and 8 mm (Bauchau et al., 2016): axial, shear, torsion, bending, mass, inertia
THICK = (5.2992e7, 1.68803e7, 733.488, 1130.5, 1.9968, 4.25984e-5)
THIN = (1.3248e7, 4.22008e6, 45.8430, 70.6560, 0.4992, 2.6624e-6)


def chain_here(steps=STEPS):
    @costate.scene(radius=costate.variable(0.01, (0.002, 0.05), "m"))
    def chain(x, m):
        m.gravity = GRAVITY
        m.settings(end=1.0, steps=steps)
        mass = 2e3 * x.radius**2
        along = mass * x.radius**2 / 2
        across = mass * 0.01 / 12 + along / 2
        before = "ground"
        for i in range(BARS):
            middle, turn = np.array([0.1 * i + 0.05, 0, 0]), np.array([0, 0, 20 / BARS])
            bar = m.body(f"bar {i}", position=middle, velocity=np.cross(turn, middle), angular_velocity=turn,
                         mass=mass, inertia=[along, across, across])  # fmt: skip
            m.joint.spherical(f"joint {i}", between=[before, bar], point=[0.1 * i, 0, 0])
            before = bar
        m.functional.position("z", on=before, direction=[0, 0, 1], over="terminal")

    return chain


def chain_there(x, steps=STEPS):
    system = exu.SystemContainer().AddSystem()
    mass = 2e3 * x[0] ** 2
    along = mass * x[0] ** 2 / 2
    across = mass * 0.01 / 12 + along / 2
    inertia = RigidBodyInertia(mass=mass, inertiaTensor=np.diag([along, across, across]))
    before = system.CreateGround()
    for i in range(BARS):
        middle, turn = np.array([0.1 * i + 0.05, 0, 0]), np.array([0, 0, 20 / BARS])
        bar = system.CreateRigidBody(referencePosition=middle, initialVelocity=np.cross(turn, middle),
                                     initialAngularVelocity=turn, inertia=inertia, gravity=GRAVITY)  # fmt: skip
        system.CreateSphericalJoint(itemNumbers=[before, bar], position=[0.1 * i, 0, 0])
        before = bar
    system.Assemble()
    return system, 1.0, steps, lambda: system.GetObjectOutputBody(before, exu.OutputVariableType.Position)[2]


def four_bar_here(steps=STEPS):
    @costate.scene(tilt=costate.variable(np.radians(5), (0, 0.5), "rad"), side=costate.variable(1.0, (0.5, 2.0)))
    def four_bar(x, m):
        m.gravity = GRAVITY
        m.settings(end=1.0, steps=steps)
        powers = np.array([x.side**2, x.side**2, x.side**4, x.side**4, x.side**2, x.side**4])
        for name, (axial, shear, torsion, bending, mass, inertia) in [("thick", THICK * powers), ("thin", THIN)]:
            m.section.beam(name, axial=axial, shear=[shear] * 2, torsion=torsion, bending=[bending] * 2, mass=mass,
                           inertia=[inertia] * 2)  # fmt: skip
        a, b, c, d, up = [0, 0, 0], [0, 0.12, 0], [0.24, 0.12, 0], [0.24, 0, 0], [0, 0, 1]
        for name, start, end, count, section in [
            ("AB", a, b, 4, "thick"),
            ("BC", b, c, 8, "thick"),
            ("CD", c, d, 4, "thin"),
        ]:
            second = np.cross(up, np.subtract(end, start))
            m.beam(name, from_=start, to=end, elements=count, section=section, second_axis=second)
        m.joint.revolute("A", between=["ground", "AB.start"], axis=up)
        m.joint.revolute("B", between=["AB.end", "BC.start"], axis=up)
        m.joint.revolute("C", between=["BC.end", "CD.start"], axis=[np.sin(x.tilt), 0, np.cos(x.tilt)])
        m.joint.revolute("D", between=["ground", "CD.end"], axis=up)
        angle = {"type": "formula", "value": "-0.6 * t^3 * (10 - 15 * t + 6 * t^2)"}
        m.driver.rotation("crank", between=["ground", "AB.start"], axis=up, angle=angle)
        m.functional.position("z", on="CD.start", direction=up, over="terminal")

    return four_bar


def four_bar_there(x, steps=STEPS):
    # an element here has three nodes, there two
    system = exu.SystemContainer().AddSystem()
    side2, side4 = x[1] ** 2, x[1] ** 4
    thick = THICK * np.array([side2, side2, side4, side4, side2, side4])
    a, b, c, d = np.array([[0, 0, 0], [0, 0.12, 0], [0.24, 0.12, 0], [0.24, 0, 0]])
    ends = {}
    for name, start, end, count, numbers in [("AB", a, b, 8, thick), ("BC", b, c, 16, thick), ("CD", c, d, 8, THIN)]:
        axial, shear, torsion, bending, mass, inertia = numbers
        section = exu.BeamSection()
        section.stiffnessMatrix = np.diag([axial, shear, shear, torsion, bending, bending])
        section.massPerLength = mass
        section.inertia = np.diag([2 * inertia, inertia, inertia])
        length = np.linalg.norm(end - start) / count
        along = (end - start) / (count * length)
        axes = RotationMatrixZ(np.arctan2(along[1], along[0]))
        places = [start + (end - start) * i / count for i in range(count + 1)]
        turned = RotationMatrix2EulerParameters(axes)
        nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, *turned])) for place in places]
        for pair in zip(nodes, nodes[1:]):
            beam = items.ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=length, sectionData=section)
            marker = system.AddMarker(items.MarkerBodyMass(bodyNumber=system.AddObject(beam)))
            system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=GRAVITY))
        ends[name] = [(nodes[0], axes, start), (nodes[-1], axes, end)]
    ground = system.CreateGround()

    def marker(end, frame):
        node, axes, _ = end
        return system.AddMarker(items.MarkerNodeRigid(nodeNumber=node, localHT=exu.HT(rotation=axes.T @ frame)))

    def hinge(first, second, frame=None, driven=0, **drive):
        frame = np.eye(3) if frame is None else frame
        if first is None:
            at = exu.HT(rotation=frame, translation=second[2])
            own = system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, localHT=at))
        else:
            own = marker(first, frame)
        both = [own, marker(second, frame)]
        system.AddObject(items.ObjectJointGeneric(markerNumbers=both, constrainedAxes=[1, 1, 1, 1, 1, driven], **drive))

    def crank(_system, t, _item, _parameters):
        return [0, 0, 0, 0, 0, -0.6 * t**3 * (10 - 15 * t + 6 * t**2)]

    hinge(None, ends["AB"][0], driven=1, offsetUserFunction=crank)
    hinge(ends["AB"][1], ends["BC"][0])
    hinge(ends["BC"][1], ends["CD"][0], frame=RotationMatrixY(x[0]))
    hinge(None, ends["CD"][1])
    system.Assemble()
    tip = ends["CD"][0][0]
    return system, 1.0, steps, lambda: system.GetNodeOutput(tip, exu.OutputVariableType.Position)[2]


def simulate_there(made):
    system, end, steps, measured = made
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.timeIntegration.newton.useModifiedNewton = True
    # round-off keeps Newton's method of the four-bar mechanism from smaller ones
    settings.timeIntegration.newton.relativeTolerance = 1e-6
    settings.timeIntegration.newton.absoluteTolerance = 1e-6
    system.SolveDynamic(settings)
    return measured()


def lines(*functions):
    text = "".join(inspect.getsource(function) for function in functions)
    return sum(1 for line in text.split("\n") if line.strip() and not line.strip().startswith("#"))


def timed(times, work, *arguments):
    start = time.process_time()
    result = work(*arguments)
    times.append(time.process_time() - start)
    return result


def compare(name, here, there, rounds=5):
    x = here().initial
    times = {key: [] for key in ("build", "run", "gradient", "their build", "their run", "their gradient")}
    for _ in range(rounds):
        scene = timed(times["build"], here)
        run = timed(times["run"], scene.run, x)
        own = timed(times["gradient"], run.gradient)
        made = timed(times["their build"], there, x)
        value = timed(times["their run"], simulate_there, made)
    differences = {}
    for step in (1e-2, 1e-4, 1e-6):
        differences[step] = timed(times["their gradient"], differences_there, there, x, step)
    finer = [here(2 * STEPS).values()[0], simulate_there(there(x, 2 * STEPS))]
    check = np.abs(run.complex_step() / own.rows - 1).max()
    medians = {key: 1e3 * statistics.median(taken) for key, taken in times.items()}
    print(f"\n{name}, {STEPS} steps")
    print(f"{'':36}{'costate':>15}{'Exudyn':>15}")
    print(f"{'z at the end [m]':36}{run['z']:>15.8f}{value:>15.8f}")
    print(f"{'with twice the steps':36}{finer[0]:>15.8f}{finer[1]:>15.8f}")
    print(f"{'lines of the model':36}{lines(here):>15}{lines(there):>15}")
    for what in ("build", "run", "gradient"):
        print(f"{what + ' [ms]':36}{medians[what]:>15.1f}{medians['their ' + what]:>15.1f}")
    for place, variable in enumerate(own.variables):
        for step, row in differences.items():
            head = f"dz / d {variable.name}, differences of {step:.0e}"
            print(f"{head:36}{own.rows[0, place]:>15.8f}{row[place]:>15.8f}")
    print(f"{'largest difference to complex steps':36}{check:>15.1e}")


def differences_there(there, x, step):
    row = []
    for place in range(len(x)):
        sides = []
        for sign in (1, -1):
            moved = x.copy()
            moved[place] *= 1 + sign * step
            sides.append(simulate_there(there(moved)))
        row.append((sides[0] - sides[1]) / (2 * step * x[place]))
    return row


if __name__ == "__main__":
    print(f"costate {costate.__version__}, Exudyn {exu.__version__}")
    compare(f"chain of {BARS} bars", chain_here, chain_there)
    compare("flexible four-bar mechanism", four_bar_here, four_bar_there)
