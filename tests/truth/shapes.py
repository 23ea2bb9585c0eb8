"""Objects of other shapes than boxes: their height at rest, and a capsule that rolls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

from tests.truth.table import Row
from tests.truth.touching import last_row, with_cubes

EDGE = 0.06  # m
STEP = 1e-3  # s
_QUADS = ("1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6")


def mesh_of_a_cube() -> str:
    """Return the OBJ text of a cube about its centre."""
    corners = [(x, y, z) for z, y, x in product((-EDGE / 2, EDGE / 2), repeat=3)]
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in corners]
    return "\n".join([*lines, *(f"f {quad}" for quad in _QUADS)])


def cubes() -> dict[str, dict[str, object]]:
    """Return one cube, described three times, each of 100 g and at rest on the ground."""
    plain = {"name": "cube", "mass": 0.1, "position": [0, 0, EDGE / 2]}
    box = {**plain, "dimensions": [EDGE] * 3}
    mesh = {"mesh": {"source": "cube.obj", "text": mesh_of_a_cube()}, "shape_type": "mesh"}
    return {"box": box, "rounded box": {**box, "edge_radius": 0.005}, "mesh": {**plain, **mesh}}


def rows() -> Iterator[Row]:
    """Yield every row about shapes."""
    for name, cube in cubes().items():
        for scale in (1, 20):
            found = last_row(with_cubes(cube, world_scale=scale), STEP, 0.5)["cube.pose.z_m"]
            what = "height of a cube of 60 mm at rest on the ground [m]"
            yield Row(what, name, f"scale {scale}", found, EDGE / 2, abs(found - EDGE / 2))
    pill = {
        "name": "cube",
        "shape_type": "capsule",
        "dimensions": [0.06, 0.01],
        "position": [0, 0, 0.01],
        "rpy": [math.pi / 2, 0, 0],
        "linear_velocity": [0.2, 0, 0],
        "angular_velocity": [0, 20, 0],
    }
    for scale in (1, 20):
        found = last_row(with_cubes(pill, world_scale=scale), STEP, 1.0)["cube.pose.x_m"]
        what = "distance of a capsule that rolls for a second [m], relative error"
        yield Row(what, "0.2 m/s", f"scale {scale}", found, 0.2, abs(found / 0.2 - 1))
