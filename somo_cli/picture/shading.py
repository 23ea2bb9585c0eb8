"""From the raster of the renderer to a picture: shadows, ground, seams and smooth edges.

Lengths are metres. Colours are red, green and blue from 0 to 255.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.picture.camera import Camera
from somo_cli.picture.drawn_parts import Part
from somo_cli.picture.facets import Array
from somo_cli.picture.shadows import Lamp, Shadows, light_direction
from somo_cli.picture.tiny_renderer import AMBIENT, Raster

TILES = (246.0, 232.0)
"""The greys of the two kinds of squares of the ground."""
_PAPER = 255.0
_DARKEST = 0.62  # brightness of the ground in full shadow, over that in light
_SEAM = 0.72  # brightness of the pixels on both sides of a seam between links
_CLEAR, _GONE = 1.8, 5.0  # distances from the middle, in radii, where the ground fades


@dataclass(frozen=True, slots=True)
class Ground:
    """The ground at a height, in squares; it fades around the middle of the framed points."""

    height: float
    square: float
    middle: tuple[float, float]
    radius: float


@dataclass(frozen=True, slots=True)
class _GroundPixels:
    """The ground in each pixel: its distance, its grey, and how far it has faded, 0 to 1."""

    distances: Array
    greys: Array
    fades: Array


def tile_edge(radius: float) -> float:
    """Return the edge of a square of the ground [m], of 1, 2 or 5 times a power of ten."""
    wanted = radius / 2
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1 + 1e-9))


class Shading:
    """Shades the pictures of one camera; it keeps what is the same in all of them."""

    def __init__(
        self, camera: Camera, size: tuple[int, int], parts: Sequence[Part], ground: Ground | None
    ) -> None:
        self.direction = light_direction(camera)
        """Unit vector towards the light."""
        self._size = size
        self._shadows = Shadows(camera, size, self.direction)
        self._unlit = np.array([part.colour for part in parts], np.float32) * (255 * AMBIENT)
        links = [(part.body, part.link) for part in parts]
        self._links = np.array([*map(links.index, links), -1])  # the last entry is for no part
        self._ground = None if ground is None else _ground_pixels(ground, camera, size)

    def picture(self, raster: Raster, lamp: Lamp, seen_by_lamp: Raster) -> Array:
        """Return the colour of every pixel, shape (height, width, 3), as floats from 0 to 255."""
        width, height = self._size
        parts = raster.parts.ravel().copy()
        distances = raster.distances.ravel()
        picture = np.full((height * width, 3), _PAPER, np.float32)
        ground = self._ground
        if ground is not None:
            pixels = np.flatnonzero(ground.distances < distances)
            parts[pixels] = -1
            pixels = pixels[ground.fades[pixels] < 1]
            dark = self._shadows.dark(pixels, ground.distances[pixels], lamp, seen_by_lamp)
            dark *= (1 - _DARKEST) * (1 - ground.fades[pixels])
            picture[pixels] = (ground.greys[pixels] * (1 - dark))[:, None]
        pixels = np.flatnonzero(parts >= 0)
        dark = self._shadows.dark(pixels, distances[pixels], lamp, seen_by_lamp)
        lit = raster.colours.reshape(-1, 3)[pixels].astype(np.float32)
        unlit = self._unlit[parts[pixels]]
        picture[pixels] = lit + dark[:, None] * np.minimum(unlit - lit, 0)
        whole = picture.reshape(height, width, 3)
        _draw_seams(whole, self._links[parts].reshape(height, width))
        return whole


def smoothed(picture: Array, factor: int) -> Array:
    """Return a picture reduced by a whole factor; each pixel is the mean of a square of pixels."""
    whole = [picture[i::factor, j::factor] for i in range(factor) for j in range(factor)]
    mean = sum(whole[1:], start=whole[0]) / np.float32(factor * factor)
    return np.clip(np.rint(mean), 0, 255).astype(np.uint8)


def _ground_pixels(ground: Ground, camera: Camera, size: tuple[int, int]) -> _GroundPixels:
    across, along, fall = camera.rays(size)
    fall = np.where(fall == 0, np.float32(1e-12), fall)
    away = (ground.height - camera.eye[2]) / fall
    is_seen = (away > 0) & (camera.eye[2] > ground.height)
    reach = np.where(is_seen, away, 0.0)
    x = camera.eye[0] + across * reach
    y = camera.eye[1] + along * reach
    is_odd = (np.floor(x / ground.square) + np.floor(y / ground.square)) % 2 == 1
    greys = np.where(is_odd, TILES[1], TILES[0])
    from_middle = np.hypot(x - ground.middle[0], y - ground.middle[1]) / ground.radius
    fades = np.clip((from_middle - _CLEAR) / (_GONE - _CLEAR), 0, 1)
    fades = fades * fades * (3 - 2 * fades)
    greys += fades * (_PAPER - greys)
    kept = (np.where(is_seen, away, np.inf), greys, fades)
    return _GroundPixels(*(values.astype(np.float32) for values in kept))


def _draw_seams(picture: Array, links: Array) -> None:
    """Darken the pixels at seams; `links` are the numbers of the links in all pixels."""
    for axis in (0, 1):
        one = tuple(slice(None, -1) if axis == i else slice(None) for i in (0, 1))
        next_one = tuple(slice(1, None) if axis == i else slice(None) for i in (0, 1))
        seam = (links[one] != links[next_one]) & (links[one] >= 0) & (links[next_one] >= 0)
        picture[one][seam] *= _SEAM
        picture[next_one][seam] *= _SEAM
