"""Sliding friction in PyBullet: find what is missing after a step, and apply it before the next.

Seen in 3.2.7, and read in its btMultiBodyConstraintSolver: the two friction rows of a contact lie
along fixed tangents of the world (btPlaneSpace1 of the normal). Each computes the impulse that
stops its own tangent, by the inverse mass there, and then both are scaled to the limit together.
With `useMaximalCoordinates` the tangents follow the slip, but links cannot have it. No parameter
makes them follow: more iterations, a smaller step and warm starting change nothing, and a pyramid
in place of the cone is worse. See `sliding_friction` for the law.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from somo_cli.simulation.engine.bullet.engine_links import EngineLinks
from somo_cli.simulation.engine.bullet.last_contacts import (
    ContactKey,
    EngineContact,
    EngineLinkId,
    LastContacts,
)
from somo_cli.simulation.engine.bullet.sliding_friction import (
    LinkMotion,
    MissingFriction,
    Point,
    SlidingLink,
    missing_friction,
)

LIMIT_RATIO = 0.999  # of the friction limit: below it, a point sticks
STARTING_STEPS = 16  # with a check in each; later sliding is found at the next check of contact


class SlidingAdapter:
    """Corrects the direction of sliding friction from step to step.

    Call `apply` before every step: it does nothing unless a sliding contact lacks some friction.
    Call `check` at intervals: it finds contacts that have begun to slide.
    """

    def __init__(
        self,
        links: EngineLinks,
        contacts: LastContacts,
        time_step: float,
        frictions: Mapping[EngineLinkId, float],
    ) -> None:
        self._links = links
        self._contacts = contacts
        self._time_step = time_step
        self._frictions = frictions
        self._limits: dict[ContactKey, float] = {}  # squares of products of coefficients
        self._masses: dict[EngineLinkId, tuple[float, float]] = {}
        self._missing: dict[ContactKey, MissingFriction] = {}
        self._sliding: dict[ContactKey, list[Point]] | None = None  # as found by `check`
        self._first = STARTING_STEPS
        self.is_active = True
        self.applied: list[tuple[ContactKey, Sequence[float], Sequence[float]]] = []
        """The friction applied in the last step: both links, the point, the force on the first."""

    def check(self, reported: Iterable[EngineContact]) -> None:
        """Begin to correct if a contact of the last step slides, as the engine reports it."""
        if not self.is_active:
            self._sliding = self._sliding_points(reported)
            self.is_active = bool(self._sliding)

    def apply(self) -> None:
        """Apply the friction that was missing in the last step."""
        if not self.is_active:
            return
        sliding = self._sliding
        if sliding is None:
            sliding = self._sliding_points(self._contacts.points())
        self._sliding = None
        self.applied = []
        lacking: dict[ContactKey, MissingFriction] = {}
        links: dict[EngineLinkId, SlidingLink] = {}
        self.is_active = self._first > 0
        self._first -= 1
        for key, points in sliding.items():
            own, other = key[:2], key[2:]
            for place in (own, other):
                if place not in links:
                    links[place] = SlidingLink(self._moving(place), *self._mass(place))
            found = missing_friction(links[own], links[other], points, self._time_step)
            if found is not None and not found.is_negligible:
                self.is_active = True
                lacking[key] = found = found.after(self._missing.get(key))
                self._push(key, found)
        self._missing = lacking

    def _sliding_points(self, reported: Iterable[EngineContact]) -> dict[ContactKey, list[Point]]:
        """Return the contact points whose friction is at its limit, by their links."""
        found: dict[ContactKey, list[Point]] = {}
        limits = self._limits
        for one in reported:
            normal = one.normal_force
            if normal > 0:
                a, b = one.friction_1, one.friction_2
                key = one.first_body, one.first_link, one.second_body, one.second_link
                least = limits.get(key)
                if least is None:
                    least = limits[key] = self._limit(key)
                if 0 < least * normal * normal <= a * a + b * b:
                    tangents = one.tangent_1, one.tangent_2
                    point = Point(one.on_first, one.normal, tangents, (a, b))
                    found.setdefault(key, []).append(point)
        return found

    def _limit(self, key: ContactKey) -> float:
        limit = LIMIT_RATIO * self._frictions[key[:2]] * self._frictions[key[2:]]
        return limit * limit

    def _mass(self, place: EngineLinkId) -> tuple[float, float]:
        """Return one over mass and over least moment of inertia of a link; 0 if fixed."""
        known = self._masses.get(place)
        if known is None:
            mass, moments = self._links.mass_and_moments(place)
            known = (1 / mass, 1 / min(moments)) if mass > 0 else (0.0, 0.0)
            self._masses[place] = known
        return known

    def _moving(self, place: EngineLinkId) -> LinkMotion:
        state = self._links.state_at_contact(place, self._time_step)
        return LinkMotion(state.centre, state.velocity, state.spin)

    def _push(self, key: ContactKey, found: MissingFriction) -> None:
        """Apply a wrench to the first link of a pair, the opposite to the other."""
        self.applied.append((key, found.point, found.force))
        (fx, fy, fz), (tx, ty, tz) = found.force, found.torque
        links, own, other = self._links, key[:2], key[2:]
        has_torque = tx != 0 or ty != 0 or tz != 0  # of one point it is none
        if self._mass(own)[0] > 0:
            links.apply_force(own, (fx, fy, fz), found.point)
            if has_torque:
                links.apply_torque(own, (tx, ty, tz))
        if self._mass(other)[0] > 0:
            links.apply_force(other, (-fx, -fy, -fz), found.point)
            if has_torque:
                links.apply_torque(other, (-tx, -ty, -tz))
