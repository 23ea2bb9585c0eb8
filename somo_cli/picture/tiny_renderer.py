"""The software renderer of PyBullet: which part is seen in each pixel, how far away and how lit.

It has an engine of its own, without physics, which holds surfaces at given poses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.picture.camera import Camera
from somo_cli.picture.drawn_parts import Part
from somo_cli.picture.facets import Array
from somo_cli.simulation.engine.bullet.c_stdio import captured_output
from somo_cli.simulation.engine.bullet.client import BulletClient

AMBIENT, DIFFUSE, SPECULAR = 0.62, 0.42, 0.06
"""Shares of a surface's colour: in shadow, added in full light, and added as gloss."""

_SWELL = 3e-4  # enlargement of a part, relative to its size


@dataclass(frozen=True, slots=True)
class Raster:
    """What a camera sees, arrays of shape (height, width, ...), the top row first.

    `colours` are red, green and blue [0 to 255] without shadows; `distances` are along the axis of
    the camera [m], infinite where nothing is seen; `parts` are numbers of parts, -1 for none.
    """

    colours: Array
    distances: Array
    parts: Array


class TinyRenderer:
    """The parts of a scene in the renderer; `unit` is the renderer's unit of length [m]."""

    def __init__(self, parts: Sequence[Part], unit: float) -> None:
        self._parts = parts
        self._unit = unit
        self._client: BulletClient | None = None

    def __enter__(self) -> TinyRenderer:
        """Load every part. Raises EngineMissing."""
        with captured_output():
            self._client = BulletClient("the renderer is that of PyBullet, which is")
            try:
                for number, part in enumerate(self._parts):
                    loaded = self._load(part, number)
                    assert loaded == number, "the raster identifies parts by these numbers"
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
        """Close the connection to the renderer."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def place(self, poses: Sequence[Pose]) -> None:
        """Move every part to its pose in the world [m]."""
        client = self._opened()
        for number, pose in enumerate(poses):
            client.resetBasePositionAndOrientation(
                number,
                [value / self._unit for value in pose.position],
                geometry.quaternion_from_rotation(pose.rotation),
            )

    def render(self, camera: Camera, size: tuple[int, int], light: Array) -> Raster:
        """Return what a camera sees; `light` is the unit vector towards the light."""
        client = self._opened()
        width, height = size
        near, far = camera.near / self._unit, camera.far / self._unit
        # seen in 3.2.7: its own shadows have a bias of a fixed length and hold for one distance of
        # the light only, and a projection without perspective shows nothing
        image = client.getCameraImage(
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
            renderer=client.ER_TINY_RENDERER,
        )
        # PyBullet built without numpy returns tuples
        colours = np.asarray(image[2], np.uint8).reshape(height, width, 4)[..., :3]
        depths = np.asarray(image[3], np.float32).reshape(height, width)
        parts = np.asarray(image[4], np.int32).reshape(height, width)
        distances = near * far / (far - (far - near) * depths) * np.float32(self._unit)
        return Raster(colours, np.where(parts < 0, np.float32(np.inf), distances), parts)

    def _load(self, part: Part, number: int) -> int:
        client = self._opened()
        # of coplanar faces of two links one must be in front, or pixels would alternate
        factor = (1 + _SWELL * (number % 3 + (3 if part.is_box else 0))) / self._unit
        shape = client.createVisualShape(
            client.GEOM_MESH,
            vertices=(part.facets.vertices * factor).tolist(),
            normals=part.facets.normals.tolist(),
            indices=part.facets.triangles.ravel().tolist(),
            rgbaColor=[*part.colour, 1.0],
        )
        index: int = client.createMultiBody(0, -1, shape)
        return index

    def _opened(self) -> BulletClient:
        assert self._client is not None, "a renderer is used inside its with block"
        return self._client


def _view(camera: Camera, unit: float) -> list[float]:
    """Return OpenGL's view matrix, from world to camera axes, column by column."""
    right, up, forward = camera.axes
    axes = np.stack([right, up, -forward])
    whole = np.eye(4)
    whole[:3, :3] = axes
    whole[:3, 3] = -axes @ camera.eye / unit
    values: list[float] = whole.T.ravel().tolist()
    return values


def _projection(tangents: tuple[float, float], near: float, far: float) -> list[float]:
    """Return OpenGL's perspective projection, column by column."""
    across, upward = tangents
    depth, shift = -(far + near) / (far - near), -2 * far * near / (far - near)
    return [1 / across, 0, 0, 0, 0, 1 / upward, 0, 0, 0, 0, depth, -1, 0, 0, shift, 0]
