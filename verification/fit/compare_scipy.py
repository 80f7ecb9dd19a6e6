"""The fit of examples/scenes/damped-oscillator.toml here and by scipy.optimize.least_squares: prints a table.

``pip install scipy``, then ``python compare_scipy.py PATH_TO_COSTATE``. SciPy has the closed form of the oscillation, with
derivatives by differences of two points as they are when nobody writes them; costate has the mechanism.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

SCENES = Path(__file__).parents[2] / "examples" / "scenes"
DEVIATION = 0.002
BOUNDS = ([1, 0, 0.01], [500, 20, 0.5])
START = [50, 0.5, 0.05]

t, measured = np.loadtxt(SCENES / "damped-oscillator.csv", delimiter=",", skiprows=1, unpack=True)


def residuals(x, values):
    """Of stiffness, damping, and the place where 2 kg are let go."""
    stiffness, damping, release = x
    decay = damping / 4
    omega = np.sqrt(stiffness / 2 - decay**2)
    place = release * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    return (place - values) / DEVIATION


def fitted_here(program, values, loss):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        scene = (SCENES / "damped-oscillator.toml").read_text() + f'\n[fit]\nloss = "{loss}"\n'
        (folder / "scene.toml").write_text(scene)
        np.savetxt(folder / "damped-oscillator.csv", np.c_[t, values], delimiter=",", header="t,x", comments="")
        run = [program, "fit", str(folder / "scene.toml"), "--out", str(folder / "out"), "--json"]
        return json.loads(subprocess.run(run, check=True, capture_output=True, text=True).stdout.splitlines()[-1])


def main():
    outlier = measured.copy()
    outlier[7] += 60 * DEVIATION
    header = ["data", "loss", "largest difference by deviation", "deviations, largest ratio", "sum here", "sum in SciPy"]
    print("|", " | ".join([*header, "simulations here", "evaluations in SciPy"]), "|")
    print("|---|---|" + "---:|" * 6)
    for name, values in [("as measured", measured), ("one outlier", outlier)]:
        for loss in ["linear", "huber", "soft_l1", "cauchy"]:
            here = fitted_here(sys.argv[1], values, loss)
            there = least_squares(
                residuals, START, bounds=BOUNDS, x_scale="jac", loss=loss, args=(values,), ftol=1e-14, xtol=1e-14, gtol=1e-14
            )
            covariance = np.linalg.inv(there.jac.T @ there.jac)
            deviations = np.sqrt(np.diag(covariance))
            x = np.array([own["estimate"] for own in here["variables"]])
            ratio = np.array([own["deviation"] for own in here["variables"]]) / deviations
            apart = np.max(np.abs(x - there.x) / deviations)
            most = max(np.max(ratio), 1 / np.min(ratio))
            # two values for each derivative by differences
            evaluations = there.nfev + 3 * there.njev
            sums = [f"{here['sum']:.7g}", f"{2 * there.cost:.7g}"]
            print("|", " | ".join([name, loss, f"{apart:.1e}", f"{most:.6f}", *sums, str(here["simulations"]), str(evaluations)]), "|")


if __name__ == "__main__":
    main()
