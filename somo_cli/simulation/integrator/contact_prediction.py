"""Predict how contact forces change in a step, for all bodies and objects that touch.

The law measures the forces beside its own, and those of contact are a step old. Where contact holds
a body, that delay acts as negative damping, which grows with B M^-1 of light, fast joints: a grasp
shakes. So the change of contact forces in the coming step is predicted, for all that touch
together (see `contact_change`), and the accelerations of the law get its effect. At rest nothing
changes, so equilibria stay exact. Where nothing presses nothing runs.

Points that do not press yet are left out: predicted too early, they threw objects away.
"""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.engine.pressing import ContactReader, Pair, PressingForces
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_coordinates import Object, Part, coordinates_of
from somo_cli.simulation.integrator.coupled_contact import CoupledContact
from somo_cli.simulation.plan.model import Plan

MOST_POINTS = 24  # more pressing points are not predicted: a step would take many times as long
STEPS_KEPT = 8  # for which the geometry of contact is reused while the same points press


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
        self._observed: list[Part] = [*(one for one in bodies if one.size > one.joints), *objects]
        self._seen = 0  # steps in a row in which something was near
        self._contact: CoupledContact | None = None
        self._age = 0

    def apply(self, is_check: bool) -> None:
        """Apply the torques of the coming step; `is_check` if motion is checked at its start."""
        pressing = self._reader.pressing()
        if pressing is None:
            self._seen = 0
        else:
            self._seen += 1
            for part in self._observed:
                part.observe()
        is_felt = pressing is not None and 0 < len(pressing.keys) <= MOST_POINTS
        if pressing is None or not is_felt or self._seen < 2:
            self._contact = None
            for stepper in self._steppers:
                (stepper.apply_at_check if is_check else stepper.apply_torques)()
            return
        contact = self._contact
        if contact is not None and contact.is_void and contact.keys == pressing.keys:
            for stepper in self._steppers:
                (stepper.apply_at_check if is_check else stepper.apply_torques)()
            return
        for stepper in self._steppers:
            stepper.predict(is_check)
        changes = self._contact_of(pressing).changes(pressing)
        for number, stepper in enumerate(self._steppers):
            stepper.finish(changes.get(number))

    def _contact_of(self, pressing: PressingForces) -> CoupledContact:
        contact = self._contact
        is_same = contact is not None and contact.keys == pressing.keys
        self._age += 1
        if contact is None or not is_same or self._age >= STEPS_KEPT:
            points = self._reader.points()
            self._age = 0
            if contact is None or not is_same or not contact.is_still(points):
                kept, numbers = connected(points.pairs, self._parts)
                parts = [(number, self._parts[number]) for number in numbers]
                contact = CoupledContact(
                    pressing.keys, points, kept, parts, self._reader, self._step
                )
                self._contact = contact
            contact.renew()
        return contact


def connected(pairs: Sequence[Pair], parts: Sequence[Part]) -> tuple[list[int], list[int]]:
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
