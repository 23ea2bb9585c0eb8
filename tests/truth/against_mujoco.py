"""Run time for equal error: ours, MuJoCo's integrators and the loop that users write in PyBullet.

On the ten-joint finger, no contact.

Run by `make truth`, or alone. Error is the largest of any joint angle at any tenth of a second,
against MuJoCo's RK4 with steps of 1e-5 s. Run times are those of the stepping loops alone, taken
in turn, round after round, in one process; given are medians. Ours is all of our loop; MuJoCo
steps many steps a call in C where the torque is constant, and otherwise one step a call from
Python with the torques set before it, which is how a user would drive it. The classic loop reads
and drives joint by joint; it has the same springs and dampers and no other friction, since joint
motors would be a model of their own, so it is explicit and of first order.
"""

from __future__ import annotations

import argparse
import dataclasses
import itertools
import math
import statistics
import time
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from somo_cli.analysis.recorded_run import median_run_time, record_rows
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.bench.accuracy import MOTIONS, driven_finger, driven_finger_in_mujoco
from tests.builders.mujoco_reference import mujoco_model

TENTH = 0.1  # s between two samples
TARGETS = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5)  # rad
STEPS = (2e-2, 1.25e-2, 1e-2, 5e-3, 2.5e-3, 1.25e-3, 6.25e-4, 3.125e-4, 1.5625e-4)  # s, ours
FINER = (2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5)  # s, MuJoCo's
CLASSIC = (3.125e-4, 1.5625e-4, 6.25e-5, 2e-5, 1e-5, 5e-6)  # s, of the loop that users write
PEERS = ("implicitfast", "implicit", "discrete", "RK4")  # the last is explicit


@dataclasses.dataclass(frozen=True)
class Point:
    """A step [s], its error [rad] and the median time of its loop [s]."""

    step: float
    error: float
    time: float


Loop = Callable[[], tuple[np.ndarray, float]]
"""Simulates one second and returns the angles every tenth of a second, and the loop's time."""


def our_loop(scene: Scene, step: float) -> Loop:
    """Return our stepping loop, timed in a run of its own, in which nothing is recorded."""
    count = round(1 / step)
    scene = dataclasses.replace(scene, time_step=step, every=round(TENTH / step))
    plan = make_plan(scene)

    def loop() -> tuple[np.ndarray, float]:
        angles = record_rows(plan, count, BulletWorld)[1:, 1:]
        return angles, median_run_time(plan, count, BulletWorld, time.perf_counter, 1)

    return loop


def their_loop(scene: Scene, step: float, name: str) -> Loop:
    """Return MuJoCo's stepping loop with one of its integrators."""
    chain = scene.manipulators[0].compiled.chain
    model = mujoco_model(chain, scene.gravity, step)
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{name.upper()}")
    si = make_plan(dataclasses.replace(scene, scale=type(scene.scale)()))
    drives = [(np.array(drive.joints), drive.signal) for drive in si.bodies[0].drives]
    is_constant = all(drive.signal.constant_until(0.0) == math.inf for drive in si.bodies[0].drives)
    every = round(TENTH / step)

    def loop() -> tuple[np.ndarray, float]:
        state = mujoco.MjData(model)
        applied, do_step = state.qfrc_applied, mujoco.mj_step
        rows, number = [], 0
        started = time.perf_counter()
        for _ in range(10):
            if is_constant:
                for joints, signal in drives:
                    applied[joints] = signal.at(0.0)
                do_step(model, state, every)
            else:
                for _ in range(every):
                    for joints, signal in drives:
                        applied[joints] = signal.at((number + 0.5) * step)
                    do_step(model, state)
                    number += 1
            rows.append(state.qpos.copy())
        return np.array(rows), time.perf_counter() - started

    return loop


