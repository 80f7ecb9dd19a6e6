"""Threads, Ctrl-C, memory, time of a call."""

import gc
import os
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import same_bits

import costate

COARSE = """
version = 1
settings = { end = 10.0, steps = 10 }
variable.k = { initial = 2.0, bounds = [0.1, 10], unit = "N/m" }
point = [{ name = "ball", position = [1.5, 0, 0], mass = 1 }]

[[spring]]
name = "spring"
type = "line"
between = ["ground", "ball"]
points = [[-1, 0, 0], [1.5, 0, 0]]
stiffness = "k"
rest_length = 1

[[functional]]
name = "x"
type = "position"
on = "ball"
direction = [1, 0, 0]
over = "terminal"
"""

LONG = """
import os, signal, sys, threading, time
import costate
scene = costate.built_in("five-bar")
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
start = time.time()
try:
    scene.run(steps=2_000_000, end=5.0)
except KeyboardInterrupt as error:
    steps = error.run.work["steps"]
    positions = error.run.node("bar 2").positions
    assert 10 < steps < 1_000_000 and len(positions) == steps + 1, (steps, positions.shape)
    assert time.time() - start < 30.0
    print("ended after", steps > 0)
# the interpreter goes on
print(scene.run(steps=10, end=0.1).values.shape)
"""


def test_an_interrupt_ends_a_run_with_its_finished_steps():
    done = subprocess.run([sys.executable, "-c", LONG], capture_output=True, text=True, timeout=120)
    assert done.stdout.split("\n")[:2] == ["ended after True", "(1,)"], done.stderr


def test_a_handler_of_ones_own_ends_a_run_too(five_bar):
    class Enough(Exception):
        pass

    def handler(_number, _frame):
        raise Enough

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(Enough) as error:
            five_bar.run(steps=2_000_000)
        assert error.value.run.work["steps"] > 0
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def stopped(scene):
    """A run that ends after some of its steps."""

    def stop(_t, _end):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as error:
        scene.run(steps=2_000_000, progress=stop)
    return error.value.run


def test_a_run_that_was_stopped_says_so_and_has_no_derivatives(five_bar):
    run = stopped(five_bar)
    steps = run.work["steps"]
    assert run.doubts[0].startswith(f"the run was stopped after step {steps}, before its end: values and histories")
    for ask in (run.gradient, run.complex_step, run.tangent, lambda: run.report(gradient=True)):
        with pytest.raises(costate.InputError, match="derivatives"):
            ask()
    assert "what is shown are the finished steps" in run.report().html


def test_progress_is_told_to_a_function(five_bar):
    told = []
    five_bar.run(steps=20_000, progress=lambda t, end: told.append((t, end)))
    times = [t for t, _ in told]
    assert len(told) >= 3 and times == sorted(times) and 0.0 < times[0] and times[-1] <= 5.0
    assert {end for _, end in told} == {5.0}


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda scene: scene.run(progress=3), "progress is 3"),
        (lambda scene: scene.value_and_grad(functionals=3), "functionals is 3"),
        (lambda scene: scene.run(steps=1.5), "steps is 1.5"),
    ],
)
def test_arguments_of_a_wrong_type_are_named(pendulum, call, said):
    with pytest.raises(TypeError, match=said):
        call(pendulum)


def test_an_exception_of_progress_ends_the_run(five_bar):
    def fail(_t, _end):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        five_bar.run(steps=2_000_000, progress=fail)


def test_a_bar_is_shown_where_it_is_asked_for_and_wiped_at_the_end(five_bar, capsys):
    five_bar.run(steps=20_000, progress=True)
    shown = capsys.readouterr().err.split("\r")
    assert shown[1].startswith("five-bar [") and " %, t = " in shown[1]
    assert "] 0 %" not in shown[-3] and not shown[-1].strip()
    assert set(shown[-2]) <= {" "}
    five_bar.run(steps=20_000, progress=False)
    five_bar.run(steps=20_000)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("ask", ["value_and_grad", "gradient"])
def test_a_gradient_behind_a_jump_is_refused(ask):
    with pytest.warns(costate.RunWarning), pytest.raises(costate.errors.InputError, match="jumps in step 2"):
        getattr(costate.loads(COARSE), ask)()


@pytest.mark.parametrize("ask", ["run", "values", "apply"])
def test_warnings_name_the_line_that_asked(ask):
    coarse = costate.loads(COARSE)
    arguments = [{"k": 2.0}] if ask == "apply" else []
    with pytest.warns(costate.RunWarning) as caught:
        getattr(coarse, ask)(*arguments)
    assert {own.filename for own in caught} == {__file__}


