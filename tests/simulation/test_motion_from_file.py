"""A motion that a file gives: the same as by waypoints, through every command."""

from __future__ import annotations

import json
import math
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import somo_cli
from somo_cli import loading
from somo_cli.api.result import Result
from somo_cli.manipulator import geometry
from somo_cli.manual.topics import page
from tests.builders.command import Somo
from tests.builders.definitions import X, Y, actuator, manipulator
from tests.builders.scene_problems import messages_of

pytest.importorskip("pybullet")

BODY = manipulator(actuator(4, X, Y))
CUBE = {"name": "cube", "shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "mass": 1}
TIMES = (0.0, 0.05, 0.11, 0.2)
PLACES = ((0.0, 0.0, 0.0), (0.01, -0.02, 0.03), (0.02, 0.0, 0.05), (0.0, 0.01, 0.0))
TURNS = ((0.0, 0.0, 0.0), (0.1, 0.2, -0.3), (0.2, 0.1, -0.6), (0.3, 0.0, -0.2))
HEADER = "time_s,x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad"
KNOTS = tuple((t, *place, *turn) for t, place, turn in zip(TIMES, PLACES, TURNS, strict=True))


def csv_of(rows: Any, header: str = HEADER) -> str:
    return "\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n"


def in_place(text: str) -> dict[str, str]:
    """Return a file that a scene has in place of a path."""
    return {"source": "poses.csv", "text": text}


def moved_scene(motion: dict[str, Any], kind: str = "base", **more: Any) -> dict[str, Any]:
    if kind == "object":
        return {"objects": [{**CUBE, "motion": motion, **more}]}
    one = {"definition": BODY, "base": "constrained", "motion": motion, **more}
    return {"manipulators": [one], "record": {"columns": ["joint_angles", "base_pose"]}}


def moved_document(scene: dict[str, Any]) -> Any:
    return loading.load_text(json.dumps(scene), "a.json")


def result_of(scene: dict[str, Any], steps: int = 250) -> Result:
    return somo_cli.simulate(moved_document(scene), steps, time_step=1e-3)


def all_columns(result: Result) -> list[list[float]]:
    return [result[name].tolist() for name in result.names]


WAYPOINTS = {
    "translation": [[t, *place] for t, place in zip(TIMES, PLACES, strict=True)],
    "rotation": [[t, *turn] for t, turn in zip(TIMES, TURNS, strict=True)],
}


@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
@pytest.mark.parametrize("kind", ["base", "object"])
def test_the_file_is_the_same_as_its_waypoints_to_the_last_bit(
    kind: str, interpolation: str
) -> None:
    where = {"position": [0.3, 0.2, 0.5], "rpy": [0.1, -0.2, 0.3]}
    options: dict[str, Any] = {"interpolation": interpolation, "about": [0, 0, 0.1]}
    by_waypoints = result_of(moved_scene({**WAYPOINTS, **options}, kind, **where))
    by_file = result_of(moved_scene({"file": in_place(csv_of(KNOTS)), **options}, kind, **where))
    assert all_columns(by_file) == all_columns(by_waypoints)
    # and it moves
    name = "body.base_pose.z_m" if kind == "base" else "cube.pose.z_m"
    assert np.ptp(by_file[name]) > 0.04


@pytest.mark.parametrize("kind", ["base", "object"])
def test_poses_in_the_world_from_its_origin_are_the_same_to_the_last_bit(kind: str) -> None:
    file = in_place(csv_of(KNOTS))
    assert all_columns(
        result_of(moved_scene({"file": file, "frame": "world"}, kind))
    ) == all_columns(result_of(moved_scene({"file": file}, kind)))


@pytest.mark.parametrize("kind", ["base", "object"])
def test_poses_in_the_world_say_where_it_starts(kind: str) -> None:
    """The same way, told from the start, and as poses in the world, by angles and quaternions."""
    place, turn = (0.3, 0.2, 0.5), (0.1, -0.2, 0.3)
    start = geometry.rotation_from_rpy(turn)
    times = np.linspace(0, 0.25, 101).tolist()
    told, angles, quaternions = [], [], []
    for t in times:
        shift = (0.1 * math.sin(8 * t), 0.02 * t, 0.1 * t * t)
        rotation = (0.5 * math.sin(6 * t), 0.0, 2 * t)
        told.append((t, *shift, *rotation))
        there = geometry.multiply(geometry.rotation_from_rpy(rotation), start)
        position = geometry.add(place, shift)
        angles.append((t, *position, *geometry.rpy_from_rotation(there)))
        # the sign of a quaternion says nothing
        sign = -1 if len(quaternions) % 3 == 1 else 1
        quaternion = geometry.quaternion_from_rotation(there)
        quaternions.append((t, *position, *(sign * part for part in quaternion)))
    poses = [
        result_of(moved_scene({"file": in_place(csv_of(told))}, kind, position=place, rpy=turn)),
        result_of(moved_scene({"file": in_place(csv_of(angles)), "frame": "world"}, kind)),
        result_of(
            moved_scene(
                {
                    "file": in_place(csv_of(quaternions, "time_s,x_m,y_m,z_m,qx,qy,qz,qw")),
                    "frame": "world",
                },
                kind,
            )
        ),
    ]
    for name in poses[0].names:
        for other in poses[1:]:
            # rows 2.5 ms apart; what angles and quaternions do between them differs
            assert other[name] == pytest.approx(poses[0][name], abs=1e-5), name
    first = f"{'body.base_pose' if kind == 'base' else 'cube.pose'}.x_m"
    assert [one[first][0] for one in poses] == [0.3, 0.3, 0.3]


def test_the_poses_of_the_rows_are_met() -> None:
    result = result_of(moved_scene({"file": in_place(csv_of(KNOTS))}, "object"))
    for t, x, y, z, *turn in KNOTS:
        row = round(t / 1e-3)
        assert [result[f"cube.pose.{name}"][row] for name in ("x_m", "y_m", "z_m")] == (
            pytest.approx([x, y, z], abs=1e-12)
        )
        wanted = geometry.quaternion_from_rotation(geometry.rotation_from_rpy((*turn,)))  # type: ignore[arg-type]
        found = [result[f"cube.pose.{name}"][row] for name in ("qx", "qy", "qz", "qw")]
        assert abs(np.dot(found, wanted)) == pytest.approx(1, abs=1e-12)


def test_an_object_that_turns_while_it_goes_is_where_its_path_says() -> None:
    """The engine alone leads it aside by h² times spin times velocity: here by 5.6e-6 m."""
    document = moved_document(
        moved_scene(WAYPOINTS, "object", position=[0.1, 0.2, 0.3], rpy=[1, 2, 3])
    )
    scene, _ = loading.scene_of(document)
    (cube,) = scene.objects
    assert cube.motion is not None
    path = cube.motion.path_from(cube.pose)
    result = result_of(moved_scene(WAYPOINTS, "object", position=[0.1, 0.2, 0.3], rpy=[1, 2, 3]))
    for row, t in enumerate(result.time.tolist()):
        found = [result[f"cube.pose.{axis}_m"][row] for axis in "xyz"]
        assert found == pytest.approx(path.at(t).position, abs=1e-13)


def sorotraj_of(rows: list[list[float]]) -> dict[str, Any]:
    return {
        "settings": {"traj_type": "interp"},
        "config": {"interp_type": "linear", "setpoints": {"main": rows}},
    }


@pytest.mark.parametrize("channels", [3, 6])
def test_a_trajectory_of_the_scene_is_a_motion_by_its_knots(channels: int) -> None:
    rows = [list(row[: 1 + channels]) for row in KNOTS]
    trajectories = [{"name": "way", "sorotraj": sorotraj_of(rows), "speed_factor": 1.0}]
    by_trajectory = {**moved_scene({"trajectory": "way"}), "trajectories": trajectories}
    motion: dict[str, Any] = {**WAYPOINTS, "interpolation": "linear"}
    if channels == 3:
        del motion["rotation"]
    assert all_columns(result_of(by_trajectory)) == all_columns(result_of(moved_scene(motion)))


def test_a_trajectory_may_be_repeated_and_faster() -> None:
    rows = [[0, 0, 0, 0], [0.1, 0, 0, 0.02], [0.2, 0, 0, 0]]
    one = {"name": "way", "sorotraj": sorotraj_of(rows), "speed_factor": 2, "repetitions": 2}
    scene = {**moved_scene({"trajectory": "way"}, "object"), "trajectories": [one]}
    z = result_of(scene)["cube.pose.z_m"]
    assert [z[step] for step in (50, 100, 150, 200, 250)] == pytest.approx(
        [0.02, 0, 0.02, 0, 0], abs=1e-7
    )


def placed_problems(
    scene: dict[str, Any],
) -> list[tuple[str, int, int, str, str]]:
    return [
        (one.span.source, one.span.line, one.span.column, one.severity, one.message)
        for one in loading.check(moved_document(scene))
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", (1, 1, "error", "the file is empty")),
        ("time_s,x_m,y_m,z_m\n", (1, 1, "error", "no row follows the header")),
        ("x_m,y_m,z_m\n0,0,0\n", (1, 1, "error", "there is no column 'time_s'")),
        ("time_s,x_m,z_m\n0,0,0\n", (1, 1, "error", "there is no column 'y_m'")),
        (
            "time_s\n0\n",
            (1, 1, "error", "there are no columns of a position or a rotation"),
        ),
        (
            "time_s,x_mm,y_m,z_m,x_m\n0,0,0,0,0\n",
            (1, 8, "error", "'x_mm' is no column of a motion"),
        ),
        (
            "time_s,x_m,y_m,z_m\n0,0,0\n",
            (2, 1, "error", "3 cells, but the header names 4 columns"),
        ),
        ("time_s,x_m,y_m,z_m\n0,0,0,zero\n", (2, 7, "error", "not a number: 'zero'")),
        ("time_s,x_m,y_m,z_m\n0,0,0,nan\n", (2, 7, "error", "not a finite number: nan")),
        ("time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,1e21,0\n", (3, 5, "error", "1e21 is too large")),
        (
            "time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,0,0\n1,0,0,1\n",
            (4, 1, "error", "'time_s' must increase, found 1.0 after 1.0"),
        ),
        (
            "time_s,x_m,y_m,z_m\n0,0.5,0,0\n",
            (
                2,
                8 - 5,
                "error",
                "at time 0 the translation is [0.5, 0, 0] m, and the motion starts where position "
                "and rpy say",
            ),
        ),
        (
            "time_s,qx,qy,qz,qw\n0,1,0,0,0\n",
            (
                2,
                3,
                "error",
                "at time 0 the rotation is [1, 0, 0, 0], and the motion starts where position and "
                "rpy say",
            ),
        ),
        (
            "time_s,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0,0\n",
            (3, 3, "error", "this quaternion has no length, so it gives no rotation"),
        ),
        (
            "time_s,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0,0.99\n2,0,0,0,0.99\n",
            (
                3,
                3,
                "warning",
                "this quaternion has a length of 0.99, not 1, and so in 1 more row; it is "
                "normalised",
            ),
        ),
        (
            "time_s,qx,qy,qz,qw\n0,0,0,0,1\n1,0,0,0.8,0.6\n",
            (3, 3, "warning", "the rotation is 1.855 rad away from the row before"),
        ),
        (
            "time_s,roll_rad,pitch_rad,yaw_rad\n0,0,0,0\n1,0,0,3.1\n2,0,0,-3.1\n",
            (4, 7, "warning", "'yaw_rad' changes by 6.2 rad since the row before"),
        ),
        (
            "time_s,roll_rad,pitch_rad,yaw_rad,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n",
            (1, 35, "error", "the rotation is given twice"),
        ),
        (f"{HEADER}\n0,0,0,0,0,0,0\n", None),
        ("# mm\n\ntime_s,qx,qy,qz,qw\n0,0,0,0,-1.0000001\n", None),
    ],
)
def test_what_is_wrong_with_a_file_is_said_at_its_place(
    text: str, expected: tuple[int, int, str, str] | None
) -> None:
    found = placed_problems(moved_scene({"file": in_place(text)}, "object"))
    assert found == ([] if expected is None else [("poses.csv", *expected)])


