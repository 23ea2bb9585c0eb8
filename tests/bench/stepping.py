"""Time of one step: ours against the bare engine and the classic loop, on the same body.

Run by `make bench`. The three are timed in turn, round after round, so that a machine whose
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
from somo_cli.simulation.bullet import BulletBody, BulletWorld
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


def microseconds_of_classic(plan: Plan) -> float:
    """Time the per-joint loop that users write, with the engine's joint motors left on.

    The motors hold a force that damps every joint, so the loop stays stable however stiff the
    springs are, which favours it.
    """
    with BulletWorld(plan) as world:
        body: BulletBody = world.bodies[0]
        bullet, client, index = body._bullet, body._client, body.index
        joints = plan.bodies[0].chain.joints
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
    print("joints  bare [us]  ours [us]  classic [us]  ours/bare  classic/ours  ours [steps/s]")
    for joints in options.joints:
        plan = plan_of(joints)
        bare, ours, classic = [], [], []
        for _ in range(options.rounds):
            bare.append(microseconds_of_bare(plan))
            ours.append(microseconds_of_ours(plan))
            classic.append(microseconds_of_classic(plan))
        median = statistics.median
        ours_to_bare = median(a / b for a, b in zip(ours, bare, strict=True))
        classic_to_ours = median(a / b for a, b in zip(classic, ours, strict=True))
        print(
            f"{joints:6d} {median(bare):10.1f} {median(ours):10.1f} {median(classic):13.1f}"
            f" {ours_to_bare:10.2f} {classic_to_ours:13.1f} {1e6 / median(ours):15.0f}"
        )


if __name__ == "__main__":
    main()
