"""Read a URDF back with yourdfpy, an independent reader, and compare it with the chain."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Sequence
from typing import Any

from somo_cli.manipulator import geometry, kinematics
from somo_cli.manipulator.chain import Chain, Joint
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused

TOLERANCE = 1e-9  # relative to the size of what is compared
MAX_DIFFERENCES = 5  # differences; one wrong joint moves everything beyond it
_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def require_equal(text: str, chain: Chain) -> None:
    """Raise EngineRefused, with the first differences, unless a URDF describes a chain.

    yourdfpy reads the URDF. Poses with bent joints are compared as well, springs and shapes are
    not. The URDF may have massless links fixed to the last link of a limb, such as a tip frame.
    """
    # its import takes half a second and 100 MB
    import yourdfpy

    robot = yourdfpy.URDF.load(io.BytesIO(text.encode()), build_scene_graph=False).robot
    comparison = _Comparison(chain)
    comparison.compare_links(robot)
    comparison.compare_joints(robot)
    if not comparison.found:
        # without visuals its scene graph has frames only, and needs no mesh files
        for link in robot.links:
            link.visuals = []
        comparison.compare_poses(yourdfpy.URDF(robot=robot, load_meshes=False))
    if comparison.found:
        shown = comparison.found[:MAX_DIFFERENCES]
        if len(shown) < len(comparison.found):
            shown.append(f"and {len(comparison.found) - len(shown)} more")
        raise EngineRefused(chain.name, "read back, the URDF differs: " + "; ".join(shown))


class _Comparison:
    """Collects a message for each difference between a robot of yourdfpy and a chain."""

    def __init__(self, chain: Chain) -> None:
        self.found: list[str] = []
        self._chain = chain

    def compare_links(self, robot: Any) -> None:
        """Compare names, masses, centres of mass and inertias."""
        chain = self._chain
        self._compare_values("name", robot.name, chain.name)
        own = len(chain.links)
        names = [link.name for link in robot.links]
        self._compare_values("links", names[:own], [link.name for link in chain.links])
        for link in robot.links[own:]:
            if link.name in names[:own]:
                self.found.append(f"two links are called '{link.name}'")
            if link.inertial is not None:
                self.found.append(f"link '{link.name}' has a mass, and the chain has no such link")
        for link, theirs in zip(chain.links, robot.links, strict=False):
            what = f"of '{link.name}'"
            if theirs.inertial is None or theirs.inertial.origin is None:
                self.found.append(f"no inertial {what}")
                continue
            inertial, moments = link.inertial, theirs.inertial.inertia
            six = [moments[i][j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
            position, rotation = _pose(theirs.inertial.origin)
            self._compare_numbers(f"mass {what}", [theirs.inertial.mass], [inertial.mass], 0.0)
            self._compare_numbers(f"centre of mass {what}", position, inertial.centre, chain.length)
            self._compare_numbers(f"axes of the inertia {what}", rotation, _IDENTITY)
            self._compare_numbers(
                f"inertia {what}", six, inertial.inertia, max(map(abs, inertial.inertia))
            )

    def compare_joints(self, robot: Any) -> None:
        """Compare names, parents, types, axes, origins, limits, damping and friction."""
        chain = self._chain
        own = len(chain.joints)
        names = [joint.name for joint in robot.joints]
        self._compare_values("joints", names[:own], [joint.name for joint in chain.joints])
        self._require_fixed_to_last_links(robot.joints[own:])
        pairs = zip(chain.joints, robot.joints, strict=False)
        for index, (joint, theirs) in enumerate(pairs):
            what = f"of '{joint.name}'"
            ends = (chain.links[joint.parent].name, chain.links[index + 1].name)
            self._compare_values(f"parent and child {what}", (theirs.parent, theirs.child), ends)
            kind = "revolute" if joint.is_limited else "continuous"
            self._compare_values(f"type {what}", theirs.type, kind)
            self._compare_numbers(f"axis {what}", list(theirs.axis), joint.axis)
            position, rotation = _pose(theirs.origin)
            self._compare_numbers(f"origin {what}", position, joint.origin, chain.length)
            turn = _row_by_row(geometry.rotation_from_rpy(joint.rpy))
            self._compare_numbers(f"rotation {what}", rotation, turn)
            self._compare_dynamics(what, theirs.dynamics, joint)
            self._compare_limits(what, theirs.limit, joint)

    def _require_fixed_to_last_links(self, joints: Sequence[Any]) -> None:
        """Report each additional joint unless it fixes a link to the last link of a limb."""
        links = self._chain.links
        last_links = [links[limb.last_link].name for limb in self._chain.backbones]
        for joint in joints:
            if joint.type != "fixed" or joint.parent not in last_links:
                wanted = ("fixed", links[-1].name)
                self._compare_values(f"place of '{joint.name}'", (joint.type, joint.parent), wanted)

    def _compare_dynamics(self, what: str, theirs: Any, joint: Joint) -> None:
        if theirs is None:
            self.found.append(f"no damping and friction {what}")
            return
        # yourdfpy keeps these two as strings
        damping, friction = float(theirs.damping), float(theirs.friction)
        self._compare_numbers(f"damping {what}", [damping], [joint.damping], 0.0)
        self._compare_numbers(f"friction {what}", [friction], [joint.friction], 0.0)

    def _compare_limits(self, what: str, theirs: Any, joint: Joint) -> None:
        if joint.is_limited != (theirs is not None):
            self.found.append(f"limits {what} are {theirs}")
        elif joint.is_limited:
            four = [theirs.lower, theirs.upper, theirs.effort, theirs.velocity]
            ours = (joint.lower, joint.upper, joint.effort, joint.velocity)
            self._compare_numbers(f"limits {what}", four, ours)

    def compare_poses(self, urdf: Any) -> None:
        """Compare the poses of all link frames, all joints bent, with those of yourdfpy."""
        chain = self._chain
        names = [joint.name for joint in chain.joints]
        angles = [0.1 * (1 + place % 3) * (-1) ** (place // 2) for place in range(len(names))]
        urdf.update_cfg(dict(zip(names, angles, strict=True)))
        poses = kinematics.link_poses(chain, angles, Pose())
        for link, pose in zip(chain.links, poses, strict=True):
            position, rotation = _pose(urdf.get_transform(link.name, chain.links[0].name))
            what = f"of '{link.name}', bent"
            self._compare_numbers(f"position {what}", position, pose.position, chain.length)
            ours = _row_by_row(pose.rotation)
            self._compare_numbers(f"orientation {what}", rotation, ours)

    def _compare_values(self, what: str, theirs: object, ours: object) -> None:
        if theirs != ours:
            self.found.append(f"{what}: {theirs} instead of {ours}")

    def _compare_numbers(
        self, what: str, theirs: Sequence[float | None], ours: Sequence[float], size: float = 1.0
    ) -> None:
        """Compare numbers; `size`, in their unit, is the scale of the tolerance near zero."""
        if not all(
            a is not None and math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=TOLERANCE * size)
            for a, b in zip(theirs, ours, strict=True)
        ):
            self.found.append(f"{what}: {_shown(theirs)} instead of {_shown(ours)}")


def _pose(matrix: Any) -> tuple[list[float], list[float]]:
    """Return position and rotation, row by row, of a homogeneous matrix; None is the identity."""
    if matrix is None:
        return [0.0, 0.0, 0.0], list(_IDENTITY)
    rows = [[float(number) for number in row] for row in matrix]
    return [row[3] for row in rows[:3]], _row_by_row([row[:3] for row in rows[:3]])


def _row_by_row(matrix: Iterable[Iterable[float]]) -> list[float]:
    return [number for row in matrix for number in row]


def _shown(values: Sequence[float | None]) -> str:
    return "[" + ", ".join("none" if v is None else f"{v:.9g}" for v in values) + "]"
