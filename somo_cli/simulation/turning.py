"""How far an object has turned since the start, counted beyond full turns."""

from __future__ import annotations

import math

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector

_SMALL = 1e-8  # rad of half an angle, below which a sine is its angle to rounding


class TurnCounter:
    """The time integral of the angular velocity, by its components in the world's axes [rad].

    From look to look an object is taken to turn about one axis by less than half a turn. About an
    axis that keeps its direction this is the angle itself, however many turns; there is no pose in
    which it jumps, as roll, pitch and yaw do. An axis that goes round a cone adds, turn by turn,
    the angle that the cone leaves behind: that is in the nature of rotations.
    """

    def __init__(self, rotation: Matrix) -> None:
        self._last = rotation
        self._turned: Vector = geometry.ZERO

    def look(self, rotation: Matrix) -> None:
        """Count what it has turned since the last look."""
        self._turned = self.at(rotation)
        self._last = rotation

    def at(self, rotation: Matrix) -> Vector:
        """Return how far it has turned if it is here now; this counts nothing."""
        change = geometry.multiply(rotation, geometry.transposed(self._last))
        return geometry.add(self._turned, rotation_vector(change))


def rotation_vector(rotation: Matrix) -> Vector:
    """Return axis times angle [rad], 0 to π, of a rotation."""
    x, y, z, w = geometry.quaternion_from_rotation(rotation)
    sine = math.hypot(x, y, z)
    factor = 2.0 if sine < _SMALL else 2 * math.atan2(sine, w) / sine
    return (factor * x, factor * y, factor * z)
