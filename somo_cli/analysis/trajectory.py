"""The poses that a recorded run has met, from the lines of its CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import InvalidFile, Problem, Span
from somo_cli.scene import columns
from somo_cli.simulation.plan.model import Body, Plan

MAX_POSES = 400  # that are looked at, evenly over the rows
MAX_PROBLEMS = 20


def visited_poses(
    lines: Iterable[str], source: str, plan: Plan
) -> Mapping[str, Sequence[tuple[Pose, Array]]]:
    """Return poses of the base [engine units] and joint angles by the name of each body.

    The CSV is one of `somo run` that recorded joint_angles. Where it has base_pose as well, the
    base is where it says, else where the scene has it. Of long files every so many rows are taken.
    Raises InvalidFile.
    """
    rows = csv.reader(lines)
    header = next(rows, [])
    indices = {name: index for index, name in enumerate(header)}
    missing = [name for body in plan.bodies for name in _names(body) if name not in indices]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        message = f"there is no column '{missing[0]}'{more}"
        hint = "the trajectory is a CSV of this scene that recorded joint_angles"
        text = ",".join(header)
        raise InvalidFile([Problem(Span(source, 1, 1), message, hint)], {source: text})
    thinned = _thinned_rows(rows, len(header), source)
    length = plan.scale.factor(Dimension(length=1))
    return {
        body.name: [_pose(body, indices, row, length) for row in thinned] for body in plan.bodies
    }


def _names(body: Body) -> list[str]:
    return [f"{body.name}.{joint.name}.angle_rad" for joint in body.chain.joints]


def _thinned_rows(rows: Iterable[list[str]], width: int, source: str) -> list[list[float]]:
    """Return rows evenly over all: whenever there are too many, every second one is dropped."""
    thinned: list[list[float]] = []
    problems: list[Problem] = []
    stride = 1
    for number, cells in enumerate(rows):
        if number % stride:
            continue
        try:
            if len(cells) != width:
                raise ValueError(f"{len(cells)} values for {width} columns")
            values = [float(cell) for cell in cells]
            if not np.isfinite(values).all():
                raise ValueError("a value is not finite")
        except ValueError as error:
            problems.append(Problem(Span(source, number + 2, 1), str(error)))
            if len(problems) == MAX_PROBLEMS:
                break
            continue
        thinned.append(values)
        if len(thinned) > MAX_POSES:
            thinned, stride = thinned[::2], 2 * stride
    if problems:
        raise InvalidFile(problems)
    if not thinned:
        raise InvalidFile([Problem(Span(source, 1, 1), "there is no row after the header")])
    return thinned


def _pose(
    body: Body, indices: Mapping[str, int], row: Sequence[float], length: float
) -> tuple[Pose, Array]:
    angles = np.array([row[indices[name]] for name in _names(body)])
    base = columns.base_pose_names(body.name)
    if not all(name in indices for name in base):
        return body.start.pose, angles
    x, y, z, qx, qy, qz, qw = (row[indices[name]] for name in base)
    rotation = geometry.rotation_from_quaternion((qx, qy, qz, qw))
    return Pose((x * length, y * length, z * length), rotation), angles