def classic_loop(scene: Scene, step: float) -> Loop:
    """Return the loop that users write in PyBullet, on our set-up of the body."""
    count, every = round(1 / step), round(TENTH / step)
    plan = make_plan(dataclasses.replace(scene, time_step=step))
    joints = plan.bodies[0].chain.joints
    signals = {joint: drive.signal for drive in plan.bodies[0].drives for joint in drive.joints}

    def loop() -> tuple[np.ndarray, float]:
        rows = []
        with BulletWorld(plan) as world:
            body, bullet, client = world.bodies[0].index, world.engine.module, world.engine.number
            numbers = range(len(joints))
            started = time.perf_counter()
            for done in range(count):
                for number, spring in enumerate(joints):
                    angle, rate, _, _ = bullet.getJointState(body, number, client)
                    torque = -spring.stiffness * (angle - spring.neutral_position)
                    torque += signals[number].at(done * step) - spring.damping * rate
                    bullet.setJointMotorControl2(
                        body, number, bullet.TORQUE_CONTROL, force=torque, physicsClientId=client
                    )
                world.step()
                if (done + 1) % every == 0:
                    rows.append([bullet.getJointState(body, n, client)[0] for n in numbers])
            taken = time.perf_counter() - started
        return np.array(rows), taken

    return loop


def measured(loops: dict[float, Loop], truth: np.ndarray, rounds: int) -> list[Point]:
    """Return a point for each step whose run did not diverge, large steps first."""
    times: dict[float, list[float]] = {step: [] for step in loops}
    errors: dict[float, float] = {}
    for _ in range(rounds):
        for step, loop in loops.items():
            try:
                angles, taken = loop()
            except SimulationDiverged:
                continue
            times[step].append(taken)
            errors[step] = float(np.abs(angles - truth).max())
    return [
        Point(step, errors[step], statistics.median(times[step]))
        for step in loops
        if step in errors and math.isfinite(errors[step]) and errors[step] < 1
    ]


def time_for(points: Sequence[Point], target: float) -> float:
    """Return the time [s] that an error takes, between two points by powers; else not a number.

    A larger step than the largest that was tried is not counted on.
    """
    ordered = sorted(points, key=lambda point: -point.step)
    if ordered and ordered[0].error <= target:
        return ordered[0].time
    for before, after in itertools.pairwise(ordered):
        if before.error > target >= after.error:
            share = math.log(before.error / target) / math.log(before.error / after.error)
            return before.time * (after.time / before.time) ** share
    return math.nan


def main(arguments: Sequence[str] | None = None) -> None:
    """Print, for each motion, every point, and run time against error."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args(arguments)
    # it says at length what the table leaves out: steps at which it is unstable
    mujoco.set_mju_user_warning(lambda message: None)
    peers = [name for name in PEERS if hasattr(mujoco.mjtIntegrator, f"mjINT_{name.upper()}")]
    for title, torque in MOTIONS.items():
        scene = driven_finger(torque)
        truth = driven_finger_in_mujoco(scene)
        print(f"\n{title}\n  {'':14} {'step [s]':>9} {'error [rad]':>12} {'time [ms]':>10}")
        curves = {
            "somo implicit": measured(
                {step: our_loop(scene, step) for step in STEPS}, truth, options.rounds
            )
        }
        for name in peers:
            loops = {step: their_loop(scene, step, name) for step in FINER}
            curves[name] = measured(loops, truth, options.rounds)
        curves["classic"] = measured(
            {step: classic_loop(scene, step) for step in CLASSIC}, truth, 1
        )
        others = (*peers, "classic")
        for name, points in curves.items():
            for point in points:
                print(f"  {name:14} {point.step:9g} {point.error:12.2e} {1e3 * point.time:10.2f}")
        print(f"\n  {'error [rad]':>12} {'somo [ms]':>10}" + "".join(f"{n:>26}" for n in others))
        for target in TARGETS:
            ours = time_for(curves["somo implicit"], target)
            cells = ""
            for name in others:
                theirs = time_for(curves[name], target)
                ratio = f"{1e3 * theirs:.2f} ms, {theirs / ours:6.2f}x"
                cells += f"{'not reached' if math.isnan(theirs) else ratio:>26}"
            print(f"  {target:12g} {1e3 * ours:10.2f}{cells}")


if __name__ == "__main__":
    main()
