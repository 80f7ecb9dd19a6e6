"""Elements in Python against the same built in: ``python src/python/tests/compare_speed.py`` prints seconds of one
processor for a run and for its gradient, medians of runs in turn, and their ratio."""

import statistics
import time
import warnings

from conftest import SCENES, same_bits
from test_own_beam import built_in_beam, cantilever, own_beam
from test_parts import BodySpring, built_in_strand, own_strand, rope, with_body_springs

import costate


def seconds(work):
    start = time.process_time()
    work()
    return time.process_time() - start


def compare(name, own, built_in, rounds):
    scenes = {"Python": own, "built in": built_in}
    taken = {(whose, what): [] for whose in scenes for what in ("run", "gradient")}
    # programs are made in the first
    runs = {whose: scene.run() for whose, scene in scenes.items()}
    rows = [run.gradient().rows for run in runs.values()]
    bits = same_bits(*(run.values for run in runs.values())) and same_bits(*rows)
    print(f"{name}: values and gradients have {'the same' if bits else 'other'} bits")
    for _ in range(rounds):
        for whose, scene in scenes.items():
            taken[whose, "run"].append(seconds(scene.run))
            taken[whose, "gradient"].append(seconds(runs[whose].gradient))
    for what in ("run", "gradient"):
        ours, theirs = (statistics.median(taken[whose, what]) for whose in scenes)
        print(
            f"{name}, {what}: {1e3 * ours:.1f} ms in Python, {1e3 * theirs:.1f} ms built in, ratio {ours / theirs:.3f}"
        )


if __name__ == "__main__":
    warnings.simplefilter("ignore", costate.RunWarning)
    five_bar = (SCENES / "five-bar.toml").read_text(encoding="utf-8")
    springs = costate.loads(with_body_springs(five_bar), "five-bar.toml", parts=[BodySpring])
    compare("five-bar with its springs", springs, costate.loads(five_bar, "five-bar.toml"), 31)
    compare("1000 elements of a cable", rope(1000, own_strand, 50), rope(1000, built_in_strand, 50), 31)
    compare("1000 elements of a beam", cantilever(1000, own_beam), cantilever(1000, built_in_beam), 21)
