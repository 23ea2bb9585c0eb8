"""The loop that users of PyBullet write for a soft arm, as SoMo does: for comparison.

In every step it reads and drives the joints one by one, springs and torques explicitly, with the
engine's motors as dry friction in the joints and its solver left at its defaults.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.model import Plan

ITERATIONS, RESIDUAL = 50, 1e-7  # the engine's defaults


def leave_at_defaults(world: BulletWorld, friction: float) -> None:
    """Have solver and joint motors as the engine has them, with this friction [engine units]."""
    bullet, client = world.engine.module, world.engine.number
    bullet.setPhysicsEngineParameter(
        numSolverIterations=ITERATIONS, solverResidualThreshold=RESIDUAL, physicsClientId=client
    )
    for body in world.bodies:
        for joint in body.links[1:]:
            bullet.setJointMotorControl2(
                body.index, joint, bullet.VELOCITY_CONTROL, force=friction, physicsClientId=client
            )


def classic_loop(
    plan: Plan, seconds: float, friction: float, after_step: Callable[[BulletWorld], object]
) -> float:
    """Run the loop for so long [s], and return its wall time [s].

    `friction` is that of every joint [engine units], in place of its damper; `after_step` is called
    after each tenth of a second.
    """
    steps, every = round(seconds / plan.time_step), round(0.1 / plan.time_step)
    with BulletWorld(plan) as world:
        leave_at_defaults(world, friction)
        spent = 0.0
        for step in range(steps):
            started = time.perf_counter()
            _drive(plan, world, step * plan.time_step)
            world.step()
            spent += time.perf_counter() - started
            if (step + 1) % every == 0:
                after_step(world)
        return spent


def _drive(plan: Plan, world: BulletWorld, now: float) -> None:
    bullet, client = world.engine.module, world.engine.number
    for body, planned in zip(world.bodies, plan.bodies, strict=True):
        values = {(one.actuator, one.axis): one.signal.at(now) for one in planned.drives}
        for number, joint in enumerate(planned.chain.joints):
            angle = bullet.getJointState(body.index, number, client)[0]
            torque = values.get((joint.actuator, joint.channel), 0.0)
            bullet.setJointMotorControl2(
                body.index,
                number,
                bullet.TORQUE_CONTROL,
                force=torque - joint.stiffness * (angle - joint.neutral_position),
                physicsClientId=client,
            )
