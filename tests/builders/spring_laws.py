"""Laws to test: springs, inertias, and the formulas written plainly."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.reused_correction import ReusedCorrection
from somo_cli.simulation.plan.joint_springs import JointSprings

H = 1e-2  # s


def springs(n: int = 3) -> JointSprings:
    """Return springs and dampers of about 1 N·m/rad, always the same."""
    numbers = np.random.default_rng(1)
    return JointSprings(
        numbers.uniform(1, 5, n), numbers.uniform(0.01, 0.1, n), numbers.uniform(-0.2, 0.2, n)
    )


def inertia(n: int = 3) -> Array:
    """Return a positive definite matrix, always the same."""
    root = np.random.default_rng(2).normal(size=(n, n))
    matrix: Array = root @ root.T + n * np.eye(n)
    return matrix


def spring_damper_torques(springs: JointSprings, angles: Array, rates: Array) -> Array:
    """Return -K (q - q0) - D v."""
    torques: Array = -springs.stiffness * (angles - springs.neutral) - springs.damping * rates
    return torques


def plain_torques(
    law: SpringDamperLaw, mass: Array, q: Array, v: Array, v_prev: Array, tau_prev: Array, u: Array
) -> Array:
    """Return τ by the formulas of the module's docstring, one after the other."""
    k, q0 = law.springs.stiffness, law.springs.neutral
    damping, b = law.coefficients.matrices(mass)
    s = u - k * (q - q0) - damping @ v
    f = mass @ (v - v_prev) / H - tau_prev
    a = np.linalg.solve(mass + b, f + s)
    torques: Array = s - b @ a
    return torques


def torques_with_nothing_to_correct(law: SpringDamperLaw, mass: Array) -> Callable[[], list[float]]:
    """Have the law take an inertia; return what gives its torques without a correction."""
    law.refresh(mass)
    reused, nothing = ReusedCorrection(law), np.zeros(len(mass))
    reused.extrapolate(nothing, nothing, 1)
    return reused.torques
