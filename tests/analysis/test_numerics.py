"""Every finding of `check --numerics`: what makes it, where it points, what it advises."""

from __future__ import annotations

import pytest

from somo_cli import loading
from somo_cli.analysis import stability_report
from somo_cli.analysis.numerics import NumericsReport, assess
from somo_cli.analysis.trajectory import MAX_POSES, visited_poses
from somo_cli.document.table import Table, read_table
from somo_cli.problems import InvalidFile
from somo_cli.simulation.plan.build import make_plan
from tests.builders.scenes import DEFINITIONS, scene_from_file

CUT = "manipulators[0].definition.actuator_definitions[0]"
HINGES = f"{CUT}.joint_definitions"


TWO = "manipulators: [{definition: finger.yaml}, {definition: finger.yaml, name: other}]\n"


def report_of(name: str, *sets: str) -> NumericsReport:
    return judged_text((DEFINITIONS / name).read_text("utf-8"), name, *sets)


def judged_text(text: str, name: str = "test.yaml", *sets: str) -> NumericsReport:
    document = loading.load_text(text, str(DEFINITIONS / name), sets)
    scene, _ = loading.scene_of(document)
    return assess(make_plan(scene), loading.as_scene(document), {})


def codes(known: NumericsReport) -> dict[str, str]:
    return {finding.code: finding.severity for finding in known.findings}


@pytest.mark.moderate
@pytest.mark.parametrize(
    "name",
    [
        "scene.yaml",
        "arm_scene.yaml",
        "cantilever_scene.yaml",
        "planar_finger_scene.yaml",
        "snake_scene.yaml",
        "three_axis_finger_scene.yaml",
    ],
)
def test_shipped_scenes_are_fit_to_run(name: str) -> None:
    found = codes(report_of(name))
    assert set(found.values()) <= {"info"}


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("sets", "code", "severity", "advice"),
    [
        (("integrator=explicit",), "explicit-step-too-long", "error", "time_step: 0.0002"),
        (
            ("integrator=explicit", "time_step=3.6e-4"),
            "explicit-step-near-limit",
            "warning",
            "time_step: 0.0002",
        ),
        (("integrator=euler",), "inaccurate-step", "warning", "integrator: implicit with"),
        (("time_step=0.05",), "inaccurate-step", "warning", "time_step: 0.01"),
        (("time_step=2e-3",), "unresolved-modes", "info", "below 0.002 s"),
        (
            ("manipulators[0].definition.tip_definition.mass=30",),
            "topples",
            "warning",
            "its springs stiffer",
        ),
        (
            ("manipulators[0].definition.tip_definition.mass=30",),
            "mass-ratio",
            "warning",
            "heavier than 0.03 kg",
        ),
        ((f"{HINGES}[0].joint_control_limit_force=0.001",), "friction-rows", "info", "damping"),
        ((f"{HINGES}[1].spring_stiffness=0",), "no-spring", "info", ""),
        ((f"{HINGES}[0].limits=[-0.01, 0.01, 1, 1]",), "limits-met", "info", ""),
        (
            (f"{CUT}.n_segments=110", f"{CUT}.link_definition.dimensions[2]=0.001"),
            "many-joints",
            "info",
            "",
        ),
        (("world_scale={length: 20, mass: 1e-14}",), "frozen-joint", "error", "world_scale: {"),
        (
            (
                "world_scale={length: 20, mass: 1e6}",
                "manipulators[0].definition.tip_definition.origin_offset=[0, 0, 0, 0.5, 0, 0]",
                "manipulators[0].definition.tip_definition.shape_type=box",
                "manipulators[0].definition.tip_definition.dimensions=[0.01, 0.02, 0.03]",
            ),
            "large-inertia",
            "warning",
            "mass: ",
        ),
    ],
)
def test_every_finding(sets: tuple[str, ...], code: str, severity: str, advice: str) -> None:
    found = [one for one in report_of("scene.yaml", *sets).findings if one.code == code]
    assert [one.severity for one in found] == [severity]
    assert advice in found[0].hint
    assert not found[0].message[0].isupper()
    assert not found[0].message.endswith(".")


def test_findings_point_to_what_they_are_about() -> None:
    found = report_of("scene.yaml", "integrator=explicit").findings
    (limit,) = (one.span for one in found if one.code == "explicit-step-too-long")
    assert (limit.source, limit.line) == (str(DEFINITIONS / "scene.yaml"), 6)
    found = report_of("scene.yaml", "manipulators[0].definition.tip_definition.mass=30").findings
    (heavy,) = (one.span for one in found if one.code == "mass-ratio")
    assert heavy.source == str(DEFINITIONS / "finger.yaml")


