"""Total rotation of an object since the start, counted beyond full turns."""

from __future__ import annotations

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector


class RotationCounter:
    """The time integral of the angular velocity, by its components in the world's axes [rad].

    Between two updates the object is assumed to turn about one axis by less than half a turn. About
    an axis of fixed direction this is the angle itself, however many turns; unlike roll, pitch and
    yaw it jumps in no pose. An axis that goes round a cone adds the solid angle of the cone in
    each turn, as rotations do.
    """

    def __init__(self, rotation: Matrix) -> None:
        self._last_rotation = rotation
        self._total: Vector = geometry.ZERO

    def update(self, rotation: Matrix) -> None:
        """Add the rotation since the last update."""
        self._total = self.at(rotation)
        self._last_rotation = rotation

    def at(self, rotation: Matrix) -> Vector:
        """Return the total rotation at an orientation, without counting it."""
        change = geometry.multiply(rotation, geometry.transposed(self._last_rotation))
        return geometry.add(self._total, geometry.rotation_vector(change))
