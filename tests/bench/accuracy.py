"""Error of the joint angles against the time step: the shipped finger, and MuJoCo as the truth.

Run by `make bench`. The finger, fixed and under gravity, is bent from rest for one second; the
error is the largest of any joint at any tenth of a second, against MuJoCo's RK4 with steps of
1e-5 s on the same chain. The time is that of our stepping loop, the median of several runs.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
import statistics
import time

import numpy as np

from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.mujoco_reference import mujoco_model, mujoco_trajectory
from tests.builders.scenes import scene_from_text

STEPS = (5e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
MOTIONS = {
    "slow: 0.03 N·m about both axes over half a second": "waypoints: [[0, 0], [0.5, 0.03]], "
    "interpolation: cubic",
    "fast: 0.05 N·m about both axes at once": "torque: 0.05",
}


def driven_finger(torque: str) -> Scene:
    """Return the finger driven about both axes."""
    return scene_from_text(
        "manipulators:\n  - definition: finger.yaml\n    actuation:\n"
        f"      - {{actuator: 0, axis: 0, {torque}}}\n"
        f"      - {{actuator: 0, axis: 1, {torque}}}\n"
        "record: {columns: [joint_angles]}\n"
    )


def driven_finger_in_mujoco(scene: Scene) -> np.ndarray:
    """Return the angles every tenth of a second, shape (10, n)."""
    chain = scene.manipulators[0].compiled.chain
    si = make_plan(dataclasses.replace(scene, scale=type(scene.scale)()))
    signals = {joint: drive.signal for drive in si.bodies[0].drives for joint in drive.joints}

    def torques(time: float) -> list[float]:
        return [signals[index].at(time) for index in range(len(chain.joints))]

    times = [0.1 * index for index in range(1, 11)]
    return mujoco_trajectory(mujoco_model(chain, scene.gravity, 1e-5), torques, times)


def measured(scene: Scene, repeats: int) -> tuple[np.ndarray, float]:
    """Return the angles every tenth of a second and the time of the loop [s]."""
    times = []
    for _ in range(repeats):
        blocks: list[Array] = []
        plan = make_plan(scene)
        with BulletWorld(plan) as world:
            steps = round(1 / scene.time_step)
            summary = run.run(plan, world, blocks.append, steps, time.perf_counter)
        times.append(summary.wall_time)
    return np.concatenate(blocks)[1:, 1:], statistics.median(times)


def main() -> None:
    """Print a table for each motion."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--repeats", type=int, default=5)
    options = arguments.parse_args()
    for title, torque in MOTIONS.items():
        scene = driven_finger(torque)
        truth = driven_finger_in_mujoco(scene)
        print(f"\n{title}\nintegrator  step [s]  error [rad]  order  time [ms]  x real time")
        for integrator in ("implicit", "euler", "explicit"):
            last, last_step = math.nan, math.nan
            for step in STEPS:
                one = dataclasses.replace(
                    scene, integrator=integrator, time_step=step, every=round(0.1 / step)
                )
                try:
                    angles, seconds = measured(one, options.repeats)
                except SimulationDiverged:
                    print(f"{integrator:10s} {step:9g}  diverged")
                    continue
                error = float(np.abs(angles - truth).max())
                order = math.log(last / error) / math.log(last_step / step)
                print(
                    f"{integrator:10s} {step:9g}  {error:11.2e}  {order:5.2f}"
                    f"  {1e3 * seconds:9.1f}  {1 / seconds:11.0f}"
                )
                last, last_step = error, step


if __name__ == "__main__":
    main()
