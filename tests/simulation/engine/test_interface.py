"""The protocols name all that a run uses of an engine, so another one could stand behind them."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES, Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import run
from tests.builders.guarded_world import Guarded, GuardedWorld, Use, all_members
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

pytest.importorskip("pybullet")

STEPS = 60
FINGER: dict[str, Any] = {
    "definition": "finger.yaml",
    "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 0], [0.05, 0.05]]}],
    "loads": [{"link": "tip", "force": [0.01, 0, 0.02], "waypoints": [[0, 0], [0.02, 1]]}],
}
BAR: dict[str, Any] = {
    "name": "bar",
    "shape_type": "box",
    "dimensions": [0.1, 0.04, 0.02],
    "mass": 0.02,
}
SHIFT = {"translation": [[0, 0, 0, 0], [0.03, 0, 0, 0.01]]}
EVERYTHING = {
    "every": 7,
    "columns": list(ALL_QUANTITIES),
    "objects": list(ALL_OBJECT_QUANTITIES),
}


def scene(**more: Any) -> Scene:
    data = {"manipulators": [FINGER], "record": EVERYTHING, **more}
    return scene_from_text(json.dumps(data))


def on_ground(integrator: str, time_step: float = 1e-3) -> Scene:
    """A body held, one that falls on a bar, two moved; objects that spin, are moved, stay."""
    moved = {**FINGER, "base": "constrained"}
    return scene(
        integrator=integrator,
        time_step=time_step,
        ground={"friction": 0.5},
        manipulators=[
            {**FINGER, "name": "held"},
            {**FINGER, "name": "free", "base": "free", "position": [0.5, 0, 0.021]},
            {**moved, "name": "moved", "position": [1, 0, 0.2], "motion": SHIFT},
            {**moved, "name": "clamped", "position": [1.5, 0, 0.2]},
        ],
        objects=[
            {**BAR, "position": [0.5, 0, 0.01]},
            {**BAR, "name": "spins", "position": [0, 1, 0.5], "angular_velocity": [9, 1, 20]},
            {**BAR, "name": "led", "position": [0, 1.5, 0.5], "motion": SHIFT},
            {**BAR, "name": "stays", "position": [0, 2, 0.5], "fixed": True},
        ],
        stop=[
            {"object": "bar", "leaves": {"x": [0, 1]}},
            {"at_rest": {"for": 0.001, "after": 5}},
        ],
    )  # fmt: skip


def used(plan: Plan, steps: int = STEPS) -> tuple[np.ndarray, set[Use]]:
    """Run a plan behind the protocols; return its rows and what was used."""
    blocks: list[np.ndarray] = []
    events: list[object] = []
    with BulletWorld(plan) as world:
        guarded = GuardedWorld(plan, world)
        guarded.claim_engine()
        run(plan, cast(World, guarded), blocks.append, steps, lambda: 0.0, on_event=events.append)
    return np.concatenate(blocks), guarded.uses


KINDS: dict[str, Callable[[], Scene]] = {
    "alone": scene,
    "turning in the air": lambda: scene(
        manipulators=[{**FINGER, "base": "free", "angular_velocity": [30, 5, 8]}], gravity=[0, 0, 0]
    ),
    "implicit": lambda: on_ground("implicit"),
    "euler": lambda: on_ground("euler"),
    "explicit": lambda: on_ground("explicit", 2e-5),
    "a cube between two fingers": lambda: scene_from_file("lift_scene.yaml"),
    "a free body that presses": lambda: scene_from_file("starfish_scene.yaml"),
    "friction by direction": lambda: scene_from_file("snake_scene.yaml"),
}


@pytest.mark.parametrize("kind", list(KINDS))
def test_a_run_needs_no_more_than_the_protocols_and_is_the_same(kind: str) -> None:
    plan = make_plan(KINDS[kind]())
    rows, _ = used(plan)
    assert np.array_equal(rows, np.array(rows_of(plan, STEPS)))


def test_the_protocols_ask_for_nothing_that_no_run_needs() -> None:
    uses = set[Use]().union(*(used(make_plan(one()))[1] for one in KINDS.values()))
    assert all_members() - uses == set()


def test_what_a_protocol_does_not_name_is_refused() -> None:
    plan = make_plan(scene())
    with BulletWorld(plan) as world:
        guarded = GuardedWorld(plan, world)
        with pytest.raises(AssertionError, match="World has no 'engine'"):
            _ = guarded.engine
        body: Guarded = guarded.bodies[0]
        with pytest.raises(AssertionError, match="WorldBody has no 'base_response'"):
            _ = body.base_response
        with pytest.raises(TypeError, match="unexpected keyword"):
            body.reset([0.0] * 10, [0.0] * 10, is_quiet=True)