def test_what_does_not_go_together_is_an_error() -> None:
    file = in_place(csv_of(KNOTS))
    world = {"file": file, "frame": "world"}
    assert messages_of(moved_scene({"file": file, "trajectory": "a"}, "object")) == [
        "trajectory has no meaning beside file, which is the whole motion"
    ]
    assert messages_of(moved_scene({"file": file, "rotation": [[0, 0, 0, 0]]}, "object")) == [
        "rotation has no meaning beside file, which is the whole motion"
    ]
    assert messages_of(moved_scene({**WAYPOINTS, "frame": "start"}, "object")) == [
        "frame is for a motion from a file or a trajectory: waypoints are from the start"
    ]
    assert messages_of(moved_scene({**world, "about": [0, 0, 0]}, "object")) == [
        "about has no meaning with frame: world"
    ]
    positions = in_place(csv_of([row[:4] for row in KNOTS], HEADER[:18]))
    assert messages_of(moved_scene({"file": positions, "about": [0, 0, 0]}, "object")) == [
        "about has no meaning without a rotation"
    ]
    assert messages_of(moved_scene({"file": positions, "frame": "world"}, "object")) == [
        "frame: world takes whole poses, and there are no columns roll_rad, pitch_rad, yaw_rad"
    ]
    for kind, key in (("base", "position"), ("base", "rpy"), ("object", "position")):
        assert messages_of(moved_scene(world, kind, **{key: [0, 0, 0]})) == [
            f"{key} has no meaning beside a motion with frame: world, which says where it starts"
        ]
    assert messages_of(moved_scene({"file": file, "repeat": True}, "object")) == [
        "a repeated motion ends where it starts, at [0.0, 0.0, 0.0], not [0.0, 0.01, 0.0]",
        "a repeated motion ends where it starts, at [0.0, 0.0, 0.0], not [0.3, 0.0, -0.2]",
    ]
    assert messages_of(moved_scene({"file": file}, "base", base="static")) == [
        "motion is for a constrained base, and this one is static"
    ]


