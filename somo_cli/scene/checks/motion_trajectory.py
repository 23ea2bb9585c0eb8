"""Check a motion that a trajectory of the scene gives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, Span, did_you_mean, has_errors
from somo_cli.scene.checks import sorotraj
from somo_cli.scene.checks.motion_start import about_problems, pose_problems
from somo_cli.scene.prescribed_motion import POSE_CHANNELS, POSITION_CHANNELS, read_motion
from somo_cli.scene.reader import read_trajectories

MIN_KNOT_INTERVAL = 1e-9  # s: knots of a trajectory that are nearer than this are a jump


def motion_trajectory_problems(
    document: Document,
    at: Pointer,
    motion: Mapping[str, Any],
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    """Yield the errors of the motion at `at`, which a trajectory of the scene gives.

    `channel_counts` has the number of channels of each trajectory, None if it is unknown.
    """
    name, place = motion["trajectory"], document.span((*at, "trajectory"))
    if name not in channel_counts:
        known = ", ".join(channel_counts) or "none"
        hint = did_you_mean(name, channel_counts) or f"the trajectories are: {known}"
        yield Problem(place, f"there is no trajectory '{name}'", hint)
        return
    count = channel_counts[name]
    if count is None or _has_wrong_trajectory(document, name):
        return  # reported where the trajectory is checked
    if count not in (POSITION_CHANNELS, POSE_CHANNELS):
        message = f"the trajectory has {count} channels, and a motion takes 3 or 6"
        hint = "x, y, z [m], and then roll, pitch, yaw [rad]"
        yield Problem(place, message, hint)
        return
    yield from about_problems(document, at, motion, count == POSE_CHANNELS)
    if motion.get("frame") == "world" and count != POSE_CHANNELS:
        message = "frame: world takes whole poses, and the trajectory has no roll, pitch and yaw"
        yield Problem(place, message, "give it six channels, or set frame: start")
        return
    yield from _knot_problems(document, motion, place)


def _knot_problems(document: Document, motion: Mapping[str, Any], place: Span) -> Iterator[Problem]:
    """Yield an error where a trajectory jumps, and those of its start and its repetition."""
    read = read_motion(motion, read_trajectories(document.data))
    times = [point[0] for point in read.translation]
    jump = next((b for a, b in pairwise(times) if b - a < MIN_KNOT_INTERVAL), None)
    if jump is not None:
        message = f"the trajectory jumps at {jump:g} s, and a motion cannot"
        yield Problem(place, message, "let each part begin where the one before ends")
        return
    whole = {**motion, "interpolation": read.interpolation}
    for part, points in (("translation", read.translation), ("rotation", read.rotation)):
        yield from pose_problems(whole, part, points, lambda _: place)


def _has_wrong_trajectory(document: Document, name: str) -> bool:
    scene: Any = document.data
    for index, item in enumerate(scene["trajectories"]):
        at: Pointer = ("trajectories", index)
        problems = sorotraj.trajectory_problems(document, (*at, "sorotraj"), item["sorotraj"])
        if item["name"] == name and has_errors(
            [*problems, *sorotraj.trajectory_use_problems(document, at, item)]
        ):
            return True
    return False
