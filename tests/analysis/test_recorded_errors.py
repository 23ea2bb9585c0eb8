"""Studies of scenes with contact and objects: forces, poses, events and the choice of a step."""

from __future__ import annotations

import csv
import io
import json

import pytest

from somo_cli.analysis import study_export, study_report
from somo_cli.analysis.choice import cheapest, is_judged_by_recorded
from somo_cli.analysis.common_instants import common_instants
from somo_cli.analysis.recorded_report import outcome_remarks, recorded_table
from somo_cli.analysis.study import study
from somo_cli.analysis.study_model import Study, StudySettings
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from tests.builders.scenes import scene_from_file

pytestmark = pytest.mark.slow

STEPS = (4e-3, 2e-3, 1e-3)  # s


def study_of(scene: Scene, duration: float) -> Study:
    settings = StudySettings(STEPS, ("implicit",), (None,), common_instants(STEPS, duration), 1)
    times = iter(range(100))
    return study(scene, settings, BulletWorld, lambda: float(next(times) ** 2), lambda done: None)


@pytest.fixture(scope="module")
def pushed() -> Study:
    """A cube that falls by a millimetre beside a finger, whose tip is all but right at 4 ms."""
    return study_of(scene_from_file("push_scene.yaml"), 0.3)


def test_a_cube_that_falls_is_told_beside_a_tip_that_is_right(pushed: Study) -> None:
    coarse, middle, fine = pushed.cases
    tip = coarse.errors["tip_position"]
    assert tip is not None
    assert tip.maximum < 1e-5
    assert coarse.recorded is not None
    assert coarse.recorded.worst is not None
    assert coarse.recorded.worst.name.startswith("cube.")
    assert coarse.recorded.relative > 0.5
    assert fine.recorded is not None
    assert middle.recorded is not None
    sizes = [one.recorded.of_object("cube", "m") for one in pushed.cases if one.recorded]
    assert sizes == sorted(sizes, reverse=True)


def test_the_impulse_of_a_pair_over_the_time_is_the_weight_that_it_bears(pushed: Study) -> None:
    (discretization,) = pushed.discretizations
    assert discretization.recorded is not None
    mass = pushed.scene.objects[0].chain.links[0].inertial.mass
    forces = discretization.recorded.forces
    assert set(forces) == {("finger", "cube"), ("finger", "ground"), ("cube", "ground")}
    assert forces["finger", "cube"] == 0
    # momentum: what is borne over the time is the weight, less the fall at the start
    assert forces["cube", "ground"] == pytest.approx(9.81 * mass, rel=2e-3)
    assert discretization.recorded.events == 1
    assert outcome_remarks(pushed) == []


def test_the_step_is_chosen_by_the_worst_of_what_is_recorded(pushed: Study) -> None:
    assert is_judged_by_recorded(pushed)
    best = cheapest(pushed, 0.2)
    assert best is not None
    assert best.case.time_step == 1e-3
    sentence = study_report.recommendation(pushed, 0.2)
    assert sentence.startswith(
        "for 20 % error of all that is recorded use implicit, dt = 0.001 s: "
    )
    assert sentence.endswith("(worst: cube.pose.z_m)")
    assert study_report.recommendation(pushed, 1e-3).startswith(
        "no case has 0.1 % error of all that is recorded: the best is implicit, dt = 0.001 s"
    )


def test_what_the_scene_does_not_record_does_not_choose() -> None:
    scene = scene_from_file("push_scene.yaml", "record={only: [finger.tip.*]}")
    found = study_of(scene, 0.3)
    best = cheapest(found, 0.01)
    assert best is not None
    assert best.case.time_step == 4e-3


def test_tables_and_files_tell_contact_and_objects(pushed: Study) -> None:
    head, *rows, last = recorded_table(pushed).splitlines()
    assert head.split("  ")[0] == "joints"
    for name in ("events", "cube [m]", "cube [rad]", "cube-ground [N]", "worst, of its range"):
        assert name in head
    assert "finger-cube" not in head  # they do not press on each other in this time
    assert len(rows) == 3
    assert last.split()[1] == "reference"
    table = list(csv.DictReader(io.StringIO(study_export.csv_text(pushed))))
    assert [row["contact_events"] for row in table] == ["1", "1", "1"]
    assert table[0]["worst_column"] == "cube.pose.z_m"
    assert float(table[0]["cube-ground_mean_normal_n"]) > 0
    assert not any(name.startswith("contact_") and name.endswith("_max_n") for name in table[0])
    data = json.loads(json.dumps(study_export.plain_data(pushed, 0.01), allow_nan=False))
    assert data["is_judged_by_recorded"]
    columns = data["cases"][0]["recorded"]["columns"]
    assert columns["cube.pose.z_m"]["judged_by"] == "largest"


def test_free_motion_is_judged_by_its_tip_as_before() -> None:
    found = study_of(scene_from_file("scene.yaml"), 0.1)
    assert recorded_table(found) == ""
    assert not is_judged_by_recorded(found)
    assert "contact_events" not in study_export.csv_text(found)


def test_steps_at_which_an_object_topples_are_told_with_both_outcomes() -> None:
    """A bar that is kicked topples at 8 ms and stands at smaller steps; the finger is elsewhere."""
    bar = (
        "objects=[{name: bar, shape_type: box, density: 1000, dimensions: [0.02, 0.02, 0.06], "
        "position: [0.5, 0, 0.03], friction: 0.8, angular_velocity: [0, 16.8, 0]}]"
    )
    scene = scene_from_file("push_scene.yaml", bar, "ground={friction: 0.8}")
    steps = (8e-3, 4e-3, 2e-3)
    settings = StudySettings(steps, ("implicit",), (None,), common_instants(steps, 1.2), 1)
    found = study(scene, settings, BulletWorld, lambda: 0.0, lambda done: None)
    (sentence,) = outcome_remarks(found)
    assert sentence.startswith("implicit: two outcomes: bar.pose.x_m ends at ")
    assert " at 0.008 s and at 498 mm at 0.004, 0.002 and 0.00025 s" in sentence
    assert sentence in study_report.remarks(found, 0.01)
