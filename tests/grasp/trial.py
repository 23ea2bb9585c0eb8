"""One run of a grasp, and how it differs from the converged one."""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass
from functools import cache

import numpy as np

from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.grasp.cases import END, RADIUS, Grasp

FINE = 2e-4  # s: the step of the converged run
QUIET = 0.3  # s, at the end: while nothing moves
ALIKE = 0.9  # of a limit
MOST_SHAKING = 2e-3  # of the mean force
MOST_GRIP = 1e-2  # of the converged force
MOST_OFF = 1e-2  # of the object's size


@dataclass(frozen=True, slots=True)
class Held:
    """How an object is held in the end: force [N], its deviation [N], place [m]; time of a step."""

    force: float
    deviation: float
    place: Array
    seconds_per_step: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """A run against the converged one: shaking, grip and place, each relative; infinite if lost."""

    shaking: float
    grip: float
    place: float

    @property
    def is_good(self) -> bool:
        """Whether all three are small."""
        return self.shaking < MOST_SHAKING and self.grip < MOST_GRIP and self.place < MOST_OFF


def held(grasp: Grasp, step: float) -> Held | None:
    """Run a grasp, and return how the object is held in the end, None if the run diverged."""
    return held_in(grasp.scene(step), "object", END)


def held_in(scene: Scene, name: str, end: float) -> Held | None:
    """Run a scene that records an object, and return how it is held at the end [s].

    None if the run diverged.
    """
    plan = make_plan(scene)
    blocks: list[Array] = []
    try:
        with BulletWorld(plan) as world:
            summary = run.run(
                plan,
                world,
                lambda block: blocks.append(block.copy()),
                round(end / scene.time_step),
                time.process_time,  # other processes do not count
            )
    except SimulationDiverged:
        return None
    table = dict(zip(columns.header(plan.recorded), np.concatenate(blocks).T, strict=True))
    quiet = table["time_s"] > end - QUIET
    force = table[f"{name}.contact.normal_n"][quiet]
    place = np.array([table[f"{name}.pose.{axis}_m"][-1] for axis in "xyz"])
    return Held(float(force.mean()), float(force.std()), place, summary.wall_time / summary.steps)


@cache
def converged(grasp: Grasp) -> Held:
    """Return the run with a fine step; raises ValueError if even that diverges."""
    fine = held(grasp, FINE)
    if fine is None:
        raise ValueError(f"{grasp.name} diverges at {FINE} s")
    return fine


def verdict(grasp: Grasp, step: float) -> Verdict:
    """Run a grasp, and compare it with the converged run."""
    return _compared(grasp, held(grasp, step))


def why_not_counted(grasp: Grasp) -> str:
    """Return why a run that is not good says nothing about the law; empty if it does.

    Two fingers that press on a ball from both sides are in unstable balance: it rolls aside, when
    and to which side rounding decides. Where an object slips on its way its place depends on the
    history of friction. Both are so with a fine step as well.
    """
    fine = converged(grasp)
    if fine.deviation > ALIKE * MOST_SHAKING * fine.force:
        return f"with a fine step it swings as well, by {fine.deviation / fine.force:.1e}"
    finer = _compared(grasp, held(grasp, FINE / 2))
    if finer.is_good:
        return ""
    return f"not determined: two fine steps are apart by {finer.grip:.1e} and {finer.place:.1e}"


def _compared(grasp: Grasp, found: Held | None) -> Verdict:
    fine = converged(grasp)
    if grasp.has_mirror_images:
        fine = _on_one_side(fine)
        found = None if found is None else _on_one_side(found)
    return compared(fine, found, 2 * RADIUS)


def _on_one_side(one: Held) -> Held:
    return dataclasses.replace(one, place=np.abs(one.place))


def compared(fine: Held, coarse: Held | None, size: float) -> Verdict:
    """Compare a run with the converged one; `size` is that of the object [m]."""
    if coarse is None:
        return Verdict(math.inf, math.inf, math.inf)
    return Verdict(
        coarse.deviation / max(coarse.force, 1e-9),
        abs(coarse.force / max(fine.force, 1e-9) - 1),
        float(np.linalg.norm(coarse.place - fine.place)) / size,
    )
