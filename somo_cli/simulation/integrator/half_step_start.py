"""Start a run: measure the forces, and set velocities half a step before the start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.problems import EngineRefused
from somo_cli.simulation.dynamics.gyroscopic import rate_half_step_before
from somo_cli.simulation.dynamics.modal import MIN_JOINT_INERTIA, articulated_inertia
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.kinematic_object import KinematicObjectStepper
from somo_cli.simulation.plan.model import Body, Plan


def begin(
    plan: Plan,
    world: World,
    body_steppers: Sequence[BodyStepper],
    object_steppers: Sequence[KinematicObjectStepper] = (),
) -> None:
    """Bring every body to its start, with the velocities that its integrator needs there.

    A trial step without torques measures the other forces on the joints and is then undone. The
    implicit integrator has velocities at half steps, so bodies start with v0 - h/2 a0; a second
    trial step measures the acceleration of the bases under the first torques.
    """
    for body_stepper in body_steppers:
        _prepare(body_stepper)
    for object_stepper in object_steppers:
        object_stepper.actuate(0.0)
    if plan.integrator == "explicit":
        return
    for body_stepper in body_steppers:
        body_stepper.linearize()
    bases = [body_stepper.world_body.base_velocity() for body_stepper in body_steppers]
    velocities = [world_object.velocity()[0] for world_object in world.objects]
    object_rates = [world_object.principal_rate() for world_object in world.objects]
    rates = [body_stepper.law.rates.copy() for body_stepper in body_steppers]
    forces = _trial_forces(plan, world, body_steppers, rates)
    # objects have velocities at half steps, too: half of what the trial step added is taken back
    halved = [
        _half_step_before(before, world_object.velocity()[0])
        for before, world_object in zip(velocities, world.objects, strict=True)
    ]
    half_step_rates = _object_rates_half_step_before(plan, world, object_rates)
    for world_object in world.objects:
        world_object.reset()
    if plan.integrator == "implicit":
        _set_half_step_velocities(plan, world, body_steppers, forces, bases)
        for world_object, velocity, rate in zip(
            world.objects, halved, half_step_rates, strict=True
        ):
            world_object.reset(velocity, rate)
    for body_stepper, force, before in zip(body_steppers, forces, rates, strict=True):
        body_stepper.set_start_force(force, before)


def _trial_forces(
    plan: Plan, world: World, body_steppers: Sequence[BodyStepper], rates: Sequence[Array]
) -> list[Array]:
    """Return the force on the joints of each body in a step without torques; undo the step."""
    forces = []
    for body_stepper in body_steppers:
        body_stepper.world_body.apply([0.0] * len(body_stepper.law.rates))
    world.step()
    for body_stepper, before in zip(body_steppers, rates, strict=True):
        body_stepper.read_state()
        forces.append(body_stepper.mass @ (body_stepper.law.rates - before) / plan.time_step)
        body_stepper.reset_to_start()
    return forces


def _prepare(body_stepper: BodyStepper) -> None:
    """Read the state of a body at its start, and set what acts on it there."""
    body_stepper.read_state()
    body_stepper.inertia.refresh()
    _check_joint_inertia(body_stepper.body, body_stepper.mass)
    body_stepper.mass_at_start = body_stepper.mass
    body_stepper.actuate(0.0)


def _object_rates_half_step_before(
    plan: Plan, world: World, rates: Sequence[Vector]
) -> list[Vector | None]:
    """Return the angular velocity of each object half a step before the start, along its axes.

    None for objects without gyroscopic torque, whose angular velocity stays.
    """
    return [
        rate_half_step_before(
            world_object.principal_moments, rate, world_object.principal_rate(), plan.time_step
        )
        if planned.has_gyroscopic_torque
        else None
        for planned, world_object, rate in zip(plan.objects, world.objects, rates, strict=True)
    ]


def _check_joint_inertia(body: Body, mass: Array) -> None:
    """Raise EngineRefused for a body with a joint that the engine would silently hold."""
    try:
        inertia = articulated_inertia(mass)
    except np.linalg.LinAlgError:
        raise EngineRefused(
            body.name, "its masses differ too much: their inertia is not positive definite"
        ) from None
    least = int(np.argmin(inertia))
    if inertia[least] < MIN_JOINT_INERTIA:
        raise EngineRefused(
            body.name,
            f"joint '{body.chain.joints[least].name}' moves {inertia[least]:.2g} engine units of "
            f"inertia, and less than {MIN_JOINT_INERTIA:g} does not move at all; the mass factor "
            "of world_scale changes no result, so choose a larger one",
        )


def _set_half_step_velocities(
    plan: Plan,
    world: World,
    body_steppers: Sequence[BodyStepper],
    forces: Sequence[Array],
    bases: Sequence[tuple[Vector, Vector]],
) -> None:
    accelerations = []
    for body_stepper, force in zip(body_steppers, forces, strict=True):
        acceleration = body_stepper.law.acceleration(body_stepper.mass, force)
        torques = body_stepper.mass @ acceleration - force
        body_stepper.base.apply(torques.tolist())
        accelerations.append(acceleration)
    world.step()
    for body_stepper, acceleration, base in zip(body_steppers, accelerations, bases, strict=True):
        after = body_stepper.world_body.base_velocity()
        body_stepper.read_state()
        rates_after = body_stepper.law.rates.copy()
        rates = np.array(body_stepper.body.start.rates) - 0.5 * plan.time_step * acceleration
        body_stepper.reset_to_start(rates.tolist(), after)
        velocity = body_stepper.base.velocity_half_step_before(
            body_stepper.law, base, after, rates_after
        )
        body_stepper.reset_to_start(rates.tolist(), velocity)


def _half_step_before(before: Vector, after: Vector) -> Vector:
    return (
        1.5 * before[0] - 0.5 * after[0],
        1.5 * before[1] - 0.5 * after[1],
        1.5 * before[2] - 0.5 * after[2],
    )
