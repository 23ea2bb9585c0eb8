"""Where a camera shows points: the inverse of its rays."""

from __future__ import annotations

import numpy as np

from somo_cli.picture.camera import Camera
from somo_cli.picture.facets import Array


def project(camera: Camera, points: Array) -> Array:
    """Return points of the world, shape (..., 3), as right, up [-1 to 1] and distance [m]."""
    own = (points - camera.eye) @ camera.axes.T
    depth = own[..., 2:]
    return np.concatenate([own[..., :2] / (depth * camera.tangents), depth], axis=-1)
