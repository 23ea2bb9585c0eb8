"""What rows cost: a finger of ten joints, with 64 columns and with 5, recorded every so many steps.

Run by `make bench`. The runs are timed in turn, round after round, and the ratios to the run
that records nothing are taken round by round; printed are their medians. The CSV is a real file.
"""

from __future__ import annotations

import dataclasses
import statistics
import tempfile
import time
from typing import TextIO

from somo_cli.simulation import columns
from somo_cli.simulation.bullet import BulletWorld
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.recorder import CsvRecorder
from somo_cli.simulation.run import run
from somo_cli.simulation.scene import Quantity
from tests.bench.stepping import plan_of

STEPS = 4000
ROUNDS = 7
RECORDED: tuple[Quantity, ...] = (
    "joint_angles",
    "joint_rates",
    "spring_torques",
    "link_positions",
)
EVERY = (1, 10, 100)


def seconds_of(plan: Plan, stream: TextIO) -> float:
    """Time the stepping loop, the CSV included."""
    stream.seek(0)
    stream.truncate()
    with BulletWorld(plan) as world, CsvRecorder(stream, columns.header(plan)) as recorder:
        return run(plan, world, recorder.write, STEPS, time.perf_counter).wall_time


def main() -> None:
    """Print what recording adds to the time of a run."""
    whole = dataclasses.replace(plan_of(10), columns=RECORDED)
    picked = dataclasses.replace(whole, only=("*.tip.*", "*_01.angle_rad"))
    picked = dataclasses.replace(picked, columns=(*RECORDED, "tip_position"))
    bare = dataclasses.replace(whole, columns=(), every=STEPS)
    plans = {
        (plan, every): dataclasses.replace(plan, every=every)
        for plan in (whole, picked)
        for every in EVERY
    }
    ratios: dict[tuple[str, int], list[float]] = {}
    with tempfile.TemporaryFile("w", encoding="utf-8", newline="\n") as stream:
        for _ in range(ROUNDS):
            nothing = seconds_of(bare, stream)
            for (plan, every), one in plans.items():
                name = f"{len(columns.header(plan))} columns"
                ratios.setdefault((name, every), []).append(seconds_of(one, stream) / nothing)
    for (name, every), found in ratios.items():
        print(f"{name:>11} every {every:3} steps: {statistics.median(found) - 1:+5.0%} run time")


if __name__ == "__main__":
    main()
