"""What a picture costs: the renderer, and what is made of it, with and without smooth edges.

Run by `make bench`. Pictures are taken in turn, round after round; printed are medians of the time
for one of 960 x 720 pixels, loading and the run before it left out.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from somo_cli.picture import shadows
from somo_cli.picture.camera import VIEWS, framing, radius_of
from somo_cli.picture.drawn_parts import framed_points, parts_of, poses_at, start_configuration
from somo_cli.picture.shading import Ground, Shading, smoothed, tile_edge
from somo_cli.picture.tiny_renderer import TinyRenderer
from tests.builders.scenes import scene_from_file

SIZE = (960, 720)
ROUNDS = 7
SCENES = ("scene.yaml", "hand_scene.yaml", "lift_scene.yaml")


def times_of(name: str, smoothing: int) -> tuple[float, float]:
    """Return the median times [s] of the renderer, twice a picture, and of all behind it."""
    scene = scene_from_file(name)
    parts = parts_of(scene)
    poses = poses_at(scene, parts, start_configuration(scene))
    points = framed_points(parts, poses)
    radius = radius_of(points)
    camera = framing(points, VIEWS["oblique"], SIZE)
    size = (SIZE[0] * smoothing, SIZE[1] * smoothing)
    ground = None
    if scene.ground is not None:
        ground = Ground(scene.ground.height, tile_edge(radius), (0.0, 0.0), radius)
    shader = Shading(camera, size, parts, ground)
    light = shader.direction
    rendering, shading = [], []
    with TinyRenderer(parts, radius) as renderer:
        renderer.place(poses)
        lamp = shadows.lamp(points, light)
        for _ in range(ROUNDS):
            started = time.perf_counter()
            seen_by_lamp = renderer.render(lamp.camera, (shadows.MAP, shadows.MAP), light)
            raster = renderer.render(camera, size, light)
            rendered = time.perf_counter()
            picture = smoothed(shader.picture(raster, lamp, seen_by_lamp), smoothing)
            assert picture.dtype == np.uint8
            rendering.append(rendered - started)
            shading.append(time.perf_counter() - rendered)
    return statistics.median(rendering), statistics.median(shading)


def main() -> None:
    """Print the time of a picture, scene by scene."""
    for name in SCENES:
        for smoothing in (1, 2):
            rendering, shading = times_of(name, smoothing)
            whole = rendering + shading
            edges = "smooth edges" if smoothing > 1 else "plain edges "
            share = rendering / whole
            print(f"{name:16} {edges}  {1e3 * whole:4.0f} ms, {share:.0%} of it the renderer")


if __name__ == "__main__":
    main()
