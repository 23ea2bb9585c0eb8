"""The modes of a chain about one pose, and the step that the explicit law allows there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.dynamics.modal import largest_explicit_step, mass_normalisation

Complex: TypeAlias = npt.NDArray[np.complex128]

NEGATIVE_STIFFNESS_TOLERANCE = (
    -1e-9
)  # of the largest eigenvalue: what counts as a negative stiffness


class SingularInertia(ValueError):
    """The joint-space inertia is not positive definite in floating point."""


@dataclass(frozen=True, slots=True)
class Modes:
    """The modes of M q'' + D q' + K q = 0, slow ones first; arrays of shape (n,).

    `shapes`, (n, n), has one in each column, orthonormal with respect to M. `squared_frequencies`
    are those of the natural frequencies [rad²/s²], negative where the chain topples; `damping` is
    the diagonal of D in these modes [1/s]. Exact, whatever D is, are the explicit step [s] and
    `all_roots` [1/s], shape (2n,), of det(s² M + s D + K) = 0, those of least modulus first.
    """

    squared_frequencies: Array
    shapes: Array
    damping: Array
    explicit_step: float
    all_roots: Complex

    @property
    def least_damping_ratio(self) -> float:
        """The damping ratio -Re s / |s| of what dies away last in its periods; exact.

        Negative where the chain topples.
        """
        moduli = np.abs(self.all_roots)
        moving = moduli > 1e-9 * moduli.max()
        return float((-self.all_roots.real[moving] / moduli[moving]).min(initial=1.0))

    @property
    def frequencies(self) -> Array:
        """Natural frequencies without damping [rad/s]; those of toppling are zero."""
        found: Array = np.sqrt(np.maximum(self.squared_frequencies, 0.0))
        return found

    @property
    def damping_ratios(self) -> Array:
        """Damping damping_ratios of the modes; infinite for a damped one without stiffness."""
        twice = 2 * np.sqrt(np.abs(self.squared_frequencies))
        with np.errstate(divide="ignore", invalid="ignore"):
            found: Array = np.where(self.damping > 0, self.damping / twice, 0.0)
        return found

    @property
    def moduli(self) -> Array:
        """Natural frequencies [rad/s] as divisors: of either sign of the square, never zero."""
        squared_frequencies = np.abs(self.squared_frequencies)
        found: Array = np.sqrt(
            np.maximum(squared_frequencies, max(1e-12 * float(squared_frequencies.max()), 1e-30))
        )
        return found

    @property
    def roots(self) -> Complex:
        """The root [1/s] by which each mode moves on, as if damping did not couple modes.

        Of a mode that is damped beyond the critical it is the slow one of the two.
        """
        moduli = self.moduli
        damping_ratios = self.damping / (2 * moduli)
        beyond = np.sqrt((damping_ratios**2 - 1).astype(np.complex128))
        # not ζ - sqrt(ζ² - 1), which has no digits left where ζ is large
        found: Complex = np.where(
            damping_ratios < 1,
            moduli * (beyond - damping_ratios),
            -moduli / (damping_ratios + beyond),
        )
        return found

    @property
    def topples(self) -> bool:
        """Whether the chain leaves this pose by itself."""
        return bool(
            self.squared_frequencies[0]
            < NEGATIVE_STIFFNESS_TOLERANCE * abs(self.squared_frequencies[-1])
        )


def modes_at(pose: ChainPose, has_free_base: bool, geometric: Array) -> Modes:
    """Return the modes at a pose; `geometric`, (n, n), is the stiffness of gravity and loads.

    Raises SingularInertia.
    """
    mass = pose.joint_inertia(has_free_base)
    springs, damping = np.diag(pose.chain.stiffness), pose.chain.damping
    try:
        normalised, shaped = mass_normalisation(mass)
    except np.linalg.LinAlgError as error:
        raise SingularInertia("masses that differ too much leave no inertia to a joint") from error
    stiff, damper = normalised(springs + geometric), normalised(damping)
    squared_frequencies, vectors = np.linalg.eigh(stiff)
    damped = np.einsum("ik,ij,jk->k", vectors, damper, vectors)
    # what gravity takes away from the springs must not make the answer optimistic
    step = min(
        largest_explicit_step(mass, stiffness, damping)
        for stiffness in (springs, springs + geometric)
    )
    n = len(mass)
    # the quadratic eigenproblem as a linear one of twice the size: Tisseur and Meerbergen,
    # SIAM Review 43 (2001) 235, sec. 3.4
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-stiff, -damper]])
    roots = np.linalg.eigvals(companion).astype(np.complex128)
    roots = roots[np.argsort(np.abs(roots), kind="stable")]
    return Modes(squared_frequencies, shaped(vectors), np.maximum(damped, 0.0), step, roots)
