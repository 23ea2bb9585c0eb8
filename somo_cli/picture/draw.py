"""Pictures of a recorded motion at several times, from one camera."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.picture import shading, shadows
from somo_cli.picture.camera import View, framing, radius_of
from somo_cli.picture.drawn_parts import Part, framed_points, parts_of, poses_at
from somo_cli.picture.facets import Array
from somo_cli.picture.recorded_motion import RecordedMotion
from somo_cli.picture.shading import Ground, Shading, smoothed
from somo_cli.picture.tiny_renderer import TinyRenderer
from somo_cli.scene.model import Scene

SMOOTHING = 2  # rendered pixels across one pixel of the picture
MAX_FRAMED_TIMES = 400  # evenly spaced times, for which the camera frames the scene


@dataclass(frozen=True, slots=True)
class PictureSettings:
    """The view of pictures, and their size: width and height in pixels."""

    view: View
    size: tuple[int, int]


def pictures(
    motion: RecordedMotion, times: Sequence[float], settings: PictureSettings
) -> Iterator[Array]:
    """Yield a picture for each time [s], unsigned bytes of shape (height, width, 3).

    The camera frames everything that moves, at all these times. Raises EngineMissing.
    """
    scene = motion.scene
    parts = parts_of(scene)
    points = _framed_points_over_time(motion, parts, times)
    camera = framing(points, settings.view, settings.size)
    radius = radius_of(points)
    size = (settings.size[0] * SMOOTHING, settings.size[1] * SMOOTHING)
    shader = Shading(camera, size, parts, _ground(scene, points, radius))
    light = shader.direction
    with TinyRenderer(parts, radius) as renderer:
        for time in times:
            poses = poses_at(scene, parts, motion.at(time))
            renderer.place(poses)
            lamp = shadows.lamp(framed_points(parts, poses), light)
            seen_by_lamp = renderer.render(lamp.camera, (shadows.MAP, shadows.MAP), light)
            raster = renderer.render(camera, size, light)
            yield smoothed(shader.picture(raster, lamp, seen_by_lamp), SMOOTHING)


def tile_edge(motion: RecordedMotion, times: Sequence[float]) -> float | None:
    """Return the edge of the squares of the ground in such pictures [m]; None without a ground."""
    if motion.scene.ground is None:
        return None
    parts = parts_of(motion.scene)
    return shading.tile_edge(radius_of(_framed_points_over_time(motion, parts, times)))


def _framed_points_over_time(
    motion: RecordedMotion, parts: Sequence[Part], times: Sequence[float]
) -> Array:
    moments = (motion.at(time) for time in _evenly(times))
    return np.concatenate(
        [
            framed_points(parts, poses_at(motion.scene, parts, configuration))
            for configuration in moments
        ]
    )


def _evenly(times: Sequence[float]) -> Sequence[float]:
    if len(times) <= MAX_FRAMED_TIMES:
        return times
    last = len(times) - 1
    return [
        times[round(number * last / (MAX_FRAMED_TIMES - 1))] for number in range(MAX_FRAMED_TIMES)
    ]


def _ground(scene: Scene, points: Array, radius: float) -> Ground | None:
    if scene.ground is None:
        return None
    x, y, _ = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return Ground(scene.ground.height, shading.tile_edge(radius), (float(x), float(y)), radius)
