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
from pathlib import Path

from somo_cli import cli
from somo_cli.simulation import run as stepping
from somo_cli.simulation.bullet import BulletBody, BulletWorld
from somo_cli.simulation.plan import Plan, make_plan

DEFINITIONS = Path(__file__).parents[2] / "definitions"
STEPS = 1000


def plan_of(joints: int) -> Plan:
    """Return the plan of the bench: the finger, fixed, bent slowly about both axes."""
    document = cli._load(
        str(DEFINITIONS / "scene.yaml"),
        [
            f"manipulators[0].definition.actuator_definitions[0].n_segments={joints}",
            # equal shape and bending stiffness: shorter, lighter links and stiffer joints
            "manipulators[0].definition.actuator_definitions[0].link_definition.dimensions[2]="
            f"{0.1 / joints}",
            "manipulators[0].definition.actuator_definitions[0].link_definition.mass="
            f"{0.0294 / joints}",
        ],
        True,
    )
    return make_plan(dataclasses.replace(cli._scene(document, 100, 1e-3)))


def microseconds_of_ours(plan: Plan) -> float:
    """Time our loop, all of it, recording included."""
    rows: list[Iterable[float]] = []
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, rows.append, STEPS, time.perf_counter)
    return summary.wall_time / STEPS * 1e6


def microseconds_of_bare(plan: Plan) -> float:
    """Time the engine alone, the body falling over."""
    with BulletWorld(plan) as world:
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
