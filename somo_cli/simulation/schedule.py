"""The steps at which a run pauses for checks of motion and contact."""

from __future__ import annotations

from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.penetration import steps_between_samples
from somo_cli.simulation.plan.model import Plan


class MonitoringSchedule:
    """The steps at which motion and contact are checked; they depend on the plan alone.

    So no result depends on what is recorded, or on how many steps are taken at once.
    """

    def __init__(self, plan: Plan) -> None:
        self._contact_interval = MONITORING_INTERVAL
        if plan.can_touch:
            self._contact_interval = steps_between_samples(plan.time_step, MONITORING_INTERVAL)

    @staticmethod
    def checks_motion(step: int) -> bool:
        """Whether divergence and stop conditions are checked at a step."""
        return step % MONITORING_INTERVAL == 0

    def checks_contact(self, step: int) -> bool:
        """Whether the solver's iterations are chosen anew at a step, from the contacts there."""
        return step % self._contact_interval == 0

    def is_pause(self, step: int) -> bool:
        """Whether any check is due at a step."""
        return self.checks_motion(step) or self.checks_contact(step)

    def pause_after(self, step: int, last: int) -> int:
        """Return the first step after `step` with a check, or `last` if that comes first."""
        return min(
            _next_multiple(MONITORING_INTERVAL, step),
            _next_multiple(self._contact_interval, step),
            last,
        )


def _next_multiple(interval: int, step: int) -> int:
    return step - step % interval + interval
