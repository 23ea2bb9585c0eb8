"""Predict how contact forces change in a step, for all bodies and objects that touch.

The law measures the forces beside its own, and those of contact are a step old. Where contact holds
a body, that delay acts as negative damping, which grows with B M^-1 of light, fast joints: a grasp
shakes. So the change of contact forces in the coming step is predicted, for all that touch
together (see `contact_change`), and the accelerations of the law get its effect. At rest nothing
changes, so equilibria stay exact. Where nothing presses nothing runs.

Points that do not press yet are left out: predicted too early, they threw objects away.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TypeAlias

from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.engine.pressing import ContactReader, Pair
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_coordinates import Object, Part, coordinates_of
from somo_cli.simulation.integrator.coupled_contact import CoupledContact
from somo_cli.simulation.plan.model import Plan

MOST_POINTS = 24  # more pressing points are not predicted: a step would take many times as long
STEPS_KEPT = 8  # for which the geometry of contact is reused while the same points press
MOST_KNOWN = 1000  # sets of points of which is kept where they are felt

Felt: TypeAlias = tuple[Sequence[int], Sequence[int]]
"""Which points the law of some body feels, and which parts are there."""


class ContactPrediction:
    """Applies the torques of all bodies, in touch and out of it."""

    def __init__(
        self, plan: Plan, world: World, reader: ContactReader, steppers: Sequence[BodyStepper]
    ) -> None:
        self._reader = reader
        self._steppers = steppers
        self._step = plan.time_step
        objects = [
            Object(thing, not planned.rigid_object.has_prescribed_pose)
            for thing, planned in zip(world.objects, plan.objects, strict=True)
        ]
        bodies = [coordinates_of(stepper) for stepper in steppers]
        self._parts: list[Part] = [*bodies, *objects]
        observed: list[Part] = [*(one for one in bodies if one.size > one.joints), *objects]
        self._observers = [part.observe for part in observed]
        self._seen = 0  # steps in a row in which something was near
        self._known: dict[tuple[Hashable, ...], Felt] = {}
        self._keys: Sequence[Hashable] = ()  # which links press, at all points
        self._felt: Felt = ((), ())
        self._contact: CoupledContact | None = None
        self._age = 0

    def apply(self, is_check: bool) -> None:
        """Apply the torques of the coming step; `is_check` if motion is checked at its start."""
        if not self._is_felt():
            for stepper in self._steppers:
                (stepper.apply_at_check if is_check else stepper.apply_torques)()
            return
        for stepper in self._steppers:
            stepper.predict(is_check)
        changes = self._present_contact().changes(self._reader.forces())
        for number, stepper in enumerate(self._steppers):
            stepper.finish(changes.get(number))

    def _is_felt(self) -> bool:
        """Whether a contact presses that the law of some body feels; takes what presses."""
        keys = self._reader.pressing()
        if keys is None:
            self._seen, self._keys, self._felt, self._contact = 0, (), ((), ()), None
            return False
        self._seen += 1
        for observe in self._observers:
            observe()
        if self._seen < 2:
            return False
        if keys != self._keys:
            self._follow(keys)
        kept = self._felt[0]
        return 0 < len(kept) <= MOST_POINTS

    def _follow(self, keys: Sequence[Hashable]) -> None:
        """Find which of the points that press now are felt; the contact stays if they are known."""
        felt = self._known.get(tuple(keys))
        if felt is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            felt = self._known[tuple(keys)] = connected(self._reader.pairs(), self._parts)
        before = [self._keys[index] for index in self._felt[0]]
        if before != [keys[index] for index in felt[0]]:
            self._contact = None
        self._keys, self._felt = keys, felt
        self._reader.follow(felt[0])

    def _present_contact(self) -> CoupledContact:
        """Return the contact at the points that are felt, its geometry renewed where it is old."""
        contact = self._contact
        self._age += 1
        if contact is not None and self._age < STEPS_KEPT:
            return contact
        self._age = 0
        points = self._reader.points()
        if contact is None or not contact.is_still(points):
            parts = [(number, self._parts[number]) for number in self._felt[1]]
            contact = self._contact = CoupledContact(points, parts, self._reader, self._step)
        contact.renew()
        return contact


def connected(pairs: Sequence[Pair], parts: Sequence[Part]) -> Felt:
    """Return the contacts that act on a law, directly or through movable parts, and those parts."""
    count = len(parts)
    reached = {number for number in range(count) if parts[number].joints}
    left = set(range(len(pairs)))
    kept: set[int] = set()
    grew = True
    while grew:
        grew = False
        for index in sorted(left):
            sides = {pairs[index][0][0], pairs[index][1][0]}
            if not any(
                side in reached and parts[side].links_others for side in sides if side < count
            ):
                continue
            left.discard(index)
            kept.add(index)
            reached |= sides
            grew = True
    touched = {side for index in kept for side in (pairs[index][0][0], pairs[index][1][0])}
    return sorted(kept), sorted(side for side in touched if side < count)
