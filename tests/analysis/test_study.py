"""Studies of real scenes: measurements, refusals, recommendations, and reports."""

from __future__ import annotations

import csv
import dataclasses
import io
import itertools
import json
import math

import numpy as np
import pytest

from somo_cli.analysis import closed_form_references, study_export, study_report
from somo_cli.analysis.choice import balanced, cheapest, rated_cases
from somo_cli.analysis.common_instants import common_instants
from somo_cli.analysis.reference_scene import ReferenceMismatch
from somo_cli.analysis.study import study, total_steps
from somo_cli.analysis.study_model import Study, StudySettings
from somo_cli.manipulator.resegmentation import NotUniform
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from tests.builders.pendulum import PENDULUM
from tests.builders.scenes import scene_from_file, scene_from_text

pytestmark = pytest.mark.slow

ALL = ("implicit", "euler", "explicit")


def ticking() -> object:
    """Return a clock whose loops take one second, two, three and so on."""
    ticks = itertools.count()

    def clock() -> float:
        number, is_end = divmod(next(ticks), 2)
        return float(is_end * (number + 1))

    return clock


def study_of(
    scene: Scene,
    steps: tuple[float, ...],
    duration: float,
    integrators: tuple[str, ...] = ("implicit",),
    segments: tuple[int | None, ...] = (None,),
) -> Study:
    settings = StudySettings(steps, integrators, segments, common_instants(steps, duration), 1)  # type: ignore[arg-type]
    return study(scene, settings, BulletWorld, ticking(), lambda done: None)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def finger() -> Study:
    return study_of(scene_from_file("scene.yaml"), (8e-3, 4e-3, 2e-3), 0.4, ALL)


def test_every_case_is_there(finger: Study) -> None:
    found = [(case.integrator, case.time_step, case.status) for case in finger.cases]
    assert found == [
        (integrator, step, "diverged" if integrator == "explicit" else "ok")
        for integrator in ALL
        for step in (8e-3, 4e-3, 2e-3)
    ]
    assert [case.steps for case in finger.cases[:3]] == [50, 100, 200]
    assert all(
        "actuator_0_joint" in case.reason for case in finger.cases if case.status == "diverged"
    )


def test_errors_fall_with_the_order_of_the_integrator(finger: Study) -> None:
    orders = {(case.integrator, case.time_step): case.order for case in finger.cases}
    for step in (4e-3, 2e-3):
        assert orders["implicit", step] == pytest.approx(2, abs=0.5)
        assert orders["euler", step] == pytest.approx(1, abs=0.3)
    assert math.isnan(orders["implicit", 8e-3])


def test_the_reference_knows_its_error(finger: Study) -> None:
    """Against a reference that is finer still."""
    (cut,) = finger.discretizations
    finer = study_of(scene_from_file("scene.yaml"), (2.5e-4,), 0.4)
    apart = np.abs(cut.reference.rows - finer.discretizations[0].reference.rows)[:, 1:4].max()
    assert apart <= cut.reference.error["tip_position"] < 1e-7


def test_errors_below_that_of_the_reference_are_not_reported() -> None:
    scene = scene_from_file("scene.yaml", "record={columns: [actuation]}")
    found = study_of(scene, (2e-3, 1e-3), 0.2)
    assert all(case.errors["actuation"] is None for case in found.cases)
    assert all(case.errors["tip_position"] is not None for case in found.cases)
    (rows, *_) = list(csv.DictReader(io.StringIO(study_export.csv_text(found))))
    assert rows["actuation_max_nm"] == ""
    assert float(rows["tip_position_max_m"]) > 0


def test_the_cheapest_case_that_is_good_enough_is_chosen(finger: Study) -> None:
    best = cheapest(finger, 1e-2)
    # the clock makes every loop slower than the one before, so the first good one is cheapest
    assert best is not None
    assert (best.case.integrator, best.case.time_step) == ("implicit", 8e-3)
    assert study_report.recommendation(finger, 1e-2).startswith(
        "for 1 % tip error use implicit, dt = 0.008 s: "
    )
    assert study_report.recommendation(finger, 1e-9).startswith(
        "no case has 1e-07 % tip error: the best is implicit, dt = 0.002 s"
    )


def test_a_study_in_which_nothing_ran_says_so(finger: Study) -> None:
    failed = dataclasses.replace(finger, cases=finger.cases[-3:])
    assert rated_cases(failed) == ()
    assert study_report.recommendation(failed, 0.01).startswith("no case completed")
    assert study_report.table(failed).splitlines()[1].split() == [
        "10",
        "explicit",
        "0.008",
        "diverged",
    ]


def test_the_json_is_complete_and_has_no_nan(finger: Study) -> None:
    found = json.loads(json.dumps(study_export.plain_data(finger, 0.01), allow_nan=False))
    assert len(found["cases"]) == 9
    assert found["chosen"] == {"segments": None, "integrator": "implicit", "time_step_s": 8e-3}
    errors = found["cases"][0]["errors"]
    assert errors["tip_position"]["unit"] == "m"
    assert set(errors) == {"tip_position", "joint_angles", "energy"}
    assert errors["energy"]["max"] < 1e-2 * found["cuts"][0]["energy_exchanged_j"]


