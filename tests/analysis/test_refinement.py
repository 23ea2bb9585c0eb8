"""The run that halves its step until it is known well enough."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from contextlib import ExitStack

import numpy as np
import pytest

from somo_cli.analysis.refinement import Refinement, Refiner
from somo_cli.analysis.refinement_report import refinement_lines, verdict
from somo_cli.analysis.spooled_run import LevelRunner
from somo_cli.analysis.tolerances import Tolerances
from somo_cli.files import temporary_file
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

SWING = scene_from_file(
    "scene.yaml", "manipulators[0].initial_rates=2", "time_step=0.01", "record={every: 5}"
)
EXPLICIT = scene_from_file("scene.yaml", "integrator=explicit", "record={every: 25}")


def refined(
    scene: Scene, steps: int, share: float, max_halvings: int = 6
) -> tuple[Refinement, np.ndarray]:
    """Return what a refinement found, and the rows of its finest run."""
    blocks: list[np.ndarray] = []
    with ExitStack() as stack:
        runner = LevelRunner(BulletWorld, ticking(), temporary_file)
        plan = make_plan(scene)
        found = Refiner(plan, steps, Tolerances(share), runner, stack, max_halvings).refine()
        found.rows.write_to(blocks.append)
    return found, np.concatenate(blocks)


def ticking() -> Callable[[], float]:
    """Return a clock on which every run takes a second."""
    ticks = iter(range(1000))
    return lambda: float(next(ticks))


def test_the_finest_run_is_that_of_its_step_with_rows_at_the_same_instants() -> None:
    found, rows = refined(SWING, 40, 1e-3)
    factor = 2**found.halvings
    assert found.halvings >= 2
    assert found.plan.time_step == pytest.approx(0.01 / factor)
    same = dataclasses.replace(SWING, time_step=found.plan.time_step, every=5 * factor)
    assert rows.tolist() == rows_of(same, 40 * factor)
    assert rows[:, 0].tolist() == [row[0] for row in rows_of(SWING, 40)]
    assert [level.time_step for level in found.levels] == pytest.approx(
        [0.02 / 2**halvings for halvings in range(found.halvings + 2)]
    )
    assert found.run_time == found.levels[-1].run_time * len(found.levels)


@pytest.mark.moderate
@pytest.mark.parametrize("share", [3e-2, 1e-3])
def test_the_true_error_is_within_the_tolerance(share: float) -> None:
    found, rows = refined(SWING, 40, share)
    assert found.is_converged
    fine = dataclasses.replace(SWING, time_step=0.01 / 512, every=5 * 512)
    truth = np.array(rows_of(fine, 40 * 512))
    true = np.abs(rows - truth)[:, 1:].max(axis=0)
    told = np.array([error.judged for error in found.errors])
    scale = np.array([error.scale for error in found.errors])
    assert (true / scale).max() < 1.2 * share
    assert 0.7 < told.max() / true.max() < 4
    # the run before is not within, else it would have been the last
    assert found.levels[-2].excess > 1 or found.halvings == 1


def test_a_bound_on_halvings_ends_with_the_columns_that_are_not_known() -> None:
    found, _ = refined(SWING, 40, 1e-6, max_halvings=2)
    assert not found.is_converged
    assert found.halvings == 2
    line = verdict(found)
    assert line.startswith("NOT converged after 2 halvings of the step, at 0.0025 s: finger.")
    assert line.endswith("more columns; what is written is the finest run")
    assert "worst columns" in "\n".join(refinement_lines(found))


def test_a_coarse_run_that_diverges_is_left_out() -> None:
    found, _ = refined(EXPLICIT, 200, 1e-2)
    status = [level.status for level in found.levels]
    first = status.index("ok")
    assert first >= 2
    assert status == ["diverged"] * first + ["ok"] * (len(status) - first)
    assert found.is_converged
    assert "diverged" in refinement_lines(found)[1]


def test_a_finest_run_that_diverges_is_divergence() -> None:
    with pytest.raises(SimulationDiverged):
        refined(EXPLICIT, 200, 1e-2, max_halvings=1)


def test_a_run_of_which_only_the_start_is_recorded_is_not_converged() -> None:
    found, _ = refined(SWING, 4, 0.5, max_halvings=1)
    assert not found.is_converged
    assert verdict(found).startswith("NOT judged after 1 halving")


def test_a_run_that_stops_is_compared_up_to_its_end() -> None:
    stop = [{"time": 0.203}]
    scene = scene_from_file(
        "scene.yaml",
        "manipulators[0].initial_rates=2",
        "time_step=0.007",
        "record={every: 5}",
        f"stop={stop}".replace("'", '"'),
    )
    found, rows = refined(scene, 400, 1e-3)
    assert found.is_converged
    assert rows[-1, 0] == pytest.approx(0.203, abs=0.007)


def kicked_bar(time_step: float, spin: float) -> Scene:
    """Return a bar that stands on end and is kicked [rad/s]: it rocks and stands, or topples.

    It topples from 16.74 rad/s on at 8 ms, 17.49 at 4 ms, and 17.64 at all smaller steps.
    """
    return scene_from_text(
        "ground: {friction: 0.8}\nobjects: [{name: bar, shape_type: box, density: 1000, "
        "dimensions: [0.02, 0.02, 0.06], position: [0, 0, 0.03], friction: 0.8, "
        f"angular_velocity: [0, {spin}, 0]}}]\ntime_step: {time_step}\n"
        f"record: {{every: {round(0.04 / time_step)}}}\n"
    )


def test_an_outcome_that_only_two_runs_have_is_confirmed_by_a_third() -> None:
    """At 8 ms the bar topples, at 4 and 2 ms it stands: one halving might be as wrong."""
    found, rows = refined(kicked_bar(4e-3, 16.8), 300, 0.25)
    assert found.is_converged
    assert [level.time_step for level in found.levels] == pytest.approx([8e-3, 4e-3, 2e-3, 1e-3])
    assert found.outcomes is not None
    assert [len(one.steps) for one in found.outcomes.outcomes] == [1, 3]
    assert rows[-1, 3] == pytest.approx(0.03, abs=1e-3)  # the height of a bar that stands
    line = verdict(found)
    assert line.startswith("converged to ")
    assert ", but two outcomes: bar.pose." in line
    once, _ = refined(kicked_bar(4e-3, 16.8), 300, 0.25, max_halvings=1)
    assert once.agrees
    assert not once.is_converged
    assert "the last two runs agree to" in verdict(once)


def test_a_bar_that_topples_at_coarse_steps_alone_is_told_with_both_outcomes() -> None:
    found, rows = refined(kicked_bar(4e-3, 17.57), 300, 0.2)
    assert found.outcomes is not None
    toppled, standing = found.outcomes.outcomes
    assert toppled.steps == pytest.approx((8e-3, 4e-3))
    assert len(standing.steps) >= 3
    assert found.is_converged
    assert rows[-1, 3] == pytest.approx(0.03, abs=1e-3)


def test_a_tolerance_of_other_columns_does_not_ask_for_an_outcome() -> None:
    with ExitStack() as stack:
        runner = LevelRunner(BulletWorld, ticking(), temporary_file)
        plan = make_plan(kicked_bar(4e-3, 16.8))
        asked = Tolerances(None, (("bar.pose.y_m", 1e-3),))
        found = Refiner(plan, 300, asked, runner, stack).refine()
    assert found.is_converged
    assert found.outcomes is None
    assert found.halvings == 1