@pytest.mark.parametrize(
    ("name", "rows", "message"),
    [
        ("other", [[0, 0, 0, 0], [1, 0, 0, 1]], "there is no trajectory 'other'"),
        ("way", [[0, 0], [1, 1]], "the trajectory has 1 channels, and a motion takes 3 or 6"),
        (
            "way",
            [[0, 0, 0, 1], [1, 0, 0, 1]],
            "at time 0 the translation is [0, 0, 1] m, and the motion starts where position and "
            "rpy say",
        ),
        (
            "way",
            [[0, 0, 0, 0], [1e-12, 0, 0, 1]],
            "the trajectory jumps at 1e-12 s, and a motion cannot",
        ),
    ],
)
def test_a_trajectory_must_be_a_motion(name: str, rows: list[list[float]], message: str) -> None:
    trajectories = [{"name": "way", "sorotraj": sorotraj_of(rows)}]
    scene = {**moved_scene({"trajectory": name}, "object"), "trajectories": trajectories}
    assert messages_of(scene) == [message]


def test_a_start_in_the_ground_is_found_by_the_engine() -> None:
    text = csv_of([(0.0, 0.0, 0.0, -0.05, 0.0, 0.0, 0.0)])
    scene = {**moved_scene({"file": in_place(text), "frame": "world"}), "ground": {}}
    found = loading.check_with_overlaps(moved_document(scene))
    assert ["overlaps the ground" in one.message for one in found] == [True]


