"""What is unphysical at the end of a run, seen from outside the monitors of a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from somo_cli import loading
from somo_cli.api import runs
from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.run import RunSummary
from tests.trust.scenes import RandomScene

DEEP = 0.2  # of an object's thickness, at the end: what is pressed by springs alone is not as deep
FASTER = 2.0  # than at a quarter of the step, and by as many m/s as a finger's tip is fast
TIP_SPEED = 1.0  # m/s
LARGE_STEP = 1e-3  # s: a run at a larger step is held against one at a quarter of it


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended, what it found, and what is unphysical about it."""

    name: str
    time_step: float
    end: str
    codes: tuple[str, ...] = ()
    unphysical: tuple[str, ...] = ()

    @property
    def is_silent(self) -> bool:
        """Whether something is unphysical and a script is not told."""
        return bool(self.unphysical) and not self.codes and self.end == "done"


def outcome(scene: RandomScene) -> Outcome:
    """Run a scene, at a large step also at a quarter of it, and judge it."""
    try:
        prepared, summary, rows = _run(scene, 1)
    except SimulationDiverged:
        return Outcome(scene.name, scene.time_step, "diverged")
    codes = tuple(dict.fromkeys(one.code for one in summary.findings))
    finer = None
    if scene.time_step >= LARGE_STEP:
        try:
            finer = _run(scene, 4)[2]
        except SimulationDiverged:
            finer = None
    unphysical = tuple(_unphysical(prepared, rows, finer))
    return Outcome(scene.name, scene.time_step, "done", codes, unphysical)


def _run(scene: RandomScene, divisor: int) -> tuple[runs.PreparedRun, RunSummary, Array]:
    document = scene.document(divisor)
    found, warnings = loading.scene_of(document, every=10 * divisor)
    prepared = runs.prepare(document, found, warnings)
    blocks: list[Array] = []
    with runs.OpenRun(prepared.plan) as opened:
        steps = round(scene.duration / scene.time_step) * divisor
        summary = opened.run(steps, blocks.append)
    return prepared, summary, np.concatenate(blocks)


def _unphysical(prepared: runs.PreparedRun, rows: Array, finer: Array | None) -> Iterator[str]:
    plan, names = prepared.plan, prepared.names
    for planned in plan.objects:
        name = planned.rigid_object.name
        link = planned.rigid_object.chain.links[0]
        thickness = min(shape.solid.smallest_extent for shape in link.shapes) / plan.scale.length
        if rows[-1, names.index(f"{name}.pose.z_m")] < DEEP * thickness:
            yield f"{name} is in the ground"
        moves = [names.index(f"{name}.velocity.{axis}_m_per_s") for axis in "xyz"]
        fastest = float(np.linalg.norm(rows[:, moves], axis=1).max())
        if finer is not None:
            right = float(np.linalg.norm(finer[:, moves], axis=1).max())
            if fastest > FASTER * right + TIP_SPEED:
                yield f"{name} moves at {fastest:.1f} m/s, at a quarter of the step at {right:.1f}"
