"""Time of one step of a hand: four fingers turn a cube on a palm, ours against the classic loop.

Run by `make bench`. As in SoMo's in-hand scene, fingers stand around a palm, tilted outwards, and a
cube of 60 mm and 10 g lies on it; waves bend the fingers inwards and sideways. The loops are timed
in turn, round after round; printed are medians, and the medians of ratios taken round by round.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import math
import pstats
import statistics
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from somo_cli.simulation import run as stepping
from somo_cli.simulation.bullet import BulletWorld
from somo_cli.simulation.plan import Plan, make_plan
from tests.loading import scene_from_text

STEPS = 1000
TILT = math.radians(15)
AWAY = 0.035  # m: of a finger's base from the middle
PALM = 0.0875  # m: height of its top


def finger(number: int) -> dict[str, Any]:
    """Return one of the four fingers, which presses and shears in turn with its neighbours."""
    yaw = number * math.pi / 2
    press = {"amplitude": 0.008, "frequency": 1, "offset": -0.016, "phase": number * math.pi / 2}
    shear = {"amplitude": 0.02, "frequency": 1, "phase": (number + 1) * math.pi / 2}
    return {
        "name": f"finger_{number}",
        "definition": "finger.yaml",
        "position": [AWAY * math.sin(yaw), -AWAY * math.cos(yaw), 0],
        "rpy": [TILT, 0, yaw],
        "surface": {"friction": 1.5},
        "actuation": [
            {"actuator": 0, "axis": 0, "wave": press},
            {"actuator": 0, "axis": 1, "wave": shear},
        ],
    }


def plan_of_hand() -> Plan:
    """Return the plan of the scene, every 100th step recorded."""
    palm = {"name": "palm", "shape_type": "cylinder", "dimensions": [0.05, 0.02], "fixed": True}
    palm |= {"position": [0, 0, PALM - 0.025], "friction": 0.15}
    cube = {"name": "cube", "shape_type": "box", "dimensions": [0.06] * 3, "mass": 0.01}
    cube |= {"position": [0, 0, PALM + 0.03], "friction": 1.2}
    data = {
        "time_step": 1e-3,
        "manipulators": [finger(number) for number in range(4)],
        "objects": [palm, cube],
        "record": {"every": 100, "columns": ["joint_angles"], "objects": ["pose"]},
    }
    return make_plan(scene_from_text(json.dumps(data)))


@contextmanager
def timed_engine(world: BulletWorld) -> Iterator[list[float]]:
    """Let the world's steps add up their time [s] in the list's one number."""
    total, step = [0.0], world.step

    def timed() -> None:
        started = time.perf_counter()
        step()
        total[0] += time.perf_counter() - started

    world.step = timed
    yield total


def ours(plan: Plan, write: Callable[[Iterable[float]], None]) -> tuple[float, float]:
    """Return the time of a step [µs], all of it, recording included; and the engine's part of it.

    The part is of a run of its own, since taking it costs time, too.
    """
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, write, STEPS, time.perf_counter)
    with BulletWorld(plan) as world, timed_engine(world) as total:
        stepping.run(plan, world, write, STEPS, time.perf_counter)
    return summary.wall_time / STEPS * 1e6, total[0] / STEPS * 1e6


def classic(plan: Plan) -> tuple[float, float]:
    """Return the time of a step [µs] of the loop that users write, as SoMo does; the engine's part.

    Per finger and step two passes over all joints, one for each axis, each of which reads and
    drives joint by joint (torques add up within a step, so each brings half of the springs); the
    engine's joint motors, solver and iterations are left at their defaults.
    """
    with BulletWorld(plan) as world, timed_engine(world) as total:
        bullet, client = world._bullet, world._client
        bullet.setPhysicsEngineParameter(
            numSolverIterations=50, solverResidualThreshold=1e-7, physicsClientId=client
        )
        for body, planned in zip(world.bodies, plan.bodies, strict=True):
            for number in range(len(planned.chain.joints)):
                bullet.setJointMotorControl2(
                    body.index, number, bullet.VELOCITY_CONTROL, force=1.0, physicsClientId=client
                )
        started = time.perf_counter()
        for step in range(STEPS):
            for body, planned in zip(world.bodies, plan.bodies, strict=True):
                for drive in planned.drives:
                    value = drive.signal.at(step * plan.time_step)
                    for number, joint in enumerate(planned.chain.joints):
                        angle = bullet.getJointState(body.index, number, client)[0]
                        torque = -0.5 * joint.stiffness * (angle - joint.neutral_position)
                        if joint.channel == drive.axis:
                            torque += value
                        bullet.setJointMotorControl2(
                            body.index,
                            number,
                            bullet.TORQUE_CONTROL,
                            force=torque,
                            physicsClientId=client,
                        )
            world.step()
        return (time.perf_counter() - started) / STEPS * 1e6, total[0] / STEPS * 1e6


def profiled(plan: Plan) -> Iterable[str]:
    """Yield where our loop spends its time, as shares of the whole, largest first."""
    profile = cProfile.Profile()
    with BulletWorld(plan) as world:
        profile.enable()
        stepping.run(plan, world, lambda values: None, STEPS, time.perf_counter)
        profile.disable()
    profiles = pstats.Stats(profile).get_stats_profile().func_profiles
    rows = sorted(((one.tottime, name) for name, one in profiles.items()), reverse=True)
    total = sum(own for own, _ in rows)
    for own, name in rows[:12]:
        yield f"  {100 * own / total:5.1f} %  {name}"


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=5)
    arguments.add_argument("--profile", action="store_true", help="where our time goes, instead")
    options = arguments.parse_args()
    plan = plan_of_hand()
    if options.profile:
        print("share of time within our loop; small functions seem larger than they are")
        print(*profiled(plan), sep="\n")
        return
    rounds = [(ours(plan, lambda values: None), classic(plan)) for _ in range(options.rounds)]
    print(f"four fingers of ten joints, a cube and a palm; {STEPS} steps of 1 ms")
    for index, name in enumerate(("ours", "classic")):
        whole, engine = (statistics.median(one[index][part] for one in rounds) for part in (0, 1))
        print(f"{name:8} {whole:7.0f} us, of it the engine {engine:.0f}; {1e6 / whole:.0f} steps/s")
    ratio = statistics.median(theirs[0] / own[0] for own, theirs in rounds)
    print(f"classic / ours: {ratio:.1f}")


if __name__ == "__main__":
    main()