def test_two_threads_give_the_bits_of_one(five_bar):
    designs = [{"k1": 80.0 + 5.0 * i} for i in range(6)]
    alone = [five_bar.value_and_grad(x) for x in designs]
    together = [None] * len(designs)

    def work(first):
        for place in range(first, len(designs), 2):
            together[place] = five_bar.value_and_grad(designs[place])

    threads = [threading.Thread(target=work, args=(first,)) for first in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    for (value, row), (other, derivatives) in zip(alone, together):
        assert same_bits(value, other) and same_bits(row, derivatives)


def test_other_threads_go_on_while_a_scene_runs(five_bar):
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.time()
    five_bar.run(steps=3000)
    seconds = time.time() - start
    stop.set()
    thread.join()
    assert counted[0] > 50.0 * min(seconds, 2.0)


def test_ten_thousand_calls_take_no_memory(pendulum):
    def calls(count):
        for i in range(count):
            x = [1.0 + 1e-5 * i, 2.0]
            run = pendulum._run(pendulum.design(x), steps=3, end=0.05)
            run.gradient()
            run.node("bob")
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    calls(500)
    before = calls(500)
    after = calls(9000)
    assert after - before < 2_000, f"{after - before} KiB more"


def test_scenes_built_again_and_again_take_no_memory():
    from test_parts import duffing

    def calls(count):
        for _ in range(count):
            duffing()
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    calls(200)
    before = calls(50)
    assert calls(1000) - before < 2_000


def test_a_call_costs_less_than_a_millisecond(five_bar):
    """Beside what the library itself takes for building, running and differentiating a scene."""
    native, x = five_bar._native, five_bar.initial.tolist()
    options = {"end": 0.01, "steps": 1, "method": None, "keep_steps": True, "progress": None}

    def bare():
        run, _ = native.run(x, options)
        return run.gradient([0])

    def whole():
        return five_bar.run(steps=1, end=0.01).gradient().rows

    assert same_bits(bare(), whole())
    least = {bare: np.inf, whole: np.inf}
    for _ in range(100):
        for work in least:
            start = time.process_time()
            work()
            least[work] = min(least[work], time.process_time() - start)
    overhead = least[whole] - least[bare]
    print(f"{1e6 * overhead:.0f} microseconds")
    assert overhead < 1e-3


def test_a_run_that_fails_in_a_thread_raises_there(pendulum):
    caught = []

    def work():
        try:
            pendulum.run([1.0, 20.0])
        except costate.InputError as error:
            caught.append(str(error))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert "mass" in caught[0]


def test_a_process_that_was_forked_runs_scenes():
    code = (
        "import multiprocessing as mp, costate\n"
        "if __name__ == '__main__':\n"
        "    scene = costate.built_in('pendulum')\n"
        "    with mp.get_context('spawn').Pool(2) as pool:\n"
        "        runs = pool.map(scene.values, [None, None])\n"
        "    print((runs[0] == scene.values()).all())\n"
    )
    file = os.path.join(os.environ.get("TMPDIR", "/tmp"), f"costate-pool-{os.getpid()}.py")
    with open(file, "w") as out:
        out.write(code)
    try:
        done = subprocess.run([sys.executable, file], capture_output=True, text=True, timeout=120)
    finally:
        os.remove(file)
    assert done.stdout.strip() == "True", done.stderr


def test_values_of_random_designs_are_those_of_tables_by_name(pendulum):
    random = np.random.default_rng(1)
    for _ in range(20):
        x = random.uniform(0.5, 2.0, 2)
        assert same_bits(pendulum.values(x), pendulum.values(dict(zip(["length", "mass"], x))))


def test_events_are_told_by_their_names_and_times() -> None:
    model = costate.Model("ball", gravity=[0, 0, -9.81])
    height = model.variable("height", 1.0, (0.1, 10.0), "m")
    ball = model.point("ball", position=[0, 0, height], mass=1.0)
    model.settings(end=1.3, steps=40)
    floor = model.stop("floor", nodes={"ball": ball}, value="ball.position.z", least=0, restitution=0.8)
    model.functional.event_time("second hit", event=floor, number=2, over="terminal")
    run = model.scene().run()
    fall = (2 / 9.81) ** 0.5
    assert [name for name, _ in run.events] == ["floor", "floor"]
    assert [t for _, t in run.events] == pytest.approx([fall, 2.6 * fall], rel=1e-12)
    assert run.gradient()["second hit", "height"] == pytest.approx(1.3 * fall, rel=1e-12)
