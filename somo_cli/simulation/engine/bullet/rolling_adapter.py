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

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.scene.round_body import RoundBody
from somo_cli.simulation.engine.bullet.engine_links import EngineLinks, axes_at_contact
from somo_cli.simulation.engine.bullet.last_contacts import (
    EngineContact,
    EngineLinkId,
    LastContacts,
)


class RollingAdapter:
    """Corrects, before a step, the effect of stale contact points on round links in the last step.

    `rounds` are in the inertial frames of their links.
    """

    def __init__(
        self,
        links: EngineLinks,
        contacts: LastContacts,
        time_step: float,
        ground: int,
        rounds: Mapping[EngineLinkId, RoundBody],
    ) -> None:
        self._links = links
        self._contacts = contacts
        self._time_step = time_step
        self._ground = ground
        self._rounds = rounds

    def apply(self) -> None:
        """Apply the torques that move the normal forces of the last step to where bodies stand."""
        poses: dict[EngineLinkId, tuple[Vector, Matrix]] = {}
        torques: dict[EngineLinkId, Vector] = {}
        for one in self._contacts.points():
            is_first = one.second_body == self._ground
            if one.normal_force <= 0 or not (is_first or one.first_body == self._ground):
                continue
            place = one.key[:2] if is_first else one.key[2:]
            if place in self._rounds:
                pose = poses.get(place) or poses.setdefault(place, self._pose(place))
                turn = self._torque(one, self._rounds[place], pose)
                torques[place] = geometry.add(torques.get(place, geometry.ZERO), turn)
        for place, turn in torques.items():
            self._links.apply_torque(place, turn)

    def _torque(
        self, contact: EngineContact, body: RoundBody, pose: tuple[Vector, Matrix]
    ) -> Vector:
        """Return the torque for one contact point, in the world."""
        centre, axes = pose
        is_first = contact.second_body == self._ground
        sign = 1.0 if is_first else -1.0
        x, y, z = (sign * component for component in contact.normal)
        size = contact.normal_force
        point = geometry.subtract(contact.on_first if is_first else contact.on_second, centre)
        back = geometry.transposed(axes)
        offset = body.offset_to_line(geometry.rotate(back, point), geometry.rotate(back, (x, y, z)))
        return geometry.cross(geometry.rotate(axes, offset), (size * x, size * y, size * z))

    def _pose(self, place: EngineLinkId) -> tuple[Vector, Matrix]:
        """Return the pose of a link at the start of the last step, when points were found."""
        state = self._links.state_at_contact(place, self._time_step)
        return state.centre, axes_at_contact(place, state, self._time_step)
