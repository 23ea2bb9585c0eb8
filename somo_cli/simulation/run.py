"""The whole run on one screen: plan x world x recorder, step by step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import cast

import numpy as np

from somo_cli.simulation import touching
from somo_cli.simulation.endings import Ending, Stopped
from somo_cli.simulation.energy import ThingsEnergy
from somo_cli.simulation.events import ContactWatch, Event
from somo_cli.simulation.free_base import FreeRunner
from somo_cli.simulation.moved_base import MovedRunner
from somo_cli.simulation.moved_thing import ThingMover
from somo_cli.simulation.pace import STEPS_BETWEEN_LOOKS
from somo_cli.simulation.penetration import Penetration, PenetrationWatch, steps_between_looks
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.rows import Rows, Write
from somo_cli.simulation.runner import Runner
from somo_cli.simulation.start import begin
from somo_cli.simulation.stepper import Stepper
from somo_cli.simulation.watch import Watch
from somo_cli.simulation.world import World, WorldMovedBody, WorldMovedThing

LIVE = 0.05  # s for which a row may wait, but for what passes between two looks


@dataclass(frozen=True, slots=True)
class Summary:
    """What happened: steps done, rows written, and the wall time of the stepping loop [s].

    `stopped` is the condition of the scene that ended the run, if one did, and `deepest` the
    deepest penetration seen, None where nothing was inside anything.
    """

    steps: int
    rows: int
    wall_time: float
    stopped: Stopped | None = None
    deepest: Penetration | None = None


@np.errstate(over="ignore", invalid="ignore")  # the watch says it better
def run(
    plan: Plan,
    world: World,
    write: Write,
    steps: int,
    clock: Callable[[], float],
    advance: Callable[[int], None] = lambda done: None,
    tell: Callable[[Event], None] | None = None,
    is_live: bool = False,
) -> Summary:
    """Simulate `steps` steps and write a row of SI values for every recorded one, start included.

    Rows are written many at once, (rows, columns); if `is_live`, none waits for long. With `tell`,
    contacts are looked at in every step, and every change of them is told. The run ends earlier
    if a condition of the plan says so. Raises SimulationDiverged. Whatever ends the run, the rows
    before it have been written.
    """
    runners = [_runner(plan, world, number) for number, _ in enumerate(plan.bodies)]
    movers = _movers(plan, world)
    begin(plan, world, runners, movers)
    watch = Watch(plan, runners, _given(plan, world, movers))
    recorded = Rows(plan, world, runners, watch, write)
    ending = Ending(plan, world, runners, steps)
    contacts = None if tell is None else ContactWatch(plan.time_step, tell)
    stepper = Stepper(plan, world, runners, movers, recorded, contacts)
    depths = PenetrationWatch(plan, world) if plan.can_touch else None
    between = _steps_between_looks(plan)
    last = ending.steps
    stopped: Stopped | None = None
    step = 0
    started = released = clock()
    try:
        while True:
            stepper.actuate(step)
            is_look = step % STEPS_BETWEEN_LOOKS == 0
            if is_look or step == last:
                watch.look(step)
            if depths is not None:
                depths.look(step)
                if step % between == 0:  # not at the end: it changes nothing
                    world.heed_contacts()
            advance(step)
            if is_look:
                recorded.look()
                stopped = ending.look(step)
                if recorded.is_full or (is_live and clock() - released > LIVE):
                    recorded.release()
                    released = clock() if is_live else released
            if stopped is not None:
                last = step
            if step >= last:
                break
            until = min(_next(STEPS_BETWEEN_LOOKS, step), _next(between, step), last)
            stepper.advance(step, until)
            step = until
        if step % plan.every == 0 or plan.ends_in_row:
            stepper.take_last(step)
    except BaseException:
        with suppress(OSError):  # a full disk is not to hide what ended the run
            recorded.release()
        raise
    recorded.release()
    deepest = None if depths is None else depths.deepest
    taken = clock() - started
    return Summary(last, recorded.written, taken, stopped or ending.at(step), deepest)


def _steps_between_looks(plan: Plan) -> int:
    """Return how many steps may pass between two looks at contact."""
    if not plan.can_touch:
        return STEPS_BETWEEN_LOOKS
    return steps_between_looks(plan.time_step, STEPS_BETWEEN_LOOKS)


def _next(steps: int, step: int) -> int:
    """Return the next multiple of so many steps after a step."""
    return step - step % steps + steps


def _runner(plan: Plan, world: World, number: int) -> Runner:
    body, world_body = plan.bodies[number], world.bodies[number]
    if body.path is not None:
        moved = cast(WorldMovedBody, world_body)
        return MovedRunner(plan, body, moved, body.path, _met(world, number))
    return (FreeRunner if body.base == "free" else Runner)(plan, body, world_body)


def _movers(plan: Plan, world: World) -> list[ThingMover]:
    return [
        ThingMover(plan, planned, planned.path, cast(WorldMovedThing, thing), _met(world, number))
        for number, (planned, thing) in enumerate(
            zip(plan.things, world.things, strict=True), start=len(plan.bodies)
        )
        if planned.path is not None
    ]


def _met(world: World, number: int) -> Callable[[], Sequence[float]]:
    """Return what tells the force on a body or object, and the sum of the normal forces."""
    return lambda: touching.total(touching.on(world.touches(), number))


def _given(plan: Plan, world: World, movers: Sequence[ThingMover]) -> Callable[[], float]:
    """Return what tells the most energy that objects may have added by now."""
    of_things = ThingsEnergy(plan, world.things)
    return lambda: of_things.given() + sum(mover.given() for mover in movers)
