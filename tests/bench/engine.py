"""What the engine can be set to do or to leave out, and what that makes of its step.

Run by `make bench`. Each case is timed in turn with the product's own, round after round, on the
engine's steps alone: those of the finger of forty joints, swinging, and those of the hand and its
cube within our loop. Printed are medians of the ratios to the product's, taken round by round.
"""

from __future__ import annotations

import argparse
import dataclasses
import statistics
import time
from collections.abc import Callable, Mapping
from typing import TypeAlias

from somo_cli.manipulator.urdf import render_for_engine
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.model import Plan
from tests.bench import hand
from tests.bench.stepping import finger_plan, swing

STEPS = 1000
JOINTS = 40

Setting: TypeAlias = Callable[[BulletWorld], None]
Case: TypeAlias = Callable[[], float]
"""Returns the time of the engine's steps [s]."""


def engine_parameters(**parameters: float) -> Setting:
    """Return a setting of the engine's parameters."""

    def set_parameters(world: BulletWorld) -> None:
        world.engine.setPhysicsEngineParameter(**parameters)

    return set_parameters


def feeling(world: BulletWorld) -> None:
    """Have the engine work out the reaction forces of every joint."""
    for body in world.bodies:
        for link in body.links[1:]:
            world.engine.enableJointForceTorqueSensor(body.index, link, True)


HAND: Mapping[str, Setting] = {
    "reaction forces of joints": feeling,
    "solver islands of 1024 bodies": engine_parameters(minimumSolverIslandSize=1024),
    "contact breaking threshold / 10": engine_parameters(contactBreakingThreshold=0.002),
    "friction without a cone": engine_parameters(enableConeFriction=0),
    "separating axes of boxes": engine_parameters(enableSAT=1),
    "pairs in a fixed order": engine_parameters(deterministicOverlappingPairs=1),
    "200 iterations in every step": engine_parameters(solverResidualThreshold=0),
    "50 iterations, the default": engine_parameters(
        numSolverIterations=50, solverResidualThreshold=1e-7
    ),
}


def with_limits(plan: Plan) -> Plan:
    """Return the plan of a finger whose limits the engine knows."""
    bodies = (
        dataclasses.replace(
            body, urdf=render_for_engine(body.chain, with_collisions=False), has_engine_limits=True
        )
        for body in plan.bodies
    )
    return dataclasses.replace(plan, bodies=tuple(bodies))


def with_motors(plan: Plan) -> Plan:
    """Return the plan with motors that do nothing, as a run that keeps everything has them."""
    bodies = (dataclasses.replace(body, has_zero_torque_motors=True) for body in plan.bodies)
    return dataclasses.replace(plan, bodies=tuple(bodies))


def swinging(plan: Plan, setting: Setting) -> Case:
    """Return the case of a finger that swings without gravity."""

    def case() -> float:
        with BulletWorld(dataclasses.replace(plan, gravity=(0.0, 0.0, 0.0))) as world:
            setting(world)
            swing(world.bodies[0])
            started = time.process_time()
            for _ in range(STEPS):
                world.step()
            return time.process_time() - started

    return case


def grasping(plan: Plan, setting: Setting) -> Case:
    """Return the case of the hand in our loop."""

    def case() -> float:
        with BulletWorld(plan) as world, hand.timed_engine(world) as total:
            setting(world)
            stepping.run(plan, world, lambda values: None, STEPS, time.perf_counter)
        return total[0]

    return case


def compare(name: str, own: Case, cases: Mapping[str, Case], rounds: int) -> None:
    """Print what the cases take, over what the product's own does."""
    found: dict[str, list[float]] = {case: [] for case in ("as it is, once more", *cases)}
    times = []
    for _ in range(rounds):
        times.append(own())
        for case, run in {"as it is, once more": own, **cases}.items():
            found[case].append(run() / times[-1])
    print(f"\n{name}: {statistics.median(times) / STEPS * 1e6:.1f} us a step as it is")
    for case, ratios in found.items():
        print(f"  {statistics.median(ratios):5.2f}  {case}")


def main() -> None:
    """Print the tables."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=7)
    rounds = arguments.parse_args().rounds
    finger = finger_plan(JOINTS)
    cases = {
        "pairs of links without shapes": swinging(
            dataclasses.replace(finger, keeps_unused=True), engine_parameters()
        ),
        "joint limits in the engine": swinging(with_limits(finger), engine_parameters()),
        "reaction forces of joints": swinging(finger, feeling),
        "joint motors of no account": swinging(with_motors(finger), engine_parameters()),
    }
    compare(f"finger of {JOINTS} joints", swinging(finger, engine_parameters()), cases, rounds)
    plan = hand.plan_of_hand()
    hands = {name: grasping(plan, setting) for name, setting in HAND.items()}
    hands["joint motors of no account"] = grasping(with_motors(plan), engine_parameters())
    compare("hand and cube", grasping(plan, engine_parameters()), hands, rounds)


if __name__ == "__main__":
    main()
