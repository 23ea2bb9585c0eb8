"""How often what a body is followed by is renewed: its inertia, and the correction of the law."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array

SLOW_REFRESH = 0.03  # rad: the mass matrix is renewed once the joints have moved this far, as the
FAST_REFRESH = 0.015  # root of the sum of squares over the joints
STALENESS = 0.25  # what a renewal may change of the inertia of any motion of the joints, at most
SLOW_PHASE = 0.2  # rad of the slowest mode between two looks: with larger steps no body is calm
SLOW_GRAVITY_PHASE = 0.25  # rad of the fastest mode of gravity alone in a step: likewise
FAST_GRAVITY_PHASE = 1.5  # rad, likewise: with larger steps gravity is in part implicit
SLOW_STEP_ANGLE = 0.005  # rad per step: a body with a faster joint is not calm
SLOW_CORRECTION = 3.0  # rad/s²: times the step squared, what holding may cost in a block [rad]
SLOW_CONTACT_CORRECTION = 12.0  # likewise where bodies can touch: contact costs more
MONITORING_INTERVAL = 8
REUSE_STEPS = (
    MONITORING_INTERVAL,
    4,
    2,
)  # steps for which a correction may be held; where nothing is
# touched the first alone, since what the others save is less than what they cost in error


class RefreshPolicy:
    """Decides it for one body, from what it is like at the start and how it moves at a look."""

    def __init__(self, time_step: float, can_touch: bool) -> None:
        self.is_gravity_implicit = False
        """Whether gravity alone would be too fast for the step."""
        self.refresh_angle = FAST_REFRESH
        """How far [rad] the joints may move, as above, before the inertia is renewed."""
        self._step = time_step
        self._angle_factor = 1.0  # times these angles, where the inertia changes fast
        self._slowest_mode = self._fastest_gravity_mode = math.inf  # rad/s, where the run starts
        self._reuse_options = REUSE_STEPS if can_touch else REUSE_STEPS[:1]
        self._slow_correction = SLOW_CONTACT_CORRECTION if can_touch else SLOW_CORRECTION

    def set_modes(self, slowest_mode: float, fastest_gravity_mode: float, change: float) -> None:
        """Take the slowest mode and the fastest of gravity alone [rad/s] at the start.

        `change` is what of the inertia of any motion changes, at most, while the joints move by
        SLOW_REFRESH.
        """
        self._slowest_mode, self._fastest_gravity_mode = slowest_mode, fastest_gravity_mode
        self.is_gravity_implicit = self._step * fastest_gravity_mode > FAST_GRAVITY_PHASE
        self._angle_factor = min(1.0, STALENESS / change) if change > 0 else 1.0
        self.refresh_angle = self._angle_factor * FAST_REFRESH

    def reuse_steps(self, change: Array, max_rate: float) -> int:
        """Return for how many steps a correction may be held, renewed in the next one.

        `change` is by what it changed between two looks, over each joint's inertia [rad/s²], shape
        (n,), and `max_rate` the rate of the fastest joint [rad/s].
        """
        if self._step * self._fastest_gravity_mode > SLOW_GRAVITY_PHASE:
            return 1
        phase, step_angle = (
            self._step * self._slowest_mode,
            self._step * max_rate / self._angle_factor,
        )
        block = MONITORING_INTERVAL**2  # what a constant force does in one, over the step squared
        scaled_change = block * math.sqrt(
            change.dot(change)
        )  # rad/s²; that of one joint is no more
        if scaled_change > self._slow_correction:
            scaled_change = block * float(np.abs(change).max())
        for steps in self._reuse_options:
            share = steps / MONITORING_INTERVAL
            is_slow = steps * phase <= SLOW_PHASE and share * step_angle <= SLOW_STEP_ANGLE
            if is_slow and share**2 * scaled_change <= self._slow_correction:
                return steps
        return 1

    def set_reuse(self, steps: int) -> None:
        """Take for how many steps the correction is held until the next look."""
        is_slow = steps == MONITORING_INTERVAL
        self.refresh_angle = self._angle_factor * (SLOW_REFRESH if is_slow else FAST_REFRESH)
