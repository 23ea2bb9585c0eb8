"""From what the renderer sees to a picture: soft shadows, the ground, and smooth edges.

Lengths are metres. Colours are red, green and blue from 0 to 255 until the end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.picture.camera import Camera
from somo_cli.picture.facets import Array
from somo_cli.picture.stage import Part
from somo_cli.picture.tiny_renderer import AMBIENT, Raster

TILES = (246.0, 232.0)
"""The greys of the two kinds of squares on the ground."""
_PAPER = 255.0
_DARKEST = 0.62  # of the ground, in full shadow
_SEAM = 0.72  # of what is dark along the edge of a part that lies before another
_BLUR = 1.25  # pixels of the shadow map, between the places at which it is asked
_BIAS = 0.018  # of the radius: how far behind a surface its own shadow begins
_CLEAR, _GONE = 1.8, 5.0  # radii from the middle at which the ground begins to fade, and ends


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane at a height, in squares of this edge, around the middle of what is framed."""

    height: float
    square: float
    middle: tuple[float, float]
    radius: float


@dataclass(frozen=True, slots=True)
class Light:
    """A distant lamp: the direction it shines from, the camera in its place, and what that sees."""

    direction: Array
    camera: Camera
    raster: Raster


def square_of(radius: float) -> float:
    """Return the edge of a square of the ground [m]: 1, 2 or 5 times a power of ten."""
    wanted = radius / 2
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1 + 1e-9))


def light_direction(camera: Camera) -> Array:
    """Return from where light falls in: from above, a little left of the camera."""
    right, _, forward = camera.axes
    direction = np.array([0.0, 0.0, 1.0]) - 0.25 * right - 0.55 * forward
    unit: Array = direction / np.linalg.norm(direction)
    return unit


def light_camera(points: Array, direction: Array) -> Camera:
    """Return a camera far away in a direction that sees all points, shape (n, 3)."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    distance = 30 * radius
    side = np.array([1.0, 0.0, 0.0]) if abs(direction[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(side, direction)
    right /= np.linalg.norm(right)
    tangent = 1.02 * radius / (distance - radius)
    return Camera(
        middle + distance * direction,
        np.stack([right, np.cross(direction, right), -direction]),
        (tangent, tangent),
        distance - 1.1 * radius,
        distance + 1.1 * radius,
    )


class Shading:
    """Makes pictures from one camera; what does not change from picture to picture is kept."""

    def __init__(
        self, camera: Camera, size: tuple[int, int], parts: Sequence[Part], ground: Ground | None
    ) -> None:
        self._camera = camera
        self._rays = camera.rays(size)
        self._unlit = np.array([part.colour for part in parts], np.float32) * 255 * AMBIENT
        links = [(part.body, part.link) for part in parts]
        self._links = np.array([*map(links.index, links), -1])  # the last one is that of no part
        self._ground = ground
        if ground is not None:
            self._away, self._tiles, self._fade = _laid(ground, camera, self._rays)

    def picture(self, raster: Raster, light: Light, radius: float) -> Array:
        """Return red, green and blue of every pixel, shape (height, width, 3), as floats."""
        picture = raster.colours.astype(np.float32)
        is_part = raster.parts >= 0
        picture[~is_part] = _PAPER
        distances = raster.distances
        if self._ground is not None:
            is_ground = self._away < distances
            picture[is_ground] = self._tiles[is_ground][:, None]
            is_part &= ~is_ground
            distances = np.where(is_ground, self._away, distances)
            near = is_ground & (self._fade < 1)
            dark = self._shadow(near, distances, light, radius) * (1 - self._fade[near])
            picture[near] *= (1 - (1 - _DARKEST) * dark)[:, None]
        dark = self._shadow(is_part, distances, light, radius)[:, None]
        lit, unlit = picture[is_part], self._unlit[raster.parts[is_part]]
        picture[is_part] = lit + dark * np.minimum(unlit - lit, 0)
        _draw_seams(picture, self._links[np.where(is_part, raster.parts, -1)])
        return picture

    def _shadow(self, where: Array, distances: Array, light: Light, radius: float) -> Array:
        """Return how far each of these pixels is in the shadow, 0 to 1."""
        points = self._camera.eye.astype(np.float32) + self._rays[where] * distances[where][:, None]
        seen = light.camera.seen(points)
        height, width = light.raster.distances.shape
        column = (seen[:, 0] + 1) * (width / 2)
        row = height - 1 - (seen[:, 1] + 1) * (height / 2)
        limit = seen[:, 2] - _BIAS * radius
        dark = np.zeros(len(points), np.float32)
        for down in (-_BLUR, 0.0, _BLUR):
            for on in (-_BLUR, 0.0, _BLUR):
                i, j = np.rint(row + down).astype(int), np.rint(column + on).astype(int)
                inside = (i >= 0) & (i < height) & (j >= 0) & (j < width)
                met = light.raster.distances[np.where(inside, i, 0), np.where(inside, j, 0)]
                dark += inside & (met < limit)
        return dark / 9


def smoothed(picture: Array, factor: int) -> Array:
    """Return the picture smaller by a whole factor, each pixel the mean of those it stands for."""
    height, width, _ = picture.shape
    blocks = picture.reshape(height // factor, factor, width // factor, factor, 3)
    return np.clip(np.rint(blocks.mean(axis=(1, 3))), 0, 255).astype(np.uint8)


def _laid(ground: Ground, camera: Camera, rays: Array) -> tuple[Array, Array, Array]:
    """Return for each pixel how far away the ground is, its grey, and how far it has faded."""
    fall = np.where(rays[..., 2] == 0, np.float32(1e-12), rays[..., 2])
    away = (ground.height - camera.eye[2]) / fall
    is_seen = (away > 0) & (camera.eye[2] > ground.height)
    away = np.where(is_seen, away, np.inf).astype(np.float32)
    reach = np.where(is_seen, away, 0.0)
    x = camera.eye[0] + rays[..., 0] * reach
    y = camera.eye[1] + rays[..., 1] * reach
    is_odd = (np.floor(x / ground.square) + np.floor(y / ground.square)) % 2 == 1
    grey = np.where(is_odd, TILES[1], TILES[0])
    from_middle = np.hypot(x - ground.middle[0], y - ground.middle[1]) / ground.radius
    fade = np.clip((from_middle - _CLEAR) / (_GONE - _CLEAR), 0, 1)
    fade = fade * fade * (3 - 2 * fade)
    return away, (grey + fade * (_PAPER - grey)).astype(np.float32), fade.astype(np.float32)


def _draw_seams(picture: Array, links: Array) -> None:
    """Darken the pixels of links, by their numbers, that border on another link."""
    for axis in (0, 1):
        one = tuple(slice(None, -1) if axis == i else slice(None) for i in (0, 1))
        next_one = tuple(slice(1, None) if axis == i else slice(None) for i in (0, 1))
        seam = (links[one] != links[next_one]) & (links[one] >= 0) & (links[next_one] >= 0)
        picture[one][seam] *= _SEAM
        picture[next_one][seam] *= _SEAM
