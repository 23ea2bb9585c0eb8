"""How often what a body is followed by is renewed: its inertia, and the correction of the law."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array

CALM_REFRESH = 0.03  # rad: the mass matrix is renewed once the joints have moved this far, as the
SWIFT_REFRESH = 0.015  # root of the sum of squares over the joints
STALE = 0.25  # what a renewal may change of the inertia of any motion of the joints, at most
CALM_PHASE = 0.2  # rad of the slowest mode between two looks: with larger steps no body is calm
CALM_FALL = 0.25  # rad of the fastest mode of gravity alone in a step: likewise
SWIFT_FALL = 1.5  # rad, likewise: with larger steps gravity is in part implicit
CALM_ANGLE = 0.005  # rad per step: a body with a faster joint is not calm
CALM_CHANGE = 3.0  # rad/s²: times the step squared, what holding may cost in a block [rad]
CALM_CHANGE_IN_TOUCH = 12.0  # likewise where bodies can touch: contact costs more
STEPS_BETWEEN_LOOKS = 8
HOLDS = (STEPS_BETWEEN_LOOKS, 4, 2)  # steps for which a correction may be held; where nothing is
# touched the first alone, since what the others save is less than what they cost in error


class Pace:
    """Decides it for one body, from what it is like at the start and how it moves at a look."""

    def __init__(self, time_step: float, can_touch: bool) -> None:
        self.is_heavy = False
        """Whether gravity alone would be too fast for the step."""
        self.refresh_angle = SWIFT_REFRESH
        """How far [rad] the joints may move, as above, before the inertia is renewed."""
        self._step = time_step
        self._freshness = 1.0  # times these angles, where the inertia changes fast
        self._slowest_mode = self._fastest_fall = math.inf  # rad/s, where the run starts
        self._holds = HOLDS if can_touch else HOLDS[:1]
        self._calm_change = CALM_CHANGE_IN_TOUCH if can_touch else CALM_CHANGE

    def assess(self, slowest_mode: float, fastest_fall: float, change: float) -> None:
        """Take the slowest mode and the fastest of gravity alone [rad/s] at the start.

        `change` is what of the inertia of any motion changes, at most, while the joints move by
        CALM_REFRESH.
        """
        self._slowest_mode, self._fastest_fall = slowest_mode, fastest_fall
        self.is_heavy = self._step * fastest_fall > SWIFT_FALL
        self._freshness = min(1.0, STALE / change) if change > 0 else 1.0
        self.refresh_angle = self._freshness * SWIFT_REFRESH

    def steps_to_hold(self, change: Array, fastest: float) -> int:
        """Return for how many steps a correction may be held, renewed in the next one.

        `change` is by what it changed between two looks, over each joint's inertia [rad/s²], shape
        (n,), and `fastest` the rate of the fastest joint [rad/s].
        """
        if self._step * self._fastest_fall > CALM_FALL:
            return 1
        phase, turn = self._step * self._slowest_mode, self._step * fastest / self._freshness
        block = STEPS_BETWEEN_LOOKS**2  # what a constant force does in one, over the step squared
        pull = block * math.sqrt(change.dot(change))  # rad/s²; that of one joint is no more
        if pull > self._calm_change:
            pull = block * float(np.abs(change).max())
        for steps in self._holds:
            share = steps / STEPS_BETWEEN_LOOKS
            is_calm = steps * phase <= CALM_PHASE and share * turn <= CALM_ANGLE
            if is_calm and share**2 * pull <= self._calm_change:
                return steps
        return 1

    def go_on(self, held: int) -> None:
        """Take for how many steps the correction is held until the next look."""
        is_calm = held == STEPS_BETWEEN_LOOKS
        self.refresh_angle = self._freshness * (CALM_REFRESH if is_calm else SWIFT_REFRESH)
