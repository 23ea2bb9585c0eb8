"""Time of a hand: four fingers turn a cube on a palm, ours against the classic loop.

Run by `make bench`. As in SoMo's in-hand scene, fingers stand around a palm, tilted outwards, and a
cube of 60 mm and 10 g lies on it; waves bend the fingers inwards and sideways. The loops are timed
in turn, round after round; printed are medians, and the medians of ratios taken round by round. The
classic loop takes steps of 1 ms, as SoMo's users do. How far the cube gets from where it is with
steps of 0.1 ms shows which steps are short enough for ours; that of 0.2 ms, how sensitive it is.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import math
import pstats
import statistics
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from somo_cli.scene import columns
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.row_assembler import RowWriter
from tests.bench.classic import leave_at_defaults
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

SECONDS = 1.0  # simulated
CLASSIC = 1e-3  # s
OURS = (1e-3, 2e-3, 4e-3, 5e-3)  # s
FINE = (2e-4, 1e-4)  # s
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


def plan_of_hand(time_step: float = CLASSIC) -> Plan:
    """Return the plan of the scene, recorded every tenth of a second."""
    palm = {"name": "palm", "shape_type": "cylinder", "dimensions": [0.05, 0.02], "fixed": True}
    palm |= {"position": [0, 0, PALM - 0.025], "friction": 0.15}
    cube = {"name": "cube", "shape_type": "box", "dimensions": [0.06] * 3, "mass": 0.01}
    cube |= {"position": [0, 0, PALM + 0.03], "friction": 1.2}
    data = {
        "time_step": time_step,
        "manipulators": [finger(number) for number in range(4)],
        "objects": [palm, cube],
        "record": {
            "every": round(0.1 / time_step),
            "columns": ["joint_angles"],
            "objects": ["pose"],
        },
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


def ours(plan: Plan, write: RowWriter) -> tuple[float, float]:
    """Return the time of a step [us], all of it, recording included; and the engine's part of it.

    The part is of a run of its own, since taking it costs time, too.
    """
    steps = round(SECONDS / plan.time_step)
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, write, steps, time.perf_counter)
    with BulletWorld(plan) as world, timed_engine(world) as total:
        stepping.run(plan, world, write, steps, time.perf_counter)
    return summary.wall_time / steps * 1e6, total[0] / steps * 1e6


def way_of_cube(time_step: float) -> np.ndarray:
    """Return where the cube is at every tenth of a second, shape (rows, 3) [m]; ours."""
    plan = plan_of_hand(time_step)
    rows = rows_of(plan, round(SECONDS / time_step))
    first = columns.header(plan.recorded).index("cube.pose.x_m")
    return np.array(rows)[:, first : first + 3]


def classic(plan: Plan) -> tuple[float, float]:
    """Return the time of a step [us] of the loop that users write, as SoMo does; the engine's part.

    Per finger and step two passes over all joints, one for each axis, each of which reads and
    drives joint by joint (torques add up within a step, so each brings half of the springs); the
    engine's joint motors, solver and iterations are left at their defaults.
    """
    with BulletWorld(plan) as world, timed_engine(world) as total:
        bullet, client = world.engine.module, world.engine.number
        leave_at_defaults(world, friction=1.0)
        steps = round(SECONDS / plan.time_step)
        started = time.perf_counter()
        for step in range(steps):
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
        return (time.perf_counter() - started) / steps * 1e6, total[0] / steps * 1e6


def profiled(plan: Plan) -> Iterable[str]:
    """Yield where our loop spends its time, as shares of the whole, largest first."""
    profile = cProfile.Profile()
    with BulletWorld(plan) as world:
        profile.enable()
        stepping.run(
            plan, world, lambda values: None, round(SECONDS / plan.time_step), time.perf_counter
        )
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
    if options.profile:
        print("share of time within our loop; small functions seem larger than they are")
        print(*profiled(plan_of_hand()), sep="\n")
        return
    plans = {f"ours, {1e3 * step:g} ms": plan_of_hand(step) for step in OURS}
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in (*plans, "classic")}
    for _ in range(options.rounds):
        for name, plan in plans.items():
            found[name].append(ours(plan, lambda values: None))
        found["classic"].append(classic(plan_of_hand()))
    path = way_of_cube(min(FINE))
    off = {step: 1e3 * float(np.abs(way_of_cube(step) - path).max()) for step in (*OURS, *FINE)}
    print(
        "four fingers of ten joints, a cube and a palm; cube: how far from its path at 0.1 ms [mm]"
    )
    print("                us/step  engine  x real time  classic / ours    cube")
    steps = dict(zip(found, (*OURS, CLASSIC), strict=True))
    for name, rounds in found.items():
        whole, engine = (statistics.median(one[part] for one in rounds) for part in (0, 1))
        step = steps[name]
        speed = 1e6 * step / whole
        ratio = statistics.median(
            (theirs[0] / CLASSIC) / (own[0] / step)
            for own, theirs in zip(rounds, found["classic"], strict=True)
        )
        cube = f"{off[step]:8.2f}" if name != "classic" else ""
        print(f"{name:14}{whole:9.0f}{engine:8.0f}{speed:13.1f}{ratio:16.1f}{cube}")
    print(f"at 0.2 ms the cube gets {off[max(FINE)]:.2f} mm from its path at 0.1 ms")


if __name__ == "__main__":
    main()
