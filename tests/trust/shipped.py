"""Shipped scenes in which bodies can touch, with what their runs find."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation.plan.build import make_plan
from tests.builders.runs import simulated
from tests.builders.scenes import DEFINITIONS, scene_from_file

NAMES = tuple(sorted(path.name for path in DEFINITIONS.glob("*scene.yaml")))


def shipped_findings(seconds: float, names: Sequence[str] = NAMES) -> list[str]:
    """Return "scene: code" for every finding of the scenes in so many seconds."""
    found = []
    for name in names:
        plan = make_plan(scene_from_file(name))
        if plan.can_touch:
            _, summary = simulated(plan, round(seconds / plan.time_step))
            found += [f"{name}: {one.code}" for one in summary.findings]
    return found