@pytest.mark.moderate
def test_a_hundred_thousand_rows_are_read_in_seconds(tmp_path: Path) -> None:
    rows = [(i * 1e-3, math.sin(i * 1e-3), 0.0, 0.0, 0.0, 0.0, i * 1e-3) for i in range(100_000)]
    (tmp_path / "long.csv").write_text(csv_of(rows), "utf-8")
    scene = json.dumps(moved_scene({"file": "long.csv"}, "object"))
    start = time.process_time()
    result = somo_cli.simulate(loading.load_text(scene, str(tmp_path / "a.json")), 100)
    assert time.process_time() - start < 20  # 3 s, where nothing else runs
    assert result["cube.pose.x_m"][-1] == pytest.approx(math.sin(0.1), abs=1e-7)


def test_the_example_of_the_manual_moves_as_it_says(tmp_path: Path) -> None:
    (scene,) = (
        one
        for one in re.findall(r"```yaml\n(.*?)```", page("scenes"), re.DOTALL)
        if "paddle" in one
    )
    (poses,) = re.findall(r"```csv\n(.*?)```", page("scenes"), re.DOTALL)
    (tmp_path / "scene.yaml").write_text(scene, "utf-8")
    (tmp_path / "paddle.csv").write_text(poses, "utf-8")
    result = somo_cli.simulate(tmp_path / "scene.yaml", 1000)
    for step, x, y, z, yaw in (
        (0, 0.1, 0, 0.5, 0),
        (250, 0.1, 0.1, 0.5, 0.4),
        (500, 0.1, 0.2, 0.5, 0.8),
    ):
        found = [result[f"paddle.pose.{name}"][step] for name in ("x_m", "y_m", "z_m", "qz")]
        assert found == pytest.approx([x, y, z, math.sin(yaw / 2)], abs=1e-9)
    assert result["paddle.pose.z_m"][-1] == pytest.approx(0.4, abs=1e-9)


