"""Scenes in JAX: ``function(scene)`` can stand in any JAX code, and ``jax.grad`` goes through it by the adjoint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .scenes import Scene


def function(scene: Scene, functionals: str | Sequence[str] | None = None) -> Any:
    """A function of a design, an array ``(variables,)``, that gives functionals: a number of one by its name, otherwise
    an array.

    Its derivative backwards is the discrete adjoint. In double precision, ``jax.config.update("jax_enable_x64",
    True)``, it is exact to round-off.
    """
    places = scene._places(functionals)
    is_one = isinstance(functionals, str)
    wanted = [scene.functionals[place].name for place in places]

    def shapes(x: Any) -> Any:
        return jax.ShapeDtypeStruct((len(places),), x.dtype), jax.ShapeDtypeStruct((len(places), x.shape[-1]), x.dtype)

    def values_of(x: Any) -> np.ndarray:
        return scene.values(np.asarray(x))[places].astype(x.dtype)

    def both_of(x: Any) -> tuple[np.ndarray, np.ndarray]:
        values, rows = scene.value_and_grad(np.asarray(x), wanted)
        return values.astype(x.dtype), rows.astype(x.dtype)

    @jax.custom_vjp
    def evaluate(x: Any) -> Any:
        values = jax.pure_callback(values_of, shapes(x)[0], x, vmap_method="sequential")
        return values[0] if is_one else values

    def forward(x: Any) -> Any:
        values, rows = jax.pure_callback(both_of, shapes(x), x, vmap_method="sequential")
        return (values[0] if is_one else values), rows

    def backward(rows: Any, weights: Any) -> Any:
        return (jnp.atleast_1d(weights) @ rows,)

    evaluate.defvjp(forward, backward)
    return evaluate
