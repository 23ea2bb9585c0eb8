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
from somo_cli.simulation import columns
from somo_cli.simulation.plan import Body, Plan

MOST_POSES = 400  # that are looked at, evenly over the rows
MOST_FAULTS = 20


def poses_met(
    lines: Iterable[str], source: str, plan: Plan
) -> Mapping[str, Sequence[tuple[Pose, Array]]]:
    """Return poses of the base [engine units] and joint angles by the name of each body.

    The CSV is one of `somo run` that recorded joint_angles. Where it has base_pose as well, the
    base is where it says, else where the scene has it. Of long files every so many rows are taken.
    Raises InvalidFile.
    """
    rows = csv.reader(lines)
    header = next(rows, [])
    places = {name: place for place, name in enumerate(header)}
    missing = [name for body in plan.bodies for name in _names(body) if name not in places]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        message = f"there is no column '{missing[0]}'{more}"
        hint = "the trajectory is a CSV of this scene that recorded joint_angles"
        text = ",".join(header)
        raise InvalidFile([Problem(Span(source, 1, 1), message, hint)], {source: text})
    kept = _kept(rows, len(header), source)
    length = plan.scale.factor(Dimension(length=1))
    return {body.name: [_pose(body, places, row, length) for row in kept] for body in plan.bodies}


def _names(body: Body) -> list[str]:
    return [f"{body.name}.{joint.name}.angle_rad" for joint in body.chain.joints]


def _kept(rows: Iterable[list[str]], width: int, source: str) -> list[list[float]]:
    """Return rows evenly over all: whenever there are too many, every second one is dropped."""
    kept: list[list[float]] = []
    faults: list[Problem] = []
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
            faults.append(Problem(Span(source, number + 2, 1), str(error)))
            if len(faults) == MOST_FAULTS:
                break
            continue
        kept.append(values)
        if len(kept) > MOST_POSES:
            kept, stride = kept[::2], 2 * stride
    if faults:
        raise InvalidFile(faults)
    if not kept:
        raise InvalidFile([Problem(Span(source, 1, 1), "there is no row after the header")])
    return kept


def _pose(
    body: Body, places: Mapping[str, int], row: Sequence[float], length: float
) -> tuple[Pose, Array]:
    angles = np.array([row[places[name]] for name in _names(body)])
    base = columns.base_pose_names(body)
    if not all(name in places for name in base):
        return body.start.pose, angles
    x, y, z, qx, qy, qz, qw = (row[places[name]] for name in base)
    rotation = geometry.rotation_from_quaternion((qx, qy, qz, qw))
    return Pose((x * length, y * length, z * length), rotation), angles
