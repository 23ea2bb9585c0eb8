"""Where a picture is taken from, and how far away, so that everything wanted is in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from somo_cli.manipulator.geometry import Vector
from somo_cli.picture.facets import Array

HALF_ANGLE = math.radians(15)  # of the shorter side of the picture
MARGIN = 1.08  # what is framed, with some air around it
_NEAREST = 1e-3  # of the radius of what is framed: the least distance of the near plane


@dataclass(frozen=True, slots=True)
class View:
    """From where to look: turned by `yaw` from the front, `pitch` above the horizon [rad].

    The front is seen along +y; a yaw of π/2 sees it from +x. Distance [m] and target [m] are those
    that frame everything where they are None.
    """

    yaw: float
    pitch: float
    distance: float | None = None
    target: Vector | None = None

    @property
    def axes(self) -> Array:
        """Right, up and forward as rows, in the world."""
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
    """An eye in the world [m], its axes as rows (right, up, forward), and what it sees.

    `tangents` are those of half its angles, across and upward; `near` and `far` [m] bound what is
    drawn, along its axis.
    """

    eye: Array
    axes: Array
    tangents: tuple[float, float]
    near: float
    far: float

    def rays(self, size: tuple[int, int], axes: Array | None = None) -> Array:
        """Return for every pixel the way that is 1 along the camera's axis.

        Shape (3, width * height), row after row from above, in the world's axes or in others,
        which are the rows of a matrix.
        """
        width, height = size
        # TinyRenderer samples a pixel at its lower left corner, and tells rows from above
        x = (2 * np.arange(width) / width - 1) * self.tangents[0]
        y = (2 * np.arange(height - 1, -1, -1) / height - 1) * self.tangents[1]
        own = self.axes if axes is None else self.axes @ axes.T
        right, up, forward = own[:, :, None, None].astype(np.float32)
        rays: Array = right * x.astype(np.float32) + up * y.astype(np.float32)[:, None] + forward
        return rays.reshape(3, -1)


def framing(points: Array, view: View, size: tuple[int, int]) -> Camera:
    """Return the nearest camera of a view that has all points, shape (n, 3), in its picture."""
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
    """Return half the diagonal of the box around points, shape (n, 3)."""
    return max(0.5 * float(np.linalg.norm(np.ptp(points, axis=0))), 1e-9)


def _eye(own: Array, view: View, axes: Array, tangents: tuple[float, float]) -> Array:
    """Return the eye in its own axes, from points in these.

    A point is in sight if |across| <= tangent * depth, for both directions: of all eyes for which
    that holds the one that is furthest forward, and in the middle of what it may be sideways.
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
