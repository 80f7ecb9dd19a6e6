"""Scenes in the tools of others."""

import numpy as np
import pytest

import costate


def test_jax_differentiates_through_a_simulation(five_bar):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    from costate.jax import function

    psi = function(five_bar, "psi")
    scale = jnp.array([1.0, 1.0, 2.0, 2.0, 0.5])

    def composed(y):
        return jnp.log(psi(jnp.array(five_bar.initial) * (1.0 + 0.0 * y) + scale * y)) ** 2

    y = 0.01 * jnp.arange(5.0)
    value, row = jax.value_and_grad(composed)(y)
    x = five_bar.initial + np.asarray(scale) * np.asarray(y)
    own, derivatives = five_bar.value_and_grad(x, "psi")
    np.testing.assert_allclose(value, np.log(own) ** 2, rtol=1e-12)
    np.testing.assert_allclose(row, 2.0 * np.log(own) / own * derivatives * np.asarray(scale), rtol=1e-12)
    compiled = jax.jit(jax.grad(composed))(y)
    np.testing.assert_allclose(compiled, row, rtol=1e-12)


def test_jax_takes_several_functionals_and_designs(pendulum):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    from costate.jax import function

    both = function(pendulum)
    x = jnp.array([[1.0, 2.0], [1.5, 1.0]])
    rows = jax.jacrev(both)(x[1])
    np.testing.assert_allclose(rows, pendulum.value_and_grad(np.asarray(x[1]))[1], rtol=1e-12)
    values = jax.vmap(both)(x)
    np.testing.assert_allclose(values, [pendulum.values(np.asarray(own)) for own in x], rtol=1e-14)


def test_torch_differentiates_through_a_simulation(five_bar):
    torch = pytest.importorskip("torch")
    from costate.torch import function

    psi = function(five_bar, "psi")
    x = torch.tensor(five_bar.initial, requires_grad=True)
    (psi(x) ** 2).backward()
    own, derivatives = five_bar.value_and_grad(functionals="psi")
    np.testing.assert_allclose(x.grad.numpy(), 2.0 * own * derivatives, rtol=1e-12)


def problem(component, complex_steps=False):
    om = pytest.importorskip("openmdao.api")
    own = om.Problem(reports=False)
    own.model.add_subsystem("scene", component, promotes=["*"])
    own.setup(force_alloc_complex=complex_steps)
    own.run_model()
    return own


def test_openmdao_checks_the_partials(five_bar):
    pytest.importorskip("openmdao")
    from costate.openmdao import Component

    own = problem(Component(five_bar))
    assert own.get_val("psi")[0] == five_bar.run()["psi"]
    totals = own.compute_totals(of=["psi"], wrt=["L01", "k1", "c"])
    rows = five_bar.value_and_grad(functionals="psi")[1]
    for place, name in [(0, "L01"), (2, "k1"), (4, "c")]:
        np.testing.assert_allclose(totals["psi", name], [[rows[place]]], rtol=1e-14)


def test_openmdao_checks_partials_by_complex_steps(five_bar):
    pytest.importorskip("openmdao")
    from costate.openmdao import Component

    checked = problem(Component(five_bar), complex_steps=True).check_partials(method="cs", out_stream=None)
    for (_, variable), own in checked["scene"].items():
        error = np.abs(own["J_fwd"] - own["J_fd"]).max() / np.abs(own["J_fd"]).max()
        print(f"by {variable}: {error:.1e}")
        assert error < 1e-10


def test_openmdao_runs_scenarios_at_once(pendulum):
    pytest.importorskip("openmdao")
    from test_builder import model

    from costate.openmdao import Component

    m = model()
    m.scenario("long", settings={"end": 1.5})
    m.scenario("short", settings={"end": 0.5})
    scene = m.scene()
    own = problem(Component(scene))
    for name, scenario in scene.scenarios.items():
        assert own.get_val(f"height_{name}")[0] == scenario.run()["height"]
        totals = own.compute_totals(of=[f"height_{name}"], wrt=["length"])
        np.testing.assert_allclose(
            totals[f"height_{name}", "length"][0], scenario.value_and_grad(functionals="height")[1], rtol=1e-14
        )


def test_scipy_minimizes_with_exact_gradients(five_bar):
    optimize = pytest.importorskip("scipy.optimize")
    bounds = [own.bounds for own in five_bar.variables]
    found = optimize.minimize(
        costate.value_and_grad(five_bar, "psi"),
        five_bar.initial,
        jac=True,
        bounds=bounds,
        method="L-BFGS-B",
        options={"maxiter": 3},
    )
    assert found.fun < five_bar.run()["psi"]
