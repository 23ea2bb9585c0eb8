"""The whole run on one screen: plan x world x recorder, step by step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import cast

import numpy as np

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.interface import World, WorldMovedBody, WorldMovedThing
from somo_cli.simulation.integrator.body_stepper import Runner
from somo_cli.simulation.integrator.energy_bound import ThingsEnergy
from somo_cli.simulation.integrator.floating_base import FreeRunner
from somo_cli.simulation.integrator.half_step_start import begin
from somo_cli.simulation.integrator.kinematic_object import ThingMover
from somo_cli.simulation.integrator.prescribed_base import MovedRunner
from somo_cli.simulation.integrator.refresh_policy import STEPS_BETWEEN_LOOKS
from somo_cli.simulation.loop import SimulationLoop
from somo_cli.simulation.monitoring.contact_events import ContactEvent, ContactMonitor
from somo_cli.simulation.monitoring.divergence import DivergenceMonitor
from somo_cli.simulation.monitoring.penetration import (
    Penetration,
    PenetrationMonitor,
    steps_between_samples,
)
from somo_cli.simulation.monitoring.stop_monitor import StopMonitor, StopReason
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.row_assembler import RowAssembler, RowWriter

MAX_LIVE_DELAY = 0.05  # s for which a row may wait, but for what passes between two looks


@dataclass(frozen=True, slots=True)
class RunSummary:
    """What happened: steps done, rows written, and the wall time of the stepping loop [s].

    `stopped` is the condition of the scene that ended the run, if one did, and `deepest` the
    deepest penetration seen, None where nothing was inside anything.
    """

    steps: int
    rows: int
    wall_time: float
    stopped: StopReason | None = None
    deepest: Penetration | None = None


@np.errstate(over="ignore", invalid="ignore")  # the watch says it better
def run(
    plan: Plan,
    world: World,
    write: RowWriter,
    steps: int,
    clock: Callable[[], float],
    advance: Callable[[int], None] = lambda done: None,
    on_event: Callable[[ContactEvent], None] | None = None,
    is_live: bool = False,
) -> RunSummary:
    """Simulate `steps` steps and write a row of SI values for every recorded one, start included.

    RowAssembler are written many at once, (rows, columns); if `is_live`, none waits for long. With `on_event`,
    contacts are looked at in every step, and every change of them is told. The run ends earlier
    if a condition of the plan says so. Raises SimulationDiverged. Whatever ends the run, the rows
    before it have been written.
    """
    runners = [_body_runner(plan, world, number) for number, _ in enumerate(plan.bodies)]
    movers = _kinematic_objects(plan, world)
    begin(plan, world, runners, movers)
    divergence_monitor = DivergenceMonitor(plan, runners, _object_energy(plan, world, movers))
    assembler = RowAssembler(plan, world, runners, divergence_monitor, write)
    stop_monitor = StopMonitor(plan, world, runners, steps)
    contact_monitor = None if on_event is None else ContactMonitor(plan.time_step, on_event)
    loop = SimulationLoop(plan, world, runners, movers, assembler, contact_monitor)
    penetration_monitor = PenetrationMonitor(plan, world) if plan.can_touch else None
    penetration_interval = _steps_between_samples(plan)
    last = stop_monitor.steps
    stopped: StopReason | None = None
    step = 0
    started = flushed = clock()
    try:
        while True:
            loop.actuate(step)
            is_monitored = step % STEPS_BETWEEN_LOOKS == 0
            if is_monitored or step == last:
                divergence_monitor.update(step)
            if penetration_monitor is not None:
                penetration_monitor.update(step)
                if step % penetration_interval == 0:  # not at the end: it changes nothing
                    world.heed_contacts()
            advance(step)
            if is_monitored:
                assembler.count_rotations()
                stopped = stop_monitor.check(step)
                if assembler.is_full or (is_live and clock() - flushed > MAX_LIVE_DELAY):
                    assembler.flush()
                    flushed = clock() if is_live else flushed
            if stopped is not None:
                last = step
            if step >= last:
                break
            until = min(
                _next_multiple(STEPS_BETWEEN_LOOKS, step),
                _next_multiple(penetration_interval, step),
                last,
            )
            loop.advance(step, until)
            step = until
        if step % plan.every == 0 or plan.ends_in_row:
            loop.record_last(step)
    except BaseException:
        with suppress(OSError):  # a full disk is not to hide what ended the run
            assembler.flush()
        raise
    assembler.flush()
    deepest = None if penetration_monitor is None else penetration_monitor.deepest
    wall_time = clock() - started
    return RunSummary(
        last, assembler.written, wall_time, stopped or stop_monitor.at_step(step), deepest
    )


def _steps_between_samples(plan: Plan) -> int:
    """Return how many steps may pass between two looks at contact."""
    if not plan.can_touch:
        return STEPS_BETWEEN_LOOKS
    return steps_between_samples(plan.time_step, STEPS_BETWEEN_LOOKS)


def _next_multiple(steps: int, step: int) -> int:
    """Return the next multiple of so many steps after a step."""
    return step - step % steps + steps


def _body_runner(plan: Plan, world: World, number: int) -> Runner:
    body, world_body = plan.bodies[number], world.bodies[number]
    if body.path is not None:
        moved = cast(WorldMovedBody, world_body)
        return MovedRunner(plan, body, moved, body.path, _contact_force_on(world, number))
    return (FreeRunner if body.base == "free" else Runner)(plan, body, world_body)


def _kinematic_objects(plan: Plan, world: World) -> list[ThingMover]:
    return [
        ThingMover(
            plan,
            planned,
            planned.path,
            cast(WorldMovedThing, thing),
            _contact_force_on(world, number),
        )
        for number, (planned, thing) in enumerate(
            zip(plan.objects, world.objects, strict=True), start=len(plan.bodies)
        )
        if planned.path is not None
    ]


def _contact_force_on(world: World, number: int) -> Callable[[], Sequence[float]]:
    """Return what tells the force on a body or object, and the sum of the normal forces."""
    return lambda: contacts.total(contacts.on(world.touches(), number))


def _object_energy(plan: Plan, world: World, movers: Sequence[ThingMover]) -> Callable[[], float]:
    """Return what tells the most energy that objects may have added by now."""
    of_things = ThingsEnergy(plan, world.objects)
    return lambda: of_things.given() + sum(mover.given() for mover in movers)
