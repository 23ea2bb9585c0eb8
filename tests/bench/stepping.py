"""Time of one step: ours against the bare engine and the classic loop, on the same body.

Run by `make bench`. They are timed in turn, round after round, so that a machine whose
speed drifts does not favour one; printed are medians over the rounds, and the medians of the
ratios taken round by round. Every loop starts from rest and bends the finger by the same torque
over half a second; ours records every 100th step.
"""

from __future__ import annotations

import argparse
import dataclasses
import statistics
import time
from collections.abc import Iterable

from somo_cli.simulation import run as stepping
from somo_cli.simulation.bullet import BulletWorld
from somo_cli.simulation.bullet_body import BulletBody
from somo_cli.simulation.plan import Plan, make_plan
from tests.loading import scene_from_file

STEPS = 1000


def plan_of(joints: int) -> Plan:
    """Return the plan of the bench: the shipped scene, the finger cut into so many joints.

    Shape, mass and bending stiffness of the whole stay the same.
    """
    definition = "manipulators[0].definition.actuator_definitions[0]"
    actuator = scene_from_file("scene.yaml").manipulators[0].compiled.definition.actuators[0]
    share = actuator.n_segments / joints
    sets = [
        f"{definition}.n_segments={joints}",
        f"{definition}.link_definition.dimensions[2]={actuator.link.height * share}",
        f"{definition}.link_definition.mass={actuator.link.mass * share}",
    ]
    for index, joint in enumerate(actuator.joints[:2]):
        place = f"{definition}.joint_definitions[{index}]"
        sets.append(f"{place}.spring_stiffness={joint.stiffness / share}")
        sets.append(f"{place}.spring_damping={joint.damping / share}")
    scene = scene_from_file("scene.yaml", *sets)
    return make_plan(dataclasses.replace(scene, every=100, time_step=1e-3))


def microseconds_of_ours(plan: Plan) -> float:
    """Time our loop, all of it, recording included."""
    rows: list[Iterable[float]] = []
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, rows.append, STEPS, time.perf_counter)
    return summary.wall_time / STEPS * 1e6


def microseconds_of_bare(plan: Plan) -> float:
    """Time the engine alone, the body at rest without gravity: falling, it would hit its limits."""
    with BulletWorld(dataclasses.replace(plan, gravity=(0.0, 0.0, 0.0))) as world:
        started = time.perf_counter()
        for _ in range(STEPS):
            world.step()
        return (time.perf_counter() - started) / STEPS * 1e6


def microseconds_of_calls(plan: Plan) -> float:
    """Time the engine with the two calls that no loop in Python can do without, nothing else."""
    with BulletWorld(dataclasses.replace(plan, gravity=(0.0, 0.0, 0.0))) as world:
        body = world.bodies[0]
        torques = [0.0] * len(plan.bodies[0].chain.joints)
        started = time.perf_counter()
        for _ in range(STEPS):
            body.apply(torques)
            world.step()
            body.joint_states()
        return (time.perf_counter() - started) / STEPS * 1e6


def microseconds_of_classic(plan: Plan) -> float:
    """Time the per-joint loop that users write, with the engine's joint motors left on.

    The motors hold a force that damps every joint, so the loop stays stable however stiff the
    springs are, which favours it.
    """
    with BulletWorld(plan) as world:
        body: BulletBody = world.bodies[0]
        bullet, client, index = body._bullet, body._client, body.index
        joints = plan.bodies[0].chain.joints
        bullet.setPhysicsEngineParameter(  # the engine's defaults, as users have them
            numSolverIterations=50, solverResidualThreshold=1e-7, physicsClientId=client
        )
        for joint in range(len(joints)):
            bullet.setJointMotorControl2(
                index, joint, bullet.VELOCITY_CONTROL, force=1.0, physicsClientId=client
            )
        started = time.perf_counter()
        for _ in range(STEPS):
            for joint, spring in enumerate(joints):
                angle = bullet.getJointState(index, joint, client)[0]
                torque = -spring.stiffness * (angle - spring.neutral_position)
                bullet.setJointMotorControl2(
                    index, joint, bullet.TORQUE_CONTROL, force=torque, physicsClientId=client
                )
            world.step()
        return (time.perf_counter() - started) / STEPS * 1e6


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--joints", type=int, nargs="*", default=[10, 40])
    arguments.add_argument("--rounds", type=int, default=15)
    options = arguments.parse_args()
    print(f"{STEPS} steps of 1 ms, medians of {options.rounds} rounds, recording every 100th step")
    print("calls: bare + reading all joints + writing all torques, the floor of a loop in Python\n")
    print(
        "joints    bare   calls    ours  classic [us]  calls/bare  ours/bare  classic/ours  steps/s"
    )
    loops = (
        microseconds_of_bare,
        microseconds_of_calls,
        microseconds_of_ours,
        microseconds_of_classic,
    )
    for joints in options.joints:
        plan = plan_of(joints)
        rounds = [[loop(plan) for loop in loops] for _ in range(options.rounds)]
        bare, calls, ours, classic = (
            statistics.median(times) for times in zip(*rounds, strict=True)
        )
        calls_to_bare = statistics.median(calls / bare for bare, calls, _, _ in rounds)
        ours_to_bare = statistics.median(ours / bare for bare, _, ours, _ in rounds)
        classic_to_ours = statistics.median(classic / ours for _, _, ours, classic in rounds)
        print(
            f"{joints:6d} {bare:7.1f} {calls:7.1f} {ours:7.1f} {classic:13.1f}"
            f" {calls_to_bare:11.2f} {ours_to_bare:10.2f} {classic_to_ours:13.1f} {1e6 / ours:8.0f}"
        )


if __name__ == "__main__":
    main()