@pytest.mark.moderate
def test_a_file_is_named_relative_to_the_scene_and_goes_through_every_command(
    somo: Somo, tmp_path: Path
) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "poses.csv").write_text(csv_of(KNOTS), "utf-8")
    scene = moved_scene({"file": "poses.csv"}, "object", position=[0, 0, 1])
    (folder / "moved.json").write_text(json.dumps(scene), "utf-8")
    assert somo("check", "scenes/moved.json", "--strict").returncode == 0
    ran = somo("run", "scenes/moved.json", "--steps", "200", "--explain")
    assert ran.returncode == 0, ran.stderr
    assert "kept      prescribed motion: motion is given" in ran.stderr
    meta = json.loads((tmp_path / "moved.meta.json").read_text("utf-8"))
    assert [Path(name).name for name in meta["inputs"]] == ["moved.json", "poses.csv"]
    # drawn from the scene, and from rows without the pose, which its path gives
    whole = somo("render", "moved.csv", "--size", "64x48", "--at", "0.11", "-o", "whole.png")
    assert whole.returncode == 0, whole.stderr
    bare = tmp_path / "bare.csv"
    bare.write_text("time_s\n0\n0.11\n0.2\n", "utf-8")
    options = ("--scene", "scenes/moved.json", "--size", "64x48", "--at", "0.11")
    drawn = somo("render", "bare.csv", *options, "-o", "bare.png")
    assert drawn.returncode == 0, drawn.stderr
    assert (tmp_path / "bare.png").read_bytes() == (tmp_path / "whole.png").read_bytes()
    # a change of the file is seen, a file that is not there or elsewhere is refused
    (folder / "poses.csv").write_text(csv_of(KNOTS[:3]), "utf-8")
    changed = somo("render", "moved.csv", "--size", "64x48", "-o", "changed.png")
    assert "poses.csv:1:1: warning: this file has changed since the run" in changed.stderr
    for name, message in (
        ("none.csv", "cannot read 'none.csv': no such file or directory"),
        ("../moved.csv", "cannot use '../moved.csv': the path leads out of the folder"),
    ):
        refused = somo("run", "scenes/moved.json", "--steps", "1", "--set",
                       f"objects[0].motion.file={name}")  # fmt: skip
        assert (refused.returncode, message in refused.stderr) == (3, True), refused.stderr
        assert "Traceback" not in refused.stderr
