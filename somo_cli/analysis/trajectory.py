"""The poses that a recorded run passed through, from the CSV of `somo run`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.document.table import Table
from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import InvalidFile, Problem
from somo_cli.scene import columns
from somo_cli.simulation.plan.model import Body, Plan

MAX_POSES = 400  # examined, evenly spread over the rows


def visited_poses(table: Table, plan: Plan) -> Mapping[str, Sequence[tuple[Pose, Array]]]:
    """Return base poses [engine units] and joint angles [rad], shape (n,), by body name.

    The table must hold the joint_angles of every body. The base pose is read from base_pose where
    that is recorded, and is the start pose otherwise. Of long recordings MAX_POSES rows are used.
    Raises InvalidFile.
    """
    _require_angles(table, plan)
    count = len(table.lines) - 1
    rows = np.unique(np.linspace(0, count - 1, min(count, MAX_POSES)).round().astype(int))
    length = plan.scale.factor(Dimension(length=1))
    return {
        body.name: [_pose(body, table.columns, row, length) for row in rows.tolist()]
        for body in plan.bodies
    }


def _require_angles(table: Table, plan: Plan) -> None:
    wanted = [name for body in plan.bodies for name in _angle_names(body)]
    missing = [name for name in wanted if name not in table.columns]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        message = f"there is no column '{missing[0]}'{more}"
        hint = "the trajectory is a CSV of this scene that recorded joint_angles"
        place = table.header_span(table.names[0])
        raise InvalidFile([Problem(place, message, hint)], table.texts)


def _angle_names(body: Body) -> list[str]:
    return [f"{body.name}.{joint.name}.angle_rad" for joint in body.chain.joints]


def _pose(
    body: Body, recorded: Mapping[str, Sequence[float]], row: int, length: float
) -> tuple[Pose, Array]:
    angles = np.array([recorded[name][row] for name in _angle_names(body)])
    base = columns.base_pose_names(body.name)
    if not all(name in recorded for name in base):
        return body.start.pose, angles
    x, y, z, qx, qy, qz, qw = (recorded[name][row] for name in base)
    rotation = geometry.rotation_from_quaternion((qx, qy, qz, qw))
    return Pose((x * length, y * length, z * length), rotation), angles
