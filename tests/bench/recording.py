"""What rows cost: a finger of ten joints, with 64 columns and with 5, recorded every so many steps.

Run by `make bench`. The runs are timed in turn, round after round, and the ratios to the run
that records nothing are taken round by round; printed are their medians, and what of it is the
decimals alone. Times are the processor's; the CSV is a real file. Then what a number costs as
decimals, and the peak memory of a whole command that records every step, by their number.
"""

from __future__ import annotations

import argparse
import dataclasses
import io
import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import TextIO

import numpy as np

from somo_cli.arrays import Array
from somo_cli.scene import columns
from somo_cli.scene.model import Quantity
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording import shortest_float
from somo_cli.simulation.recording.csv_writer import CsvWriter
from somo_cli.simulation.run import run
from tests.bench.stepping import finger_plan
from tests.builders.scenes import DEFINITIONS

STEPS = 4000
RECORDED: tuple[Quantity, ...] = (
    "joint_angles",
    "joint_rates",
    "spring_torques",
    "link_positions",
)
EVERY = (1, 3, 10, 100)
CLOCK = time.process_time


def seconds_of(plan: Plan, stream: TextIO) -> float:
    """Time the stepping loop, the CSV included."""
    stream.seek(0)
    stream.truncate()
    with BulletWorld(plan) as world:
        started = CLOCK()
        recorder = CsvWriter(stream, columns.header(plan.recorded))
        run(plan, world, recorder.write, STEPS, CLOCK)
        return CLOCK() - started


def seconds_of_decimals(plan: Plan) -> float:
    """Time the decimals of all rows of a plan, as the recorder makes them, and nothing else."""
    blocks: list[Array] = []
    with BulletWorld(plan) as world:
        run(plan, world, blocks.append, STEPS, CLOCK)
    nowhere = CsvWriter(io.StringIO(), columns.header(plan.recorded))
    started = CLOCK()
    for block in blocks:
        nowhere.write(block)
    return CLOCK() - started


def print_decimals(rounds: int) -> None:
    """Print what a number costs as decimals, at once with many others and by `repr`."""
    numbers = np.random.default_rng(1).normal(size=(64, 64))
    ours, theirs = [], []
    for _ in range(100 * rounds):
        started = CLOCK()
        shortest_float.lines(numbers)
        between = CLOCK()
        "".join(",".join(map(repr, row)) + "\n" for row in numbers.tolist())
        ours.append(between - started)
        theirs.append(CLOCK() - between)
    many, one = (1e9 * statistics.median(times) / numbers.size for times in (ours, theirs))
    print(f"a number as decimals: {many:.0f} ns among 4096, {one:.0f} ns by repr, {one / many:.1f}")


def megabytes_of_run(steps: int) -> float:
    """Return the peak memory of `somo run` that records every step."""
    scene, here = str(DEFINITIONS / "planar_finger_scene.yaml"), str(DEFINITIONS.parent)
    command = [sys.executable, "-m", "somo_cli", "run", scene, "--steps", str(steps), "-q"]
    process = subprocess.Popen(
        [*command, "--every", "1", "-o", os.devnull], env=os.environ | {"PYTHONPATH": here}
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    return used.ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)


def print_overheads(rounds: int) -> None:
    """Print what recording adds to the time of a run."""
    whole = dataclasses.replace(finger_plan(10), columns=RECORDED)
    picked = dataclasses.replace(whole, only=("*.tip.*", "*_01.angle_rad"))
    picked = dataclasses.replace(picked, columns=(*RECORDED, "tip_position"))
    bare = dataclasses.replace(whole, columns=(), every=STEPS)
    plans = {
        f"{len(columns.header(plan.recorded))} columns every {every:3} steps": dataclasses.replace(
            plan, every=every
        )
        for plan in (whole, picked)
        for every in EVERY
    }
    plans["the time alone every   1 steps"] = dataclasses.replace(bare, every=1)
    ratios: dict[str, list[float]] = {}
    shares: dict[str, list[float]] = {}
    with tempfile.TemporaryFile("w", encoding="utf-8", newline="\n") as stream:
        for _ in range(rounds):
            nothing = seconds_of(bare, stream)
            for name, plan in plans.items():
                ratios.setdefault(name, []).append(seconds_of(plan, stream) / nothing)
                shares.setdefault(name, []).append(seconds_of_decimals(plan) / nothing)
    for name, found in ratios.items():
        more, share = statistics.median(found) - 1, statistics.median(shares[name])
        print(f"{name:>30}: {more:+5.0%} run time, decimals {share:+4.0%}")


def main() -> None:
    """Print what recording costs in time and in memory."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=7)
    arguments.add_argument("--steps", type=int, nargs="*", default=[10_000, 1_000_000])
    options = arguments.parse_args()
    print_overheads(options.rounds)
    print_decimals(options.rounds)
    for steps in options.steps:
        print(f"peak memory of {steps} steps, each recorded: {megabytes_of_run(steps):.1f} MB")


if __name__ == "__main__":
    main()
