"""The software renderer of PyBullet: which part is seen in each pixel, how far away and how lit.

An engine of its own, without physics: it holds surfaces and is told where they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.picture.camera import Camera
from somo_cli.picture.drawn_parts import Part
from somo_cli.picture.facets import Array
from somo_cli.simulation.engine.bullet.c_stdio import captured_output
from somo_cli.simulation.engine.bullet.client import BulletClient

AMBIENT, DIFFUSE, SPECULAR = 0.62, 0.42, 0.06
"""How much of its colour a surface shows in the shadow, how much more in full light, and gloss."""

_SWELL = 3e-4  # of the size of a part


@dataclass(frozen=True, slots=True)
class Raster:
    """What a camera sees, arrays of shape (height, width, ...), rows from above.

    Red, green and blue [0 to 255] without shadows, the distance along the axis of the camera [m],
    infinite where there is nothing, and the number of the part, -1 for none.
    """

    colours: Array
    distances: Array
    parts: Array


class TinyRenderer:
    """Parts of a scene in the renderer; lengths are handed to it in so many metres (`unit`)."""

    def __init__(self, parts: Sequence[Part], unit: float) -> None:
        self._parts = parts
        self._unit = unit
        self._engine: Any = None  # a BulletClient, once entered

    def __enter__(self) -> TinyRenderer:
        """Load every part."""
        with captured_output():
            self._engine = BulletClient("the renderer is that of PyBullet, which is")
            try:
                for number, part in enumerate(self._parts):
                    assert self._load(part, number) == number  # what the renderer calls it
            except BaseException:
                self.close()
                raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave the engine."""
        if self._engine is not None:
            self._engine.close()

    def place(self, poses: Sequence[Pose]) -> None:
        """Put every part where it is in the world [m]."""
        for number, pose in enumerate(poses):
            self._engine.resetBasePositionAndOrientation(
                number,
                [value / self._unit for value in pose.position],
                geometry.quaternion_from_rotation(pose.rotation),
            )

    def render(self, camera: Camera, size: tuple[int, int], light: Array) -> Raster:
        """Return what a camera sees in a light that comes from a direction, a unit vector."""
        width, height = size
        near, far = camera.near / self._unit, camera.far / self._unit
        # seen in 3.2.7: its own shadows have a bias of a fixed length and hold for one distance of
        # the light only, and a projection without perspective shows nothing
        told = self._engine.getCameraImage(
            width,
            height,
            _view(camera, self._unit),
            _projection(camera.tangents, near, far),
            lightDirection=light.tolist(),
            lightColor=[1, 1, 1],
            lightAmbientCoeff=AMBIENT,
            lightDiffuseCoeff=DIFFUSE,
            lightSpecularCoeff=SPECULAR,
            shadow=0,
            renderer=self._engine.ER_TINY_RENDERER,
        )
        # where numpy was not at hand when the engine was built, these are tuples
        colours = np.asarray(told[2], np.uint8).reshape(height, width, 4)[..., :3]
        depths = np.asarray(told[3], np.float32).reshape(height, width)
        parts = np.asarray(told[4], np.int32).reshape(height, width)
        distances = near * far / (far - (far - near) * depths) * np.float32(self._unit)
        return Raster(colours, np.where(parts < 0, np.float32(np.inf), distances), parts)

    def _load(self, part: Part, number: int) -> int:
        engine = self._engine
        # where faces of two links lie in one plane, one of them must be in front
        factor = (1 + _SWELL * (number % 3 + (3 if part.is_box else 0))) / self._unit
        shape = engine.createVisualShape(
            engine.GEOM_MESH,
            vertices=(part.facets.vertices * factor).tolist(),
            normals=part.facets.normals.tolist(),
            indices=part.facets.triangles.ravel().tolist(),
            rgbaColor=[*part.colour, 1.0],
        )
        index: int = engine.createMultiBody(0, -1, shape)
        return index


def _view(camera: Camera, unit: float) -> list[float]:
    """Return the world as the camera has it: OpenGL's matrix, column after column."""
    right, up, forward = camera.axes
    axes = np.stack([right, up, -forward])
    whole = np.eye(4)
    whole[:3, :3] = axes
    whole[:3, 3] = -axes @ camera.eye / unit
    values: list[float] = whole.T.ravel().tolist()
    return values


def _projection(tangents: tuple[float, float], near: float, far: float) -> list[float]:
    """Return OpenGL's perspective, column after column."""
    across, upward = tangents
    depth, shift = -(far + near) / (far - near), -2 * far * near / (far - near)
    return [1 / across, 0, 0, 0, 0, 1 / upward, 0, 0, 0, 0, depth, -1, 0, 0, shift, 0]
