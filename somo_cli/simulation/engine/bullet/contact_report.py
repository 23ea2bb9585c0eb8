"""Report the contacts of the last step, with bodies and links numbered as in the plan."""

from __future__ import annotations

from collections.abc import Mapping

from somo_cli.simulation.engine.bullet.last_contacts import (
    NORMAL_FORCE,
    EngineLinkId,
    LastContacts,
)
from somo_cli.simulation.engine.bullet.step_corrections import StepCorrections
from somo_cli.simulation.engine.contacts import (
    BodyPair,
    ContactPoint,
    LinkIndex,
    friction_contact,
)


class ContactReport:
    """Reports contacts as the interface of an engine has them.

    `places` maps links as the engine numbers them to those of the plan.
    """

    def __init__(
        self,
        contacts: LastContacts,
        corrections: StepCorrections,
        places: Mapping[EngineLinkId, LinkIndex],
    ) -> None:
        self.places = places
        self.count = 0
        """The number of contact points when `penetrations` was called last."""
        self._contacts = contacts
        self._corrections = corrections
        self._body_numbers = {body: number for (body, _), (number, _) in places.items()}

    def contact_points(self) -> list[ContactPoint]:
        """Return every contact point in the engine's order, then the friction forces we applied."""
        places = self.places
        found = [
            ContactPoint(
                places[one.first_body, one.first_link],
                places[one.second_body, one.second_link],
                one.on_first,
                one.normal,
                one.normal_force,
                ((one.tangent_1, one.friction_1), (one.tangent_2, one.friction_2)),
            )
            for one in self._contacts.points()
        ]
        for key, point, force in self._corrections.applied:
            found.append(friction_contact(places[key[:2]], places[key[2:]], point, force))
        return found

    def penetrations(self) -> list[tuple[LinkIndex, LinkIndex, float]]:
        """Return each pair of links that overlapped, and its depth, above 0."""
        places = self.places
        reported = self._contacts.points()
        self.count = len(reported)
        self._corrections.check(reported)
        return [
            (
                places[one.first_body, one.first_link],
                places[one.second_body, one.second_link],
                -one.gap,
            )
            for one in reported
            if one.gap < 0
        ]

    def normal_forces(self) -> dict[BodyPair, float]:
        """Return the sum of normal forces of each pair of bodies that pressed."""
        numbers, found = self._body_numbers, dict[BodyPair, float]()
        for point in self._contacts.reported():
            force = point[NORMAL_FORCE]
            if force > 0:
                a, b = numbers[point[1]], numbers[point[2]]
                pair = (a, b) if a <= b else (b, a)
                found[pair] = found.get(pair, 0.0) + force
        return found
