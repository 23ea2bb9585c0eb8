"""The modes of a chain about a pose, and the largest stable step of the explicit integrator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.dynamics.modal import largest_explicit_step, mass_normalisation

Complex: TypeAlias = npt.NDArray[np.complex128]

NEGATIVE_STIFFNESS = -1e-9  # eigenvalue, over the largest, below which a chain topples


class SingularInertia(ValueError):
    """The joint-space inertia is not positive definite in floating point."""


@dataclass(frozen=True, slots=True)
class Modes:
    """The modes of M q'' + D q' + K q = 0, the slowest first; arrays of shape (n,).

    The columns of `shapes`, shape (n, n), are the mode shapes, orthonormal with respect to M.
    `squared_frequencies` [rad²/s²] are negative where the chain topples. `damping` [1/s] is the
    diagonal of D in modal coordinates. `explicit_step` [s] and `all_roots` [1/s], shape (2n,), the
    solutions of det(s² M + s D + K) = 0 by increasing modulus, are exact for any D.
    """

    squared_frequencies: Array
    shapes: Array
    damping: Array
    explicit_step: float
    all_roots: Complex

    @property
    def least_damping_ratio(self) -> float:
        """The smallest damping ratio -Re s / |s| of all roots; negative if the chain topples."""
        moduli = np.abs(self.all_roots)
        moving = moduli > 1e-9 * moduli.max()
        return float((-self.all_roots.real[moving] / moduli[moving]).min(initial=1.0))

    @property
    def frequencies(self) -> Array:
        """Natural frequencies without damping [rad/s]; zero for modes that topple."""
        found: Array = np.sqrt(np.maximum(self.squared_frequencies, 0.0))
        return found

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios of the modes; infinite for a damped mode without stiffness."""
        twice = 2 * np.sqrt(np.abs(self.squared_frequencies))
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = np.where(self.damping > 0, self.damping / twice, 0.0)
        return found

    @property
    def moduli(self) -> Array:
        """Square roots of the absolute squared frequencies [rad/s], never zero: safe divisors."""
        squared_frequencies = np.abs(self.squared_frequencies)
        found: Array = np.sqrt(
            np.maximum(squared_frequencies, max(1e-12 * float(squared_frequencies.max()), 1e-30))
        )
        return found

    @property
    def roots(self) -> Complex:
        """The root of each mode [1/s], as if damping did not couple the modes.

        For an overdamped mode it is the slower of the two roots.
        """
        moduli = self.moduli
        damping_ratios = self.damping / (2 * moduli)
        beyond = np.sqrt((damping_ratios**2 - 1).astype(np.complex128))
        # ζ - sqrt(ζ² - 1) would lose all digits for large ζ
        found: Complex = np.where(
            damping_ratios < 1,
            moduli * (beyond - damping_ratios),
            -moduli / (damping_ratios + beyond),
        )
        return found

    @property
    def topples(self) -> bool:
        """Whether gravity or loads overcome the springs, so that the pose is unstable."""
        return bool(
            self.squared_frequencies[0] < NEGATIVE_STIFFNESS * abs(self.squared_frequencies[-1])
        )


def modes_at(pose: ChainPose, has_free_base: bool, geometric: Array) -> Modes:
    """Return the modes at a pose; `geometric`, shape (n, n), is the stiffness of gravity and loads.

    Raises SingularInertia.
    """
    mass = pose.joint_inertia(has_free_base)
    springs, damping = np.diag(pose.chain.stiffness), pose.chain.damping
    try:
        normalised, shaped = mass_normalisation(mass)
    except np.linalg.LinAlgError as error:
        raise SingularInertia("the masses differ too much, so the inertia is singular") from error
    stiff, damper = normalised(springs + geometric), normalised(damping)
    squared_frequencies, vectors = np.linalg.eigh(stiff)
    damped = np.einsum("ik,ij,jk->k", vectors, damper, vectors)
    # gravity can reduce the stiffness, which must not lengthen the step
    step = min(
        largest_explicit_step(mass, stiffness, damping)
        for stiffness in (springs, springs + geometric)
    )
    n = len(mass)
    # linearisation of the quadratic eigenvalue problem: Tisseur and Meerbergen,
    # SIAM Review 43 (2001) 235, sec. 3.4
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -damper]])
    roots = np.linalg.eigvals(companion).astype(np.complex128)
    roots = roots[np.argsort(np.abs(roots), kind="stable")]
    return Modes(squared_frequencies, shaped(vectors), np.maximum(damped, 0.0), step, roots)
