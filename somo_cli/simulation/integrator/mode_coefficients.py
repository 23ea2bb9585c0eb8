"""How implicit the spring-damper law is: D + N and B, chosen mode by mode for an inertia.

`implicit_law` has the formulas and their sources.
"""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array, invert
from somo_cli.scene.model import Integrator
from somo_cli.simulation.plan.joint_springs import JointSprings

BETA = 1 / 12  # β of the spring in modes that the step resolves; Cowell's method
STIFF_BETA = 5 / 12  # added to it in modes that the step does not resolve, 1/2 in all
PADE_COEFFICIENT = 1 / 12  # of x² in B: Padé
FILTER_EPSILON = 0.02  # ε: the method damps modes with h ω beyond 1/√ε


class ModeCoefficients:
    """Computes D + N and B; `damping` is D, `constant_implicit` the part of B without inertia."""

    def __init__(self, springs: JointSprings, time_step: float, integrator: Integrator) -> None:
        self._springs = springs
        self._time_step = time_step
        self._integrator = integrator
        # an array: numpy multiplies by it in half the time that it takes to read a float
        self._half_step: Array = np.array(0.5 * time_step)
        self._gravity: tuple[Array, Array] | None = None  # of D + N and of B; None if resolved
        self._prepare()

    def matrices(self, mass: Array) -> tuple[Array, Array]:
        """Return D + N [N·m·s/rad] and B [kg·m²] for an inertia M, all of shape (n, n)."""
        if self._integrator == "implicit":
            # both resolvents at once: a call of numpy costs more than its work
            resolvents = invert(mass + self._inverse_offsets)
            resolvents *= self._outer_products
            numerical, stiff = resolvents
            damping = self.damping + numerical
            implicit = self.constant_implicit + self._half_step * numerical
            implicit += stiff
        else:
            damping, implicit = self.damping, self.constant_implicit
        if self._gravity is not None:
            damping = damping + self._gravity[0]
            implicit = implicit + self._gravity[1]
        return damping, implicit

    def set_gravity_stiffness(self, stiffness: Array, mass: Array) -> None:
        """Take the positive part of gravity's stiffness G, shape (n, n), from the next M on."""
        h = self._time_step
        numerical = h * stiffness
        if self._integrator == "implicit":
            share = FILTER_EPSILON * h * h * stiffness
            numerical = numerical @ np.linalg.solve(mass + share, share)
        self._gravity = numerical, 0.5 * h * (numerical + h * stiffness)

    def _prepare(self) -> None:
        """Lay down what of D + N and B no inertia changes.

        Of O (M + S)⁻¹ S with diagonals O and S, what is to be added to M and what the inverse is to
        be multiplied by, number by number; once for N, once for the stiff part of B.
        """
        h, k, d = self._time_step, self._springs.stiffness, self._springs.damping
        self.damping: Array = np.diag(d + h * k if self._integrator == "euler" else d)
        self.constant_implicit: Array = np.zeros_like(self.damping)
        if self._integrator == "euler":
            self.constant_implicit = h * self.damping
        elif self._integrator == "implicit":
            self.constant_implicit = np.diag(BETA * h * h * k + 0.5 * h * d)
        # from P M⁻¹ P / 12 in slow modes to P / 2 in stiff ones: the other halves of h D and h² K
        p = h * d + 2 * STIFF_BETA * h * h * k
        pairs = ((h * k, FILTER_EPSILON * h * h * k), (0.5 * p, 2 * PADE_COEFFICIENT * p))
        self._inverse_offsets: Array = np.array([np.diag(share) for _, share in pairs])
        self._outer_products: Array = np.array([np.outer(outer, share) for outer, share in pairs])
