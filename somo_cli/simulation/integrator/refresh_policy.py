"""When the mass matrix and the Coriolis correction are refreshed."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array

# Joint motion [rad] after which the mass matrix is refreshed, as the root of the sum of squares
# over the joints: of a body that moves slowly, and of any other.
SLOW_REFRESH = 0.03
FAST_REFRESH = 0.015
STALENESS = 0.25  # the largest relative change of modal inertia between two refreshes
# A correction is reused up to these bounds:
SLOW_PHASE = 0.2  # rad, by which the slowest mode turns between two checks
SLOW_GRAVITY_PHASE = 0.25  # rad, by which the fastest mode of gravity alone turns in a step
SLOW_STEP_ANGLE = 0.005  # rad, by which the fastest joint turns in a step
SLOW_CORRECTION = 3.0  # rad/s²; times the step squared, the error of reuse between two checks [rad]
SLOW_CONTACT_CORRECTION = 12.0  # rad/s², where bodies can touch, since contact costs more
FAST_GRAVITY_PHASE = 1.5  # rad in a step, from which on gravity is in part implicit

MONITORING_INTERVAL = 8
"""Steps from one check of motion to the next."""

# Steps for which a correction may be reused. Where nothing can touch only the first counts: the
# others save less than they cost in error.
REUSE_STEPS = (MONITORING_INTERVAL, 4, 2)


class RefreshPolicy:
    """Decides when to refresh one body, from its modes at the start and its motion at a check."""

    def __init__(self, time_step: float, can_touch: bool) -> None:
        self.is_gravity_implicit = False
        """Whether a mode of gravity alone is too fast for the step."""
        self.refresh_angle = FAST_REFRESH
        """The joint motion [rad] after which the mass matrix is refreshed."""
        self._step = time_step
        self._angle_factor = 1.0  # of these angles, less where the inertia changes fast
        self._slowest_mode = self._fastest_gravity_mode = math.inf  # rad/s, at the start
        self._reuse_options = REUSE_STEPS if can_touch else REUSE_STEPS[:1]
        self._slow_correction = SLOW_CONTACT_CORRECTION if can_touch else SLOW_CORRECTION

    def set_modes(self, slowest_mode: float, fastest_gravity_mode: float, change: float) -> None:
        """Set the slowest mode, and the fastest of gravity alone, at the start [rad/s].

        `change` is the largest relative change of modal inertia over a joint motion of
        SLOW_REFRESH.
        """
        self._slowest_mode, self._fastest_gravity_mode = slowest_mode, fastest_gravity_mode
        self.is_gravity_implicit = self._step * fastest_gravity_mode > FAST_GRAVITY_PHASE
        self._angle_factor = min(1.0, STALENESS / change) if change > 0 else 1.0
        self.refresh_angle = self._angle_factor * FAST_REFRESH

    def reuse_steps(self, change: Array, max_rate: float) -> int:
        """Return for how many steps a correction may be reused; it is refreshed in the next one.

        `change` is its change between two checks, over each joint's inertia [rad/s²], shape (n,),
        and `max_rate` the rate of the fastest joint [rad/s].
        """
        if self._step * self._fastest_gravity_mode > SLOW_GRAVITY_PHASE:
            return 1
        phase, step_angle = (
            self._step * self._slowest_mode,
            self._step * max_rate / self._angle_factor,
        )
        # a constant force moves a joint by this times its acceleration, over the step squared
        block = MONITORING_INTERVAL**2
        scaled_change = block * math.sqrt(change.dot(change))  # a bound on the largest of a joint
        if scaled_change > self._slow_correction:
            scaled_change = block * float(np.abs(change).max())
        for steps in self._reuse_options:
            share = steps / MONITORING_INTERVAL
            is_slow = steps * phase <= SLOW_PHASE and share * step_angle <= SLOW_STEP_ANGLE
            if is_slow and share**2 * scaled_change <= self._slow_correction:
                return steps
        return 1

    def set_reuse(self, steps: int) -> None:
        """Set for how many steps the correction is reused until the next check."""
        is_slow = steps == MONITORING_INTERVAL
        self.refresh_angle = self._angle_factor * (SLOW_REFRESH if is_slow else FAST_REFRESH)
