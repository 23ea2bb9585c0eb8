"""Moved bases and objects: where they are, what joints feel of it, what is carried, over steps."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.mujoco_reference import mujoco_model, mujoco_trajectory_on_prescribed_base
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.truth.table import Row, ordered

STEPS = (4e-3, 2e-3, 1e-3, 5e-4)  # s
SHAKE = [[0, 0, 0, 0], [0.1, 0.05, 0, 0], [0.2, 0, 0.03, 0.02], [0.4, 0.02, 0, 0]]
TURN = [[0, 0, 0, 0], [0.25, 1.0, 0.5, 0.3], [0.5, 2.0, -0.5, 1.0]]
MOTIONS = {
    "shaken, up to 0.8 m/s and 28 m/s²": {"translation": SHAKE},
    "turned, up to 8 rad/s": {"rotation": TURN},
    "both": {"translation": SHAKE, "rotation": TURN},
}


def finger(motion: object, step: float) -> Scene:
    """Return the shipped finger on a base that is moved."""
    one = {"definition": "finger.yaml", "base": "constrained", "motion": motion}
    record = {"every": round(0.02 / step), "columns": ["joint_angles", "base_pose"]}
    data = {"manipulators": [one], "record": record, "time_step": step}
    return scene_from_text(json.dumps(data))


def bases() -> Iterator[list[Row]]:
    """Yield, motion by motion, the error of the base's pose and that of the joints' angles."""
    for case, data in MOTIONS.items():
        (one,) = finger(data, STEPS[0]).manipulators
        assert one.motion is not None
        model = mujoco_model(one.compiled.chain, (0, 0, -9.81), 2.5e-4, has_prescribed_base=True)
        reference = mujoco_trajectory_on_prescribed_base(
            model, one.motion, np.arange(0, 0.51, 0.02).tolist()
        )
        of_pose, of_angles = [], []
        for step in STEPS:
            plan = make_plan(finger(data, step))
            rows = np.array(rows_of(plan, round(0.5 / step)))
            count = reference.shape[1]
            error = float(np.abs(rows[:, 1 : 1 + count] - reference[: len(rows)]).max())
            what = "joints of a finger on a moved base, against MuJoCo's dynamics [rad]"
            last = rows[-1, 1], reference[len(rows) - 1, 0]
            of_angles.append(Row(what, case, f"{step:g} s", *last, error))
            path = plan.bodies[0].path
            assert path is not None
            poses = [path.at(time) for time in rows[:, 0]]
            places = np.array([pose.position for pose in poses]) / plan.scale.length
            turns = np.array([geometry.quaternion_from_rotation(one.rotation) for one in poses])
            off = max(
                float(np.abs(rows[:, -7:-4] - places).max()),
                float((1 - np.abs(np.sum(rows[:, -4:] * turns, axis=1))).max()),
            )
            what = "pose of a moved base [m, 1 - cos]"
            of_pose.append(Row(what, case, f"{step:g} s", rows[-1, -7], places[-1, 0], off))
        yield of_pose
        yield ordered(of_angles, STEPS)


def carried(motion: object, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the last poses of a plate that is moved for a second, and of a cube on it."""
    one = {"definition": manipulator(actuator(1, X), world_scale=20), "position": [9, 9, 9]}
    plate = {"name": "plate", "shape_type": "box", "dimensions": [0.3, 0.3, 0.02], "friction": 1}
    cube = {"name": "cube", "shape_type": "box", "dimensions": [0.04] * 3, "mass": 0.01}
    objects = [
        {**plate, "motion": motion},
        {**cube, "position": [0.05, 0, 0], "place": {"on": "plate"}},
    ]
    data = {"manipulators": [one], "objects": objects, "record": {"columns": []}}
    row = rows_of(scene_from_text(json.dumps({**data, "time_step": step})), round(1 / step))[-1]
    return np.array(row[1:8]), np.array(row[8:15])


def objects() -> Iterator[list[Row]]:
    """Yield how far what rides on a moved plate is from where it lay."""
    slid, turned = [], []
    for step in STEPS:
        plate, cube = carried({"translation": [[0, 0, 0, 0], [1, 0.5, 0, 0.1]]}, step)
        what = "a cube that rides on a plate, half a metre in a second: how far it slips [m]"
        off = float(np.abs(cube[:2] - plate[:2] - [0.05, 0]).max())
        slid.append(Row(what, "straight", f"{step:g} s", cube[0], 0.55, off))
        plate, cube = carried({"rotation": [[0, 0, 0, 0], [1, 0, 0, 3]]}, step)
        yaw = 2 * math.atan2(plate[5], plate[6])
        place = 0.05 * np.array([math.cos(yaw), math.sin(yaw)])
        off = float(np.linalg.norm(cube[:2] - place))
        what = "a cube that rides on a plate, 3 rad in a second, 5 cm off the axis: slips [m]"
        turned.append(Row(what, "turned", f"{step:g} s", cube[0], place[0], off))
    yield slid
    yield ordered(turned, STEPS)


def lifted() -> Iterator[list[Row]]:
    """Yield how far the cube that two fingers lift slips, and how hard they press."""
    found = []
    for step in STEPS:
        plan = make_plan(scene_from_file("lift_scene.yaml", f"time_step={step}"))
        names = columns.header(plan.recorded)
        table = dict(zip(names, np.array(rows_of(plan, round(2 / step))).T, strict=True))
        found.append((step, table))
    slips, forces = [], []
    finest = found[-1][1]["left.contact.normal_n"][-1]
    for step, table in found:
        low = (table["cube.pose.z_m"] - table["left.base_pose.z_m"])[table["time_s"] > 0.65]
        what = "a cube of 10 g that two fingers lift by 5 cm: how far it slips in them [m]"
        off = float(np.ptp(low))
        slips.append(Row(what, "lift_scene.yaml", f"{step:g} s", low[-1], low[0], off))
        force = table["left.contact.normal_n"][-1]
        what = "with which force each presses [N], relative to the finest step"
        off = abs(force / finest - 1)
        forces.append(Row(what, "lift_scene.yaml", f"{step:g} s", force, finest, off))
    yield slips
    yield forces


def rows() -> Iterator[Row]:
    """Yield every row about what is moved."""
    for part in (bases(), objects(), lifted()):
        for some in part:
            yield from some
