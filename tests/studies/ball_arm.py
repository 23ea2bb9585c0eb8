"""The arm that plays with a ball: where it takes it, how fast that is computed, and what steps do.

Ours and the loop that users write are timed one after the other on one core; then the path of the
ball and of the arm's tip are compared over steps and world scales.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.bench.classic import classic_loop
from tests.bench.hand import timed_engine
from tests.builders.scenes import scene_from_file
from tests.studies.running import Record, Setting, recorded_all

SCENE = "ball_arm_scene.yaml"
SECONDS = 30.0
GOAL = -2.5  # m: the ball is in behind this
CLASSIC_FRICTION = 1.0  # N m: of the joints of SoMo's arm, which has no dampers
STEPS = (2e-3, 1e-3, 5e-4)  # s
SCALES = (1, 4)  # at the first of the steps; the scene's is 2


def setting(step: float, scale: float = 2) -> Setting:
    """Return the scene at a step [s] and a world scale."""
    return Setting(SCENE, SECONDS, (f"world_scale={scale}",), step)


def positions(record: Record, of: str = "ball.pose") -> Array:
    """Return where the ball, or the arm's tip, is in each row, shape (rows, 3) [m]."""
    return np.transpose([record[f"{of}.{axis}_m"] for axis in "xyz"])


def is_in(record: Record) -> bool:
    """Whether the ball ends behind the goal line, on the ground."""
    x, _, z = positions(record)[-1]
    return bool(x < GOAL and abs(z - 0.495) < 0.01)


def apart(record: Record, other: Record, of: str) -> tuple[float, float]:
    """Return the distance of two runs: the largest, and that at the end [m]."""
    distances = np.linalg.norm(positions(record, of) - positions(other, of), axis=1)
    return float(distances.max()), float(distances[-1])


def table_of_runs(records: Sequence[tuple[str, Record]], reference: Record) -> Sequence[str]:
    """Return a line for each run: where the ball ends, and how far it is from the reference."""
    lines = [
        "run, ball at the end [m], in; from the last step at most and at the end [m]: ball, tip"
    ]
    for name, record in records:
        end = "".join(f"{value:8.3f}" for value in positions(record)[-1])
        far = (*apart(record, reference, "ball.pose"), *apart(record, reference, "ball_arm.tip"))
        distances = "".join(f"{value:8.3f}" for value in far)
        lines.append(f"{name:18}{end}  {'in' if is_in(record) else 'out':4}{distances}")
    return lines


def timed(step: float, seconds: float = SECONDS) -> tuple[float, float]:
    """Return the wall time of our loop, and the engine's part of it [s]."""
    plan = make_plan(dataclasses.replace(scene_from_file(SCENE), time_step=step))
    steps = round(seconds / step)
    with BulletWorld(plan) as world, timed_engine(world) as total:
        summary = stepping.run(plan, world, lambda row: None, steps, time.perf_counter)
    return summary.wall_time, total[0]


def classic(seconds: float = SECONDS) -> tuple[float, Array]:
    """Return the wall time [s] of the loop that users write, and where its ball ends [m]."""
    plan = make_plan(scene_from_file(SCENE))
    ball: list[float] = []

    def record_ball(world: BulletWorld) -> None:
        ball[:] = world.objects[0].pose().position

    friction = CLASSIC_FRICTION * plan.scale.length**2 * plan.scale.mass
    return classic_loop(plan, seconds, friction, record_ball), np.array(ball) / plan.scale.length


def speeds() -> Iterator[str]:
    """Yield how fast both loops are, one after the other on one core."""
    theirs, ball = classic()
    yield f"{SECONDS:g} s: step, wall time, times real time, the engine's share, over the usual"
    end = ", ".join(f"{value:.2f}" for value in ball)
    yield f"usual loop, 1 ms: {theirs:5.1f} s, {SECONDS / theirs:5.2f}; its ball ends at {end} m"
    for step in STEPS[:2]:
        wall, engine = timed(step)
        yield (
            f"ours, {1e3 * step:g} ms: {wall:5.1f} s, {SECONDS / wall:5.2f},"
            f" {100 * engine / wall:3.0f} %, {theirs / wall:5.2f} times as fast"
        )


def study(pictures: Path | None) -> None:
    """Print speeds and ends; draw the path of the ball and of the tip."""
    print(*speeds(), sep="\n", flush=True)
    # the longest first, so that two cores are busy to the end
    settings = {f"{1e3 * step:g} ms": setting(step) for step in reversed(STEPS)}
    settings |= {f"2 ms, scale {scale}": setting(STEPS[0], scale) for scale in SCALES}
    records = dict(zip(settings, recorded_all(list(settings.values())), strict=True))
    print(*table_of_runs(list(records.items()), records["0.5 ms"]), sep="\n", flush=True)
    if pictures is not None:
        from tests.studies.ball_arm_picture import draw

        draw({name: records[name] for name in ("0.5 ms", "2 ms")}, pictures / "ball_arm.png")