def test_progress_ends_at_the_work_that_was_announced() -> None:
    done: list[int] = []
    steps = (2e-3, 1e-3)
    settings = StudySettings(steps, ("implicit",), (None,), common_instants(steps, 0.1), 2)
    study(scene_from_file("scene.yaml"), settings, BulletWorld, lambda: 0.0, done.append)
    assert done == sorted(done)
    assert done[-1] == total_steps(settings)


def cantilever(*sets: str) -> Scene:
    return scene_from_file("cantilever_scene.yaml", *sets)


@pytest.mark.parametrize(
    ("reference", "sets"),
    [
        ("elastica", ()),
        ("cantilever_tip_load", ("manipulators[0].loads[0].force=[1e-4, 0, 0]",)),
        ("end_moment", ("manipulators[0].loads=[{moment: [0, 1.5, 0]}]",)),
        (
            "end_moment",
            (
                "manipulators[0].loads=[]",
                "manipulators[0].actuation=[{actuator: 0, axis: 0, torque: 1}]",
            ),
        ),
        ("own_weight", ("manipulators[0].loads=[]", "gravity=[3, 0, 0]")),
    ],
)  # fmt: skip
def test_a_chain_nears_its_beam_with_second_order(reference: str, sets: tuple[str, ...]) -> None:
    """One step is enough: at rest its error is that of rounding."""
    scene = cantilever(*sets, f"reference={reference}")
    found = study_of(scene, (2e-2,), 16.0, segments=(5, 10, 20))
    assert found.model == reference
    errors = [cut.model.maximum if cut.model else math.nan for cut in found.discretizations]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2, abs=0.1), errors
    assert found.model_error < 0.05 * errors[-1]
    (first, *_) = balanced(found)
    assert first.case.segments == 5
    assert first.model is not None
    assert first.solver < first.model


def test_an_arm_at_rest_too_early_says_how_much_it_moves() -> None:
    found = study_of(cantilever("reference=elastica"), (2e-2,), 1.0)
    assert found.model_error > 1e-2
    assert found.discretizations[0].model is None


def test_without_a_closed_form_three_numbers_of_segments_give_the_limit() -> None:
    found = study_of(cantilever(), (2e-2,), 1.0, segments=(5, 10, 20))
    assert found.model == "the limit of many segments"
    errors = [cut.model.maximum if cut.model else math.nan for cut in found.discretizations]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2, abs=0.1)
    assert study_of(cantilever(), (2e-2,), 0.2, segments=(5, 10)).model == ""


def test_a_scene_without_uniform_segments_is_refused() -> None:
    sets = "manipulators[0].loads=[{link: actuator_0_segment_03, force: [1, 0, 0]}]"
    with pytest.raises(
        NotUniform, match="'cantilever' cannot be divided into 5 segments: a load acts on"
    ):
        study_of(cantilever(sets), (2e-2,), 0.2, segments=(5,))


SPRINGLESS = PENDULUM.replace(
    "spring_stiffness: 50, spring_damping: 0.5", "spring_stiffness: 0"
).replace("joint_neutral_position: 0.3", "joint_neutral_position: 0")


def pendulum() -> Scene:
    scene = scene_from_text(SPRINGLESS)
    one = dataclasses.replace(scene.manipulators[0], initial_angles=(1.5,), initial_rates=(-1.0,))
    return dataclasses.replace(scene, manipulators=(one,), reference="pendulum")


def test_a_pendulum_is_compared_with_its_closed_form() -> None:
    found = study_of(pendulum(), (8e-3, 4e-3), 2.0)
    (cut,) = found.discretizations
    assert cut.reference.kind == "pendulum"
    assert cut.reference.error["joint_angles"] < 1e-10
    assert found.cases[1].order == pytest.approx(2, abs=0.1)
    assert all(case.errors["joint_angles"] is not None for case in found.cases)


def test_an_oscillator_is_compared_with_its_closed_form() -> None:
    scene = scene_from_text(PENDULUM)
    scene = dataclasses.replace(scene, gravity=(0.0, 0.0, 0.0), reference="damped_oscillator")
    found = study_of(scene, (4e-3, 2e-3), 1.0, ("implicit", "euler", "explicit"))
    assert [case.order for case in found.cases if case.time_step == 2e-3] == pytest.approx(
        [2, 1, 1], abs=0.15
    )


@pytest.mark.parametrize(
    ("reference", "sets", "message"),
    [
        ("elastica", ("gravity=[0, 0, -9.81]",), "without weight"),
        ("elastica", ("manipulators[0].loads=[]",), "one load"),
        ("elastica", ("manipulators[0].loads[0].frame=body",), "keeps its direction"),
        ("elastica", ("manipulators[0].loads[0].force=[1, 1, 0]",), "across the beam"),
        ("elastica", ("manipulators[0].loads[0].link=actuator_0_segment_03",), "force on the tip"),
        ("elastica", ("manipulators[0].base=free",), "static base"),
        ("end_moment", (), "one moment"),
        ("own_weight", (), "own weight alone"),
        ("own_weight", ("manipulators[0].loads=[]", "gravity=[0, 0, -9]"), "gravity across"),
        ("pendulum", (), "single joint, not 10"),
        ("damped_oscillator", (), "single joint, not 10"),
    ],
)
def test_a_scene_that_the_closed_form_does_not_describe(
    reference: str, sets: tuple[str, ...], message: str
) -> None:
    with pytest.raises(ReferenceMismatch, match=message):
        closed_form_references.check_applicable(cantilever(*sets, f"reference={reference}"))
