"""Round bodies on soft ground in PyBullet: correct the torque of stale contact points.

Seen in 3.2.7: a pair of shapes gets one new contact point in a step. An old point stays where it
was on the body while it is in the ground, however far the body has rolled, unless a new one is near
it. On a cylinder of radius r that has sunk by d it presses up to sqrt(2 r d) behind the line on
which the cylinder stands, and drives it on: a capsule or a lying cylinder rolls faster and faster,
and a snake at rest begins to roll. The normal force belongs on the deepest line, at the same place
along the axis. A torque moves it there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.scene.round_body import RoundBody, torque
from somo_cli.simulation.engine.bullet.client import BulletClient

Place = tuple[int, int]
"""A link of the engine: body and link."""


class RollingAdapter:
    """Corrects, before a step, what stale contact points did to round links in the last.

    `rounds` are in the inertial frames of their links.
    """

    def __init__(
        self,
        engine: BulletClient,
        time_step: float,
        ground: int,
        rounds: Mapping[Place, RoundBody],
    ) -> None:
        self._engine = engine
        self._time_step = time_step
        self._ground = ground
        self._rounds = rounds

    def apply(self) -> None:
        """Apply the torques that move the normal forces of the last step to where bodies stand."""
        engine = self._engine
        poses: dict[Place, tuple[Vector, Matrix]] = {}
        torques: dict[Place, Vector] = {}
        for one in engine.getContactPoints():
            if one[9] <= 0 or self._ground not in one[1:3]:
                continue
            place = (one[1], one[3]) if one[2] == self._ground else (one[2], one[4])
            if place in self._rounds:
                pose = poses.get(place) or poses.setdefault(place, self._pose(place))
                turn = self._torque(one, self._rounds[place], pose)
                torques[place] = geometry.add(torques.get(place, geometry.ZERO), turn)
        for place, turn in torques.items():
            engine.applyExternalTorque(*place, turn, engine.WORLD_FRAME)

    def _torque(self, reported: Any, body: RoundBody, pose: tuple[Vector, Matrix]) -> Vector:
        """Return the torque for one contact point, as the engine reports it, in the world."""
        centre, axes = pose
        is_first = reported[2] == self._ground
        sign = 1.0 if is_first else -1.0
        x, y, z = (sign * component for component in reported[7])
        size = reported[9]
        point = geometry.subtract(reported[5] if is_first else reported[6], centre)
        back = geometry.transposed(axes)
        offset = body.offset_to_line(geometry.rotate(back, point), geometry.rotate(back, (x, y, z)))
        return torque(geometry.rotate(axes, offset), (size * x, size * y, size * z))

    def _pose(self, place: Place) -> tuple[Vector, Matrix]:
        """Return the pose of a link at the start of the last step, when points were found."""
        engine = self._engine
        body, link = place
        if link >= 0:
            state = engine.getLinkState(body, link, 1, 0)
            return state[0], geometry.rotation_from_quaternion(state[1])
        centre, turn = engine.getBasePositionAndOrientation(body)
        velocity, spin = engine.getBaseVelocity(body)
        back = -self._time_step
        x, y, z = (back * rate for rate in velocity)
        axes = geometry.rotation_from_quaternion(turn)
        rate = geometry.norm(spin)
        if rate > 0:
            turned = geometry.rotation_about(geometry.unit(spin), back * rate)
            axes = geometry.multiply(turned, axes)
        return geometry.add(centre, (x, y, z)), axes
