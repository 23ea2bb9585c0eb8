"""Applies the torques of one body's law, and chooses for how long its correction is reused."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.integrator.fixed_base import FixedBase
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.joint_inertia import JointInertia
from somo_cli.simulation.integrator.joint_limits import JointLimits
from somo_cli.simulation.integrator.refresh_policy import (
    MONITORING_INTERVAL,
    REUSE_STEPS,
    RefreshPolicy,
)
from somo_cli.simulation.integrator.reused_correction import ReusedCorrection

NEAR_LIMIT = 0.1  # rad: with a joint nearer to its limit no correction is reused
FAR_LIMIT = 1.0  # rad: a joint farther from its limits does not reach them before the next check,
LOOKAHEAD = 2.0  # nor one that would not in so many times the time until then


class LawStepper:
    """Applies torques step by step; `apply_torques` and `predict` are chosen at each check.

    The correction for the engine's early Coriolis forces costs two calls into the engine. While the
    body moves slowly, and the correction changed so little since the last check that reusing it
    costs less than the error of the method, it is not refreshed in every step.
    """

    def __init__(
        self,
        law: SpringDamperLaw,
        base: FixedBase,
        inertia: JointInertia,
        limits: JointLimits,
        policy: RefreshPolicy,
    ) -> None:
        self._law = law
        self._base = base
        self._inertia = inertia
        self._policy = policy
        self.reused = ReusedCorrection(law)
        self._apply, self._reused_torques = base.apply, self.reused.torques
        self._limit_torques = partial(limits.torques, law.time_step, law.angles, law.rates)
        self._at_check: tuple[Array, Array] | None = None  # correction and bias at the last check
        self._last_correction = np.zeros(0), np.zeros(0)  # correction and bias of the last refresh
        self._steps_reused = self._steps_left = 1
        self._by_reuse: dict[int, tuple[Callable[[], None], Callable[[], None]]] = {
            1: (self._apply_refreshed, self._predict_refreshed),
            MONITORING_INTERVAL: (self.apply_reused, self.reused.predict),
        }
        self._by_reuse |= {
            steps: (self._apply_alternating, self._predict_alternating) for steps in REUSE_STEPS[1:]
        }
        first = MONITORING_INTERVAL if law.integrator == "explicit" else 1
        self.apply_torques, self.predict = self._by_reuse[first]

    def apply_at_check(self, max_rate: float) -> None:
        """Apply torques at a check, and choose how to step until the next one.

        `max_rate` is the rate of the fastest joint [rad/s].
        """
        if self._law.integrator == "explicit":
            self._inertia.refresh_if_moved()
            self.apply_torques()
        else:
            self.predict_at_check(max_rate)
            self._base.finish(self._law, None)

    def predict_at_check(self, max_rate: float) -> None:
        """Do as `apply_at_check` does but for applying the torques, which the base does."""
        law = self._law
        self._refresh_inertia()
        reach = FAR_LIMIT + LOOKAHEAD * MONITORING_INTERVAL * law.time_step * max_rate
        clearance = self._inertia.clearance(reach)
        law.limit_torques = self._limit_torques if clearance < reach else None
        self._base.predict(law)
        assert law.bias is not None
        last = self._at_check
        self._at_check = self._last_correction = law.correction, law.bias
        steps = 1
        if last is not None and clearance > NEAR_LIMIT:
            growth = law.correction - last[0]
            steps = self._reuse_steps(growth, max_rate)
            if steps > 1:
                self.reused.extrapolate(last[1] - law.bias, growth, MONITORING_INTERVAL)
        self._steps_reused = self._steps_left = steps
        self.apply_torques, self.predict = self._by_reuse[steps]
        self._policy.set_reuse(steps)

    def apply_reused(self) -> None:
        """Apply torques with a reused correction, as most steps do."""
        self._apply(self._reused_torques())

    def _reuse_steps(self, change: Array, max_rate: float) -> int:
        """Return for how many steps a correction that changed by `change` may be reused."""
        if not self._base.can_reuse_correction():
            return 1
        return self._policy.reuse_steps(change / self._inertia.matrix.diagonal(), max_rate)

    def _apply_refreshed(self) -> None:
        self._predict_refreshed()
        self._base.finish(self._law, None)

    def _predict_refreshed(self) -> None:
        self._refresh_inertia()
        self._base.predict(self._law)

    def _refresh_inertia(self) -> None:
        if self._base.needs_fresh_inertia():
            self._inertia.refresh()
        else:
            self._inertia.refresh_if_moved()

    def _apply_alternating(self) -> None:
        if self._steps_left > 1:
            self._steps_left -= 1
            self.apply_reused()
        else:
            self._predict_alternating()
            self._base.finish(self._law, None)

    def _predict_alternating(self) -> None:
        """Predict with the correction reused, and refreshed in every second or fourth step."""
        self._steps_left -= 1
        if self._steps_left:
            self.reused.predict()
            return
        law, (correction, bias), steps = self._law, self._last_correction, self._steps_reused
        self._predict_refreshed()
        assert law.bias is not None
        self.reused.extrapolate(bias - law.bias, law.correction - correction, steps)
        self._last_correction, self._steps_left = (law.correction, law.bias), steps
