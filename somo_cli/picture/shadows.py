"""Soft shadows: points that a distant lamp does not see are in shadow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from somo_cli.picture.camera import Camera
from somo_cli.picture.facets import Array
from somo_cli.picture.tiny_renderer import Raster

MAP = 1200  # pixels across the picture of the lamp
_FAR = 30.0  # distance of the lamp, in radii: its rays are almost parallel
_MARGIN = 1.05  # extent of the picture of the lamp over that of the points
_BIAS = 0.018  # distance behind a surface where its own shadow begins, over the radius
_TAPS = (-1, 0, 1)  # pixels down and across that are averaged for a soft shadow


@dataclass(frozen=True, slots=True)
class Lamp:
    """A camera at the lamp, and the radius of the points that it sees [m]."""

    camera: Camera
    radius: float


def light_direction(camera: Camera) -> Array:
    """Return the unit vector towards the light: above, behind and to the left of the camera."""
    right = camera.axes[0]
    above = np.array([0.0, 0.0, 1.0])
    direction = 1.2 * above - 0.25 * right - 0.65 * np.cross(above, right)
    unit: Array = direction / np.linalg.norm(direction)
    return unit


def lamp(points: Array, direction: Array) -> Lamp:
    """Return a lamp in a direction, a unit vector, that sees all points [m], shape (n, 3)."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    tangent = _MARGIN / math.sqrt(_FAR**2 - 1)
    camera = Camera(
        middle + _FAR * radius * direction,
        _axes(direction),
        (tangent, tangent),
        (_FAR - 1.1) * radius,
        (_FAR + 1.1) * radius,
    )
    return Lamp(camera, radius)


class Shadows:
    """Finds the pixels of one camera that are in shadow, for lamps in one direction."""

    def __init__(self, camera: Camera, size: tuple[int, int], direction: Array) -> None:
        self._axes = _axes(direction)
        self._eye = camera.eye
        self._rays = camera.rays(size, self._axes)

    def dark(self, pixels: Array, distances: Array, lamp: Lamp, raster: Raster) -> Array:
        """Return how dark the shadow is in `pixels`, indices of the picture, from 0 to 1.

        `distances` are those of the points in these pixels along the axis of the camera [m];
        `raster` is what the lamp sees.
        """
        x, y, z = (self._axes @ (self._eye - lamp.camera.eye)).astype(np.float32)
        across, upward, depth = self._rays[:, pixels] * distances + np.array([[x], [y], [z]])
        scale = np.float32(MAP / 2 / lamp.camera.tangents[0])
        # the pixels of the renderer begin at their lower left corner, and rows count from above
        column = np.rint(across / depth * scale + MAP / 2)
        row = np.rint(MAP - 1 - (upward / depth * scale + MAP / 2))
        edge = np.clip(row, 1, MAP - 2) * MAP + np.clip(column, 1, MAP - 2)
        middle = edge.astype(np.int32)
        limit = depth - np.float32(_BIAS * lamp.radius)
        met = _without_edge(raster.distances)
        dark = np.zeros(len(pixels), np.float32)
        for down in _TAPS:
            for on in _TAPS:
                dark += met[middle + (down * MAP + on)] < limit
        return dark / len(_TAPS) ** 2


def _axes(direction: Array) -> Array:
    """Return the axes of the camera of a lamp, right, up and forward, as rows."""
    side = np.array([1.0, 0.0, 0.0]) if abs(direction[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(side, direction)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(direction, right), -direction])


def _without_edge(distances: Array) -> Array:
    """Return the map as one row; its edge, which stands for all points outside, is empty."""
    free = np.full_like(distances, np.inf)
    free[2:-2, 2:-2] = distances[2:-2, 2:-2]
    return free.ravel()
