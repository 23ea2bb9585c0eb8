"""The recommended step where bodies can touch: a rule, said as such."""

from __future__ import annotations

import json
import math

import pytest

from somo_cli.analysis.contact_step import LARGEST_CONTACT_STEP, contact_step
from somo_cli.analysis.stability import recommended_step
from somo_cli.simulation.plan.build import make_plan
from tests.builders.scenes import DEFINITIONS, scene_from_file, scene_from_text

SCENES = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))


@pytest.mark.parametrize("name", SCENES)
def test_no_recommended_step_of_a_shipped_scene_is_beyond_the_rule(name: str) -> None:
    plan = make_plan(scene_from_file(name))
    if plan.can_touch:
        assert contact_step(plan) == LARGEST_CONTACT_STEP
        assert recommended_step(plan)[0] <= LARGEST_CONTACT_STEP
    else:
        assert contact_step(plan) == math.inf


@pytest.mark.parametrize(
    ("stiffness", "mass", "step"),
    [(1e3, 0.3, 1e-3), (27e3, 0.3, 1e-3), (30e3, 0.3, 5e-4), (1e6, 0.01, 2e-5)],
)
def test_soft_surfaces_bound_the_step_by_their_swing(
    stiffness: float, mass: float, step: float
) -> None:
    """With a step of h, h times the root of stiffness over mass stays below 0.3, at any scale."""
    for scale in (1, 20):
        data = {
            "world_scale": scale,
            "ground": {"contact_stiffness": stiffness, "contact_damping": 10},
            "objects": [
                {
                    "name": "ball",
                    "shape_type": "sphere",
                    "dimensions": [0.05],
                    "mass": mass,
                    "position": [0, 0, 0.1],
                }
            ],
        }
        plan = make_plan(scene_from_text(json.dumps(data)))
        assert contact_step(plan) == pytest.approx(step)
        assert contact_step(plan) * math.sqrt(stiffness / mass) <= 0.3 * (1 + 1e-9)
