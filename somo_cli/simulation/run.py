"""The whole run on one screen: plan x world x recorder, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation import columns, watch
from somo_cli.simulation.columns import State
from somo_cli.simulation.free_base import FreeRunner
from somo_cli.simulation.penetration import Penetration, PenetrationWatch, steps_between_looks
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.runner import STEPS_BETWEEN_LOOKS, Runner
from somo_cli.simulation.start import begin
from somo_cli.simulation.world import World

_NO_CONTACT = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Summary:
    """What happened: steps done, rows written, and the wall time of the stepping loop [s].

    `deepest` is the deepest penetration seen, None where nothing was inside anything.
    """

    steps: int
    rows: int
    wall_time: float
    deepest: Penetration | None = None


@np.errstate(over="ignore", invalid="ignore")  # the watch says it better
def run(
    plan: Plan,
    world: World,
    write: Callable[[Iterable[float]], None],
    steps: int,
    clock: Callable[[], float],
    advance: Callable[[int], None] = lambda done: None,
) -> Summary:
    """Simulate `steps` steps and write a row of SI values for every recorded one, start included.

    Raises SimulationDiverged; the rows before it have been written.
    """
    runners = [
        (FreeRunner if body.base == "free" else Runner)(plan, body, world_body)
        for body, world_body in zip(plan.bodies, world.bodies, strict=True)
    ]
    begin(plan, world, runners)
    units = columns.units_of(plan)
    depths = PenetrationWatch(plan, world) if plan.can_touch else None
    energy_of_things = watch.ThingsEnergy(plan, world.things)
    needs_rates = not {"joint_rates", "energy"}.isdisjoint(plan.columns)
    needs_next_rates = plan.integrator == "implicit" and needs_rates
    step = rows = 0
    started = clock()
    while True:
        _actuate(plan, runners, step)
        for runner in runners:
            runner.measure()
        watch.check(step, plan, runners, energy_of_things.given())
        if depths is not None:
            depths.look(step)
        advance(step)
        is_recorded = step % plan.every == 0
        states = [_state(plan, runner, step) for runner in runners] if is_recorded else []
        seen = columns.of_things(plan, units, world.things, step) if is_recorded else []
        until = _next_stop(plan, step, steps)
        if is_recorded and needs_next_rates:
            until = step + 1
        if step < steps or until == step + 1:
            _step(plan, world, runners, step, until)
        if is_recorded:
            if needs_next_rates:
                _centre_rates(states, runners)
            write(columns.row(plan, units, step * plan.time_step, states) + seen)
            rows += 1
        if step >= steps:
            deepest = None if depths is None else depths.deepest
            return Summary(steps, rows, clock() - started, deepest)
        step = until


def _next_stop(plan: Plan, step: int, steps: int) -> int:
    """Return the next step with a look, a row or the end; where rows fall changes no torque."""
    next_look = step - step % STEPS_BETWEEN_LOOKS + STEPS_BETWEEN_LOOKS
    if plan.can_touch:
        between = steps_between_looks(plan.time_step, STEPS_BETWEEN_LOOKS)
        next_look = min(next_look, step - step % between + between)
    next_row = step - step % plan.every + plan.every
    return max(step, min(next_look, next_row, steps))


def _step(plan: Plan, world: World, runners: Sequence[Runner], first: int, until: int) -> None:
    """Advance from step `first`, whose actuation is set, to step `until`."""
    advance = world.step
    pulls = [runner.pull for runner in runners]
    is_look = first % STEPS_BETWEEN_LOOKS == 0
    for runner in runners:
        (runner.push_first if is_look else runner.push)()
    advance()
    for pull in pulls:
        pull()
    pushes = [runner.push for runner in runners]
    is_steady = _is_steady(plan, runners, first, until)
    for step in range(first + 1, until):
        if not is_steady:
            _actuate(plan, runners, step)
        for push in pushes:
            push()
        advance()
        for pull in pulls:
            pull()


def _actuate(plan: Plan, runners: Sequence[Runner], step: int) -> None:
    for runner in runners:
        runner.actuate(step * plan.time_step)


def _is_steady(plan: Plan, runners: Sequence[Runner], first: int, until: int) -> bool:
    """Whether no actuation changes after step `first` and before step `until`."""
    start, end = first * plan.time_step, (until - 1) * plan.time_step
    return all(runner.steady_until(start) > end for runner in runners)


def _state(plan: Plan, runner: Runner, step: int) -> State:
    """Return a copy of the present state; a base that cannot move is read when a column asks."""
    law = runner.law
    base = runner.world_body.base_pose
    velocity = geometry.ZERO, geometry.ZERO
    if runner.body.base != "static":
        pose, velocity = base(), runner.world_body.base_velocity()
        base = lambda: pose  # noqa: E731
    contact: Sequence[float] = _NO_CONTACT
    if "contact_force" in plan.columns and step > 0:
        contact = runner.world_body.contact_force()
    return State(
        runner.body,
        law.angles.tolist(),
        law.rates.tolist(),
        runner.actuation.tolist(),
        base,
        velocity,
        plan.gravity,
        runner.dynamics,
        contact,
    )


def _centre_rates(states: Sequence[State], runners: Sequence[Runner]) -> None:
    """Replace rates half a step before the instant by the mean with those half a step after."""
    for state, runner in zip(states, runners, strict=True):
        state.rates = (0.5 * (state.rates + runner.law.rates)).tolist()
        if runner.body.base != "static":
            linear, spin = (
                _mean(before, after)
                for before, after in zip(
                    state.base_velocity, runner.world_body.base_velocity(), strict=True
                )
            )
            state.base_velocity = linear, spin


def _mean(a: Vector, b: Vector) -> Vector:
    x, y, z = geometry.add(a, b)
    return (0.5 * x, 0.5 * y, 0.5 * z)
