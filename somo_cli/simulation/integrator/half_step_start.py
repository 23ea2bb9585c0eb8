"""How a run starts: forces measured, velocities brought to where the integrator wants them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.problems import EngineRefused
from somo_cli.simulation.dynamics.modal import FROZEN, inertia_felt
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import Runner
from somo_cli.simulation.integrator.kinematic_object import ThingMover
from somo_cli.simulation.plan.model import Body, Plan


def begin(
    plan: Plan, world: World, runners: Sequence[Runner], movers: Sequence[ThingMover] = ()
) -> None:
    """Bring every body to its start, with the velocities its integrator wants there.

    The forces that are not ours at the start are measured by a step without torques, which is
    then undone. For the implicit law velocities live at half steps, so the bodies start with
    v0 - h/2 a0; how the bases accelerate under the first torques is measured by a second step.
    """
    for runner in runners:
        runner.pull()
        runner.refresh()
        _refuse_frozen(runner.body, runner.mass)
        runner.mass_at_start = runner.mass
        runner.actuate(0.0)
    for mover in movers:
        mover.actuate(0.0)
    if plan.integrator == "explicit":
        return
    for runner in runners:
        runner.assess()
    bases = [runner.world_body.base_velocity() for runner in runners]
    velocities = [thing.velocity()[0] for thing in world.objects]
    rates = [runner.law.rates.copy() for runner in runners]
    forces = []
    for runner in runners:
        runner.world_body.apply([0.0] * len(runner.law.rates))
    world.step()
    for runner, before in zip(runners, rates, strict=True):
        runner.pull()
        forces.append(runner.mass @ (runner.law.rates - before) / plan.time_step)
        runner.go_to_start()
    # objects, too, live at half steps: what they were pulled by in the step is undone by half
    halved = [
        _half_a_step_earlier(before, thing.velocity()[0])
        for before, thing in zip(velocities, world.objects, strict=True)
    ]
    for thing in world.objects:
        thing.reset()
    if plan.integrator == "implicit":
        _step_back_half(plan, world, runners, forces, bases)
        for thing, velocity in zip(world.objects, halved, strict=True):
            thing.reset(velocity)
    for runner, force, before in zip(runners, forces, rates, strict=True):
        runner.begin(force, before)


def _refuse_frozen(body: Body, mass: Array) -> None:
    """Raise EngineRefused for a body of which the engine would hold a joint, without a word."""
    try:
        felt = inertia_felt(mass)
    except np.linalg.LinAlgError:
        raise EngineRefused(
            body.name, "its masses differ too much: their inertia is not positive definite"
        ) from None
    least = int(np.argmin(felt))
    if felt[least] < FROZEN:
        raise EngineRefused(
            body.name,
            f"joint '{body.chain.joints[least].name}' moves {felt[least]:.2g} engine units of "
            f"inertia, and less than {FROZEN:g} does not move at all; the mass factor of "
            "world_scale changes no result, so choose a larger one",
        )


def _step_back_half(
    plan: Plan,
    world: World,
    runners: Sequence[Runner],
    forces: Sequence[Array],
    bases: Sequence[tuple[Vector, Vector]],
) -> None:
    accelerations = []
    for runner, force in zip(runners, forces, strict=True):
        acceleration = runner.law.acceleration(runner.mass, force)
        torques = runner.mass @ acceleration - force
        runner.apply(torques.tolist())
        accelerations.append(acceleration)
    world.step()
    for runner, acceleration, base in zip(runners, accelerations, bases, strict=True):
        after = runner.world_body.base_velocity()
        linear, angular = (
            _half_a_step_earlier(before, now) for before, now in zip(base, after, strict=True)
        )
        rates = np.array(runner.body.start.rates) - 0.5 * plan.time_step * acceleration
        runner.go_to_start(rates.tolist(), (linear, angular))


def _half_a_step_earlier(before: Vector, after: Vector) -> Vector:
    return (
        1.5 * before[0] - 0.5 * after[0],
        1.5 * before[1] - 0.5 * after[1],
        1.5 * before[2] - 0.5 * after[2],
    )
