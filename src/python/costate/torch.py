"""Scenes in PyTorch: ``function(scene)`` takes a tensor and gives one, and ``backward`` goes through it by the
adjoint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import torch

from .scenes import Scene


def function(scene: Scene, functionals: str | Sequence[str] | None = None) -> Callable[[torch.Tensor], torch.Tensor]:
    """A function of a design, a tensor ``(variables,)``, that gives functionals: a scalar of one by its name, otherwise
    a tensor."""
    scene._places(functionals)

    class Simulation(torch.autograd.Function):
        @staticmethod
        def forward(ctx: Any, x: torch.Tensor) -> torch.Tensor:
            values, rows = scene.value_and_grad(x.detach().cpu().numpy(), functionals)
            ctx.save_for_backward(torch.as_tensor(rows, dtype=x.dtype, device=x.device))
            return torch.as_tensor(values, dtype=x.dtype, device=x.device)

        @staticmethod
        def backward(ctx: Any, *weights: torch.Tensor) -> torch.Tensor:
            (rows,) = ctx.saved_tensors
            return weights[0] * rows if rows.ndim == 1 else weights[0] @ rows

    return lambda x: Simulation.apply(x)
