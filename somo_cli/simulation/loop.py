"""The loop of a run between two checks: torques, the engine's step, the new state, and rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_prediction import (
    ContactPrediction,
    PredictionCount,
)
from somo_cli.simulation.integrator.kinematic_object import KinematicObjectStepper
from somo_cli.simulation.integrator.object_rotation import ObjectRotations
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.contact_events import ContactMonitor
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.row_assembler import RowAssembler

DrivenBody: TypeAlias = BodyStepper | KinematicObjectStepper


class SimulationLoop:
    """Advances all bodies of a world together; a run spends most of its time in `advance`.

    Without an assembler nothing is recorded.
    """

    def __init__(
        self,
        plan: Plan,
        world: World,
        body_steppers: Sequence[BodyStepper],
        object_steppers: Sequence[KinematicObjectStepper],
        assembler: RowAssembler | None,
        contact_monitor: ContactMonitor | None,
    ) -> None:
        self._plan = plan
        self._world = world
        self._body_steppers = body_steppers
        rotations = ObjectRotations(plan, world)
        self._rotations = rotations if rotations.can_act else None
        self._driven: list[DrivenBody] = [*body_steppers, *object_steppers]
        self._actuations = [one.actuate for one in self._driven]
        self._reads = [body_stepper.read_state for body_stepper in body_steppers]
        self._counts = [body_stepper.work.count_step for body_stepper in body_steppers]
        self._assembler = assembler
        self._contact_monitor = contact_monitor
        self.is_steady = False
        """Whether torques and loads stayed the same in the last `advance`."""
        is_foreseen = bool(plan.bodies) and plan.can_touch and plan.integrator != "explicit"
        self._prediction = (
            ContactPrediction(plan, world, world.contact_reader(), body_steppers)
            if is_foreseen
            else None
        )
        self._applies_at_check: list[Callable[[], None]] = [
            one.apply_at_check for one in body_steppers
        ]
        self._applies_between: list[Callable[[], None]] | None = None
        if self._prediction is not None:
            self._applies_at_check = [partial(self._prediction.apply, True)]
            self._applies_between = [partial(self._prediction.apply, False)]
        self._steady_until = -math.inf  # s: until then torques and loads stay the same

    @property
    def prediction_count(self) -> PredictionCount:
        """The number of steps with contact so far, and of those in which it was not predicted."""
        return PredictionCount() if self._prediction is None else self._prediction.count

    def actuate(self, step: int) -> None:
        """Set the torques and loads of the step that starts at this one."""
        time = step * self._plan.time_step
        for actuate in self._actuations:
            actuate(time)

    # In one loop, not in functions: a run spends its time here, and a call costs as much as a row.
    def advance(self, first: int, until: int) -> None:  # complexipy: ignore
        """Advance from step `first`, whose actuation is set, to step `until`."""
        step_world, actuate, assembler, contact_monitor = (
            self._world.step,
            self.actuate,
            self._assembler,
            self._contact_monitor,
        )
        reads, counts, every = self._reads, self._counts, self._plan.every
        # the next step with a row, if rows are recorded
        row = until if assembler is None else first + -first % every
        is_steady = self.is_steady = self._is_steady(first, until)
        applies = self._applies(first)
        was_chosen = first % MONITORING_INTERVAL == 0  # so what is applied then changes after it
        for step in range(first, until):
            if not is_steady and step > first:
                actuate(step)
            if step == row and assembler is not None:
                assembler.take(step)
            for apply in applies:
                apply()
            if was_chosen and step + 1 < until:
                # not beyond: a check that is due there is for the state there
                applies, was_chosen = self._applies(step + 1), False
            step_world()
            for read in reads:
                read()
            if step == row and assembler is not None:
                assembler.complete()
                row += every
            if not is_steady:
                for count in counts:
                    count()
            if contact_monitor is not None:
                contact_monitor.update(step + 1, self._world.contact_points())
        for body_stepper in self._body_steppers:
            body_stepper.work.count(is_steady)

    def record_last(self, step: int) -> None:
        """Record the row of the last step; step on if it needs velocities half a step later.

        The actuation of the step is set.
        """
        assert self._assembler is not None, "rows are recorded"
        self._assembler.take(step)
        if self._assembler.needs_next_step:
            for apply in self._applies(step):
                apply()
            self._world.step()
            for read in self._reads:
                read()
        self._assembler.complete()

    def _applies(self, step: int) -> list[Callable[[], None]]:
        """Return what applies the torques of a step, chosen anew at every monitoring interval."""
        is_check = step % MONITORING_INTERVAL == 0
        if is_check:
            own = self._applies_at_check
        elif self._applies_between is not None:
            own = self._applies_between
        else:  # chosen by each body at its last check
            own = [body_stepper.apply_torques for body_stepper in self._body_steppers]
        if self._rotations is None:
            return own
        if is_check:
            self._rotations.check()
        return [*own, *self._rotations.applies]

    def _is_steady(self, first: int, until: int) -> bool:
        """Whether torques and loads stay the same after step `first` and before step `until`."""
        start, end = first * self._plan.time_step, (until - 1) * self._plan.time_step
        if self._steady_until > end:
            return True
        steady_until = math.inf
        for one in self._driven:
            steady_until = min(steady_until, one.constant_until(start))
            if steady_until <= end:
                return False
        self._steady_until = steady_until
        return True
