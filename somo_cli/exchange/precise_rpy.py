"""Roll, pitch and yaw that give a rotation back to rounding, also near a pitch of ±π/2."""

from __future__ import annotations

import math

from somo_cli.manipulator.geometry import Matrix, Vector


def precise_rpy(r: Matrix) -> Vector:
    """Return URDF's roll, pitch, yaw [rad] of a rotation.

    Near a pitch of ±π/2 roll and yaw turn about one axis: the roll is then known badly, and the yaw
    is the one that fits it, taken from R Rx(-roll), not from what is left of the first column.
    """
    flat = math.hypot(r[0][0], r[1][0])
    pitch = math.atan2(-r[2][0], flat)
    roll = math.atan2(r[2][1], r[2][2]) if flat > 1e-12 else 0.0
    s, c = math.sin(roll), math.cos(roll)
    yaw = math.atan2(s * r[0][2] - c * r[0][1], c * r[1][1] - s * r[1][2])
    return (roll, pitch, yaw)
