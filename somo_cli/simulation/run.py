"""The whole run on one screen: plan x world x recorder, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np

from somo_cli.simulation import touching, watch
from somo_cli.simulation.endings import Ending, Stopped
from somo_cli.simulation.events import ContactWatch, Event
from somo_cli.simulation.free_base import FreeRunner
from somo_cli.simulation.moved_base import MovedRunner
from somo_cli.simulation.moved_thing import ThingMover
from somo_cli.simulation.penetration import Penetration, PenetrationWatch, steps_between_looks
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.rows import Rows
from somo_cli.simulation.runner import STEPS_BETWEEN_LOOKS, Runner
from somo_cli.simulation.start import begin
from somo_cli.simulation.world import World, WorldMovedBody, WorldMovedThing

Driven: TypeAlias = Runner | ThingMover


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
    write: Callable[[Iterable[float]], None],
    steps: int,
    clock: Callable[[], float],
    advance: Callable[[int], None] = lambda done: None,
    tell: Callable[[Event], None] | None = None,
) -> Summary:
    """Simulate `steps` steps and write a row of SI values for every recorded one, start included.

    With `tell`, contacts are looked at in every step, and every change of them is told. The run
    ends earlier if a condition of the plan says so. Raises SimulationDiverged; the rows before it
    have been written.
    """
    runners = [_runner(plan, world, number) for number, _ in enumerate(plan.bodies)]
    movers = [
        ThingMover(plan, planned, planned.path, cast(WorldMovedThing, thing), _met(world, number))
        for number, (planned, thing) in enumerate(
            zip(plan.things, world.things, strict=True), start=len(plan.bodies)
        )
        if planned.path is not None
    ]
    driven: list[Driven] = [*runners, *movers]
    begin(plan, world, runners, movers)
    recorded = Rows(plan, world, runners)
    ending = Ending(plan, world, runners, steps)
    contacts = None if tell is None else ContactWatch(plan.time_step, tell)
    depths = PenetrationWatch(plan, world) if plan.can_touch else None
    energy_of_things = watch.ThingsEnergy(plan, world.things)
    last = ending.steps
    stopped: Stopped | None = None
    step = rows = 0
    started = clock()
    while True:
        _actuate(plan, driven, step)
        is_look = step % STEPS_BETWEEN_LOOKS == 0
        is_due = step % plan.every == 0 or step == last
        if is_look or is_due:
            for runner in runners:
                runner.measure()
            given = energy_of_things.given() + sum(mover.given() for mover in movers)
            watch.check(step, plan, runners, given)
        if depths is not None:
            depths.look(step)
            if step % _steps_between_looks(plan) == 0:  # not at rows: they change nothing
                world.heed_contacts()
        advance(step)
        if is_look:
            recorded.look()
            stopped = ending.look(step)
        if stopped is not None:
            last = step
        is_recorded = step % plan.every == 0 or (plan.ends_in_row and step == last)
        if is_recorded:
            recorded.take(step)
        until = _next_stop(plan, step, last)
        if is_recorded and recorded.needs_next_step:
            until = step + 1
        if step < last:
            _step(plan, world, runners, driven, step, until, contacts)
        elif until == step + 1:
            _step(plan, world, runners, driven, step, until)  # beyond the end, for velocities alone
        if is_recorded:
            write(recorded.row())
            rows += 1
        if step >= last:
            deepest = None if depths is None else depths.deepest
            return Summary(last, rows, clock() - started, stopped or ending.at(step), deepest)
        step = until


def _next_stop(plan: Plan, step: int, steps: int) -> int:
    """Return the next step with a look, a row or the end; where rows fall changes no torque."""
    between = _steps_between_looks(plan)
    next_look = step - step % STEPS_BETWEEN_LOOKS + STEPS_BETWEEN_LOOKS
    next_look = min(next_look, step - step % between + between)
    next_row = step - step % plan.every + plan.every
    return max(step, min(next_look, next_row, steps))


def _steps_between_looks(plan: Plan) -> int:
    """Return how many steps may pass between two looks at contact."""
    if not plan.can_touch:
        return STEPS_BETWEEN_LOOKS
    return steps_between_looks(plan.time_step, STEPS_BETWEEN_LOOKS)


def _runner(plan: Plan, world: World, number: int) -> Runner:
    body, world_body = plan.bodies[number], world.bodies[number]
    if body.path is not None:
        moved = cast(WorldMovedBody, world_body)
        return MovedRunner(plan, body, moved, body.path, _met(world, number))
    return (FreeRunner if body.base == "free" else Runner)(plan, body, world_body)


def _met(world: World, number: int) -> Callable[[], Sequence[float]]:
    """Return what tells the force on a body or object, and the sum of the normal forces."""
    return lambda: touching.total(touching.on(world.touches(), number))


def _step(
    plan: Plan,
    world: World,
    runners: Sequence[Runner],
    driven: Sequence[Driven],
    first: int,
    until: int,
    contacts: ContactWatch | None = None,
) -> None:
    """Advance from step `first`, whose actuation is set, to step `until`."""
    advance = world.step
    pulls = [runner.pull for runner in runners]
    is_look = first % STEPS_BETWEEN_LOOKS == 0
    for runner in runners:
        (runner.push_first if is_look else runner.push)()
    advance()
    for pull in pulls:
        pull()
    if contacts is not None:
        contacts.look(first + 1, world.touches())
    if until == first + 1:
        return
    pushes = [runner.push for runner in runners]
    is_steady = _is_steady(plan, driven, first, until)
    for step in range(first + 1, until):
        if not is_steady:
            _actuate(plan, driven, step)
        for push in pushes:
            push()
        advance()
        for pull in pulls:
            pull()
        if contacts is not None:
            contacts.look(step + 1, world.touches())


def _actuate(plan: Plan, driven: Sequence[Driven], step: int) -> None:
    for one in driven:
        one.actuate(step * plan.time_step)


def _is_steady(plan: Plan, driven: Sequence[Driven], first: int, until: int) -> bool:
    """Whether no actuation changes after step `first` and before step `until`."""
    start, end = first * plan.time_step, (until - 1) * plan.time_step
    return all(one.steady_until(start) > end for one in driven)
