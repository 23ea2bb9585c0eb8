"""Pictures of a scene at several moments, one after the other, by one camera."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.picture import shading, shadows
from somo_cli.picture.camera import View, framing, radius_of
from somo_cli.picture.facets import Array
from somo_cli.picture.shading import Ground, Shading, smoothed
from somo_cli.picture.stage import Moment, framed_points, parts_of, poses_at
from somo_cli.picture.tiny_renderer import TinyRenderer
from somo_cli.simulation.scene import Scene

SMOOTHING = 2  # pixels across, of which one of the picture is made


@dataclass(frozen=True, slots=True)
class Look:
    """From where pictures are taken, and their size: width and height in pixels."""

    view: View
    size: tuple[int, int]


def pictures(scene: Scene, moments: Sequence[Moment], look: Look) -> Iterator[Array]:
    """Yield a picture of each moment, shape (height, width, 3), bytes; all are framed at once.

    Raises EngineMissing.
    """
    parts = parts_of(scene)
    poses = [poses_at(scene, parts, moment) for moment in moments]
    points = np.concatenate([framed_points(parts, one) for one in poses])
    camera = framing(points, look.view, look.size)
    radius = radius_of(points)
    size = (look.size[0] * SMOOTHING, look.size[1] * SMOOTHING)
    shader = Shading(camera, size, parts, _ground(scene, points, radius))
    light = shader.direction
    with TinyRenderer(parts, radius) as renderer:
        for one in poses:
            renderer.place(one)
            lamp = shadows.lamp(framed_points(parts, one), light)
            seen_by_lamp = renderer.look(lamp.camera, (shadows.MAP, shadows.MAP), light)
            raster = renderer.look(camera, size, light)
            yield smoothed(shader.picture(raster, lamp, seen_by_lamp), SMOOTHING)


def _ground(scene: Scene, points: Array, radius: float) -> Ground | None:
    if scene.ground is None:
        return None
    x, y, _ = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return Ground(scene.ground.height, shading.square_of(radius), (float(x), float(y)), radius)