def test_small_bodies_are_found_only_where_something_can_touch() -> None:
    alone = report_of("finger.yaml", "world_scale=1")
    assert "small-for-contact" not in codes(alone)
    found = judged_text(TWO + "world_scale: 1\n").findings
    advised = [one for one in found if one.code == "small-for-contact"]
    assert len(advised) == 2
    assert advised[0].hint == "world_scale: 20"  # half a link is 5 mm
    found = judged_text(TWO + "world_scale: 20\n").findings
    assert not [one for one in found if one.code == "small-for-contact"]


def test_the_advice_for_a_frozen_joint_cures_it() -> None:
    known = report_of("scene.yaml", "world_scale={length: 20, mass: 1e-14}")
    (frozen,) = (one for one in known.findings if one.code == "frozen-joint")
    scale = frozen.hint.removesuffix(" changes no result").replace("world_scale: ", "world_scale=")
    assert "frozen-joint" not in codes(report_of("scene.yaml", scale))


def test_a_body_of_singular_inertia_is_an_error() -> None:
    known = report_of(
        "scene.yaml",
        f"{CUT}.link_definition.mass=1e-12",
        "manipulators[0].definition.tip_definition.mass=1e12",
    )
    assert codes(known)["no-inertia"] == "error"
    assert known.forecasts == ()
    assert stability_report.plain_data(known)["explicit_step_s"] is None


def test_a_body_that_nothing_moves_is_a_finding() -> None:
    known = report_of("cantilever_scene.yaml", "manipulators[0].loads=[]")
    assert codes(known)["nothing-moves"] == "info"
    assert "nothing-moves" not in codes(report_of("cantilever_scene.yaml"))


def test_the_recommended_mass_is_in_kilograms() -> None:
    heavy = "manipulators[0].definition.tip_definition.mass=30"
    known = report_of("scene.yaml", heavy, "world_scale={length: 20, mass: 1000}")
    (found,) = (one for one in known.findings if one.code == "mass-ratio")
    assert "heavier than 0.03 kg" in found.hint


def test_the_table_and_the_values_agree() -> None:
    known = report_of("scene.yaml")
    reported = stability_report.plain_data(known)
    lines = "\n".join(stability_report.table(known))
    assert reported["recommended_time_step_s"] == {
        "implicit": 0.01,
        "euler": 2e-4,
        "explicit": 2e-4,
    }
    assert reported["explicit_step_s"] == known.explicit_step
    assert f"{known.explicit_step:.4g}" in lines
    assert (
        "implicit at 0.001 s: stable; a tip error of about 0.0033 % of the length is expected"
        in lines
    )
    frequencies = reported["manipulators"]["finger"]["start"]["frequencies_rad_per_s"]  # type: ignore[index]
    assert len(frequencies) == 10


def header() -> str:
    plan = make_plan(scene_from_file("scene.yaml"))
    joints = plan.bodies[0].chain.joints
    return ",".join(["time_s", *(f"finger.{joint.name}.angle_rad" for joint in joints)])


def recorded(*lines: str) -> Table:
    return read_table("\n".join(lines), "run.csv")


def test_poses_are_read_from_a_recorded_run() -> None:
    plan = make_plan(scene_from_file("scene.yaml"))
    rows = [",".join([str(number)] * 11) for number in range(3 * MAX_POSES)]
    found = visited_poses(recorded(header(), *rows), plan)["finger"]
    assert len(found) == MAX_POSES
    assert found[0][1].tolist() == [0.0] * 10
    assert found[-1][1].tolist() == [float(3 * MAX_POSES - 1)] * 10
    assert found[0][0].position == (0.0, 0.0, 0.0)


def test_the_base_is_where_the_run_had_it() -> None:
    plan = make_plan(scene_from_file("scene.yaml"))
    base = [f"finger.base_pose.{name}" for name in ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")]
    row = ",".join(["0"] * 11 + ["1", "2", "3", "1,0,0,0"])
    table = recorded(",".join([header(), *base]), row)
    ((pose, _),) = visited_poses(table, plan)["finger"]
    assert pose.position == (20.0, 40.0, 60.0)  # the scene's world scale is 20
    assert pose.rotation[1][1] == pytest.approx(-1)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["time_s,x", "0,1"], "run.csv:1:1: error: there is no column 'finger.actuator_0_joint_01"),
        ([], "run.csv:1:1: error: the file is empty"),
        ([header()], "run.csv:1:1: error: no row follows the header"),
        ([header(), "0" + ",0" * 9], "run.csv:2:1: error: 10 cells, but the header names 11 col"),
        (
            [header(), "0" + ",0" * 10, "0,x" + ",0" * 9, "0,nan" + ",0" * 9],
            "run.csv:3:3: error: not a number: 'x'\nrun.csv:4:3: error: not a finite number: nan",
        ),
    ],
)
def test_a_file_that_is_not_a_run_of_the_scene(lines: list[str], message: str) -> None:
    plan = make_plan(scene_from_file("scene.yaml"))
    with pytest.raises(InvalidFile) as caught:
        visited_poses(recorded(*lines), plan)
    assert str(caught.value).startswith(message)
