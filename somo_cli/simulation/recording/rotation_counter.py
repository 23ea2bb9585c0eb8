"""How far an object has turned since the start, counted beyond full turns."""

from __future__ import annotations

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector


class RotationCounter:
    """The time integral of the angular velocity, by its components in the world's axes [rad].

    From look to look an object is taken to turn about one axis by less than half a turn. About an
    axis that keeps its direction this is the angle itself, however many turns; there is no pose in
    which it jumps, as roll, pitch and yaw do. An axis that goes round a cone adds, turn by turn,
    the angle that the cone leaves behind: that is in the nature of rotations.
    """

    def __init__(self, rotation: Matrix) -> None:
        self._last_rotation = rotation
        self._total: Vector = geometry.ZERO

    def update(self, rotation: Matrix) -> None:
        """Count what it has turned since the last look."""
        self._total = self.at(rotation)
        self._last_rotation = rotation

    def at(self, rotation: Matrix) -> Vector:
        """Return how far it has turned if it is here now; this counts nothing."""
        change = geometry.multiply(rotation, geometry.transposed(self._last_rotation))
        return geometry.add(self._total, geometry.rotation_vector(change))
