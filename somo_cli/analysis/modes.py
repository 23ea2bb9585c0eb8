"""The modes of a chain about one pose, and the step that the explicit law allows there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from somo_cli.simulation.dynamics import ChainPose
from somo_cli.simulation.springs import Array
from somo_cli.simulation.vibration import largest_explicit_step, normaliser

TOPPLES = -1e-9  # of the largest eigenvalue: what counts as a negative stiffness


class NotAnInertia(ValueError):
    """The joint-space inertia is not positive definite in floating point."""


@dataclass(frozen=True, slots=True)
class Modes:
    """The modes of M q'' + D q' + K q = 0, slow ones first; arrays of shape (n,).

    `shapes`, (n, n), has one in each column, orthonormal with respect to M. `squares` are the
    squares of the natural frequencies [rad²/s²], negative where the chain topples; `damping` is
    the diagonal of D in these modes [1/s]. The explicit step [s] is exact, whatever D is.
    """

    squares: Array
    shapes: Array
    damping: Array
    explicit_step: float

    @property
    def frequencies(self) -> Array:
        """Natural frequencies without damping [rad/s]; those of toppling are zero."""
        found: Array = np.sqrt(np.maximum(self.squares, 0.0))
        return found

    @property
    def ratios(self) -> Array:
        """Damping ratios of the modes; infinite for a damped one without stiffness."""
        twice = 2 * np.sqrt(np.abs(self.squares))
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = np.where(self.damping > 0, self.damping / twice, 0.0)
        return found

    @property
    def topples(self) -> bool:
        """Whether the chain leaves this pose by itself."""
        return bool(self.squares[0] < TOPPLES * abs(self.squares[-1]))


def modes_at(pose: ChainPose, has_free_base: bool, geometric: Array) -> Modes:
    """Return the modes at a pose; `geometric`, (n, n), is the stiffness of gravity and loads.

    Raises NotAnInertia.
    """
    mass = pose.joint_inertia(has_free_base)
    springs, damping = np.diag(pose.chain.stiffness), pose.chain.damping
    try:
        normalised, shaped = normaliser(mass)
    except np.linalg.LinAlgError as error:
        raise NotAnInertia("masses that differ too much leave no inertia to a joint") from error
    squares, vectors = np.linalg.eigh(normalised(springs + geometric))
    damped = np.einsum("ik,ij,jk->k", vectors, normalised(damping), vectors)
    # what gravity takes away from the springs must not make the answer optimistic
    step = min(
        largest_explicit_step(mass, stiffness, damping)
        for stiffness in (springs, springs + geometric)
    )
    return Modes(squares, shaped(vectors), np.maximum(damped, 0.0), step)
