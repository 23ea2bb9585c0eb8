"""Cameras: the direction of a view, and the position that frames given points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from somo_cli.manipulator.geometry import Vector
from somo_cli.picture.facets import Array

HALF_ANGLE = math.radians(15)  # of the shorter side of the picture
MARGIN = 1.08  # extent of the picture over that of the framed points
_NEAREST = 1e-3  # least distance of the near plane, over the radius of the framed points


@dataclass(frozen=True, slots=True)
class View:
    """A direction of view: `yaw` from the front and `pitch` above the horizon [rad].

    With a yaw of zero the camera looks along +y; with π/2 it looks from +x. `distance` [m] and
    `target` [m] are None where the camera frames all points.
    """

    yaw: float
    pitch: float
    distance: float | None = None
    target: Vector | None = None

    @property
    def axes(self) -> Array:
        """Right, up and forward as rows, shape (3, 3), in the world frame."""
        sy, cy = math.sin(self.yaw), math.cos(self.yaw)
        sp, cp = math.sin(self.pitch), math.cos(self.pitch)
        return np.array([[cy, sy, 0.0], [-sp * sy, sp * cy, cp], [-cp * sy, cp * cy, -sp]])


VIEWS = {
    "oblique": View(math.radians(50), math.radians(22)),
    "front": View(0.0, 0.0),
    "side": View(math.pi / 2, 0.0),
    "top": View(0.0, math.pi / 2),
}


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera at `eye` in the world [m], with its axes (right, up, forward) as rows.

    `tangents` are those of half the angles of view, across and upward; `near` and `far` [m] are the
    clipping distances along its axis.
    """

    eye: Array
    axes: Array
    tangents: tuple[float, float]
    near: float
    far: float

    def rays(self, size: tuple[int, int], axes: Array | None = None) -> Array:
        """Return the ray of every pixel, of length 1 along the axis of the camera.

        The shape is (3, width * height), the top row first. Rays are in the world frame, or in the
        axes that are the rows of `axes`, shape (3, 3).
        """
        width, height = size
        # TinyRenderer samples a pixel at its lower left corner; its first row is the top one
        x = (2 * np.arange(width) / width - 1) * self.tangents[0]
        y = (2 * np.arange(height - 1, -1, -1) / height - 1) * self.tangents[1]
        own = self.axes if axes is None else self.axes @ axes.T
        right, up, forward = own[:, :, None, None].astype(np.float32)
        rays: Array = right * x.astype(np.float32) + up * y.astype(np.float32)[:, None] + forward
        return rays.reshape(3, -1)


def framing(points: Array, view: View, size: tuple[int, int]) -> Camera:
    """Return the nearest camera of a view that sees all points [m], shape (n, 3)."""
    width, height = size
    short = math.tan(HALF_ANGLE)
    tangents = (short * max(1.0, width / height), short * max(1.0, height / width))
    axes = view.axes
    own = points @ axes.T
    eye = _eye(own, view, axes, (tangents[0] / MARGIN, tangents[1] / MARGIN))
    depths = own[:, 2] - eye[2]
    radius = radius_of(points)
    near = max(float(depths.min()) - 0.5 * radius, _NEAREST * radius)
    far = max(float(depths.max()) + 4 * radius, 2 * near)
    return Camera(eye @ axes, axes, tangents, near, far)


def radius_of(points: Array) -> float:
    """Return half the diagonal of the box around points [m], shape (n, 3)."""
    return max(0.5 * float(np.linalg.norm(np.ptp(points, axis=0))), 1e-9)


def _eye(own: Array, view: View, axes: Array, tangents: tuple[float, float]) -> Array:
    """Return the position of the camera, in its own axes as the points `own` are.

    A point is visible if |across| <= tangent * depth in both directions. Of all positions that see
    all points this is the one furthest forward, in the middle of its range sideways.
    """
    if view.target is not None:
        middle: Array = axes @ np.array(view.target)
        away = own - middle
        distance = max(
            float((np.abs(away[:, side]) / tangents[side] - away[:, 2]).max()) for side in (0, 1)
        )
        middle[2] -= distance if view.distance is None else view.distance
        return middle
    low = [float((own[:, side] + tangents[side] * own[:, 2]).min()) for side in (0, 1)]
    high = [float((own[:, side] - tangents[side] * own[:, 2]).max()) for side in (0, 1)]
    forward = min((low[side] - high[side]) / (2 * tangents[side]) for side in (0, 1))
    eye = np.array([*((low[side] + high[side]) / 2 for side in (0, 1)), forward])
    if view.distance is not None:
        eye[2] = 0.5 * (own[:, 2].min() + own[:, 2].max()) - view.distance
    return eye
