"""Predict how contact forces change in a step, for all bodies and objects that touch.

The law measures the forces beside its own, and those of contact are a step old. Where contact holds
a body, that delay acts as negative damping, which grows with B M^-1 of light, fast joints: a grasp
shakes. So the change of contact forces in the coming step is predicted, for all that touch
together (see `contact_change`), and the accelerations of the law get its effect. At rest nothing
changes, so equilibria stay exact. Where nothing presses nothing runs.

Points that do not press yet are left out: predicted too early, they threw objects away. So are
links that have just met: what was measured of an impact is gone in the next step. Four fingers that
strike a cube at 2 ms threw it up by 1.9 mm too far where they were predicted at once, by 0.2 mm
where they are six steps later. Two fingers that land on a block from above pressed it with 0.35 N
in place of 7.6 N where they were predicted at once, and were thrown off where it was two steps
later. A grasp shakes only after many steps, so it can wait. All points wait with the new ones:
where those that pressed before were predicted on, without the new ones, one start of six in-hand
runs turned the cube by 4 % more, and one hand of three diverged.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.engine.pressing import ContactReader, Pair
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_coordinates import Object, Part, coordinates_of
from somo_cli.simulation.integrator.coupled_contact import CoupledContact
from somo_cli.simulation.plan.model import Plan

MOST_POINTS = 48  # that press with friction, or three times as many without: more are not
# predicted, since a step would take many times as long
STEPS_KEPT = 8  # for which the geometry of contact is reused while the same points press
IMPACT_STEPS = 6  # in which links that have just met are not predicted
MOST_RECENT = 4  # sets of points of which the geometry is kept
MOST_KNOWN = 1000  # sets of points of which is kept where they are felt


class Felt(NamedTuple):
    """Which points the law of some body feels, which parts are there, and how many equations."""

    points: Sequence[int] = ()
    parts: Sequence[int] = ()
    rows: int = 0


@dataclass(slots=True)
class PredictionCount:
    """In how many steps a law felt contact, and in how many of them it was not predicted."""

    steps: int = 0
    felt: int = 0
    crowded: int = 0
    """Steps in which more points pressed than are predicted."""
    most_points: int = 0
    """The most points that a law felt in a step."""
    unsolved: int = 0
    """Steps in which no change of the forces was found that obeys the laws of contact."""
    first: tuple[int, Sequence[int]] | None = None
    """The first step that was not predicted, and the bodies and objects that pressed in it."""


class ContactPrediction:
    """Applies the torques of all bodies, in touch and out of it."""

    def __init__(
        self, plan: Plan, world: World, reader: ContactReader, steppers: Sequence[BodyStepper]
    ) -> None:
        self._reader = reader
        self._steppers = steppers
        self._step = plan.time_step
        objects = [
            Object(world_object, not planned.rigid_object.has_prescribed_pose)
            for world_object, planned in zip(world.objects, plan.objects, strict=True)
        ]
        bodies = [coordinates_of(stepper) for stepper in steppers]
        self._parts: list[Part] = [*bodies, *objects]
        observed: list[Part] = [*(one for one in bodies if one.size > one.joints), *objects]
        self._observers = [part.observe for part in observed]
        self._seen = 0  # steps in a row in which something was near
        self._known: dict[tuple[Hashable, ...], Felt] = {}
        self._keys: Sequence[Hashable] = ()  # which links press, at all points
        self._felt = Felt()
        self.count = PredictionCount()
        """What was predicted so far."""
        self._felt_keys: tuple[Hashable, ...] = ()
        self._waits = 0  # steps until a new contact is predicted
        self._contact: CoupledContact | None = None
        self._recent: dict[tuple[Hashable, ...], CoupledContact] = {}
        self._age = 0

    def apply(self, is_check: bool) -> None:
        """Apply the torques of the coming step; `is_check` if motion is checked at its start."""
        self.count.steps += 1
        if not self._is_felt():
            for stepper in self._steppers:
                (stepper.apply_at_check if is_check else stepper.apply_torques)()
            return
        for stepper in self._steppers:
            stepper.predict(is_check)
        changes = self._present_contact().changes(self._reader.forces())
        if not changes:
            self.count.unsolved += 1
            self._note_unpredicted()
        for number, stepper in enumerate(self._steppers):
            stepper.finish(changes.get(number))

    def _is_felt(self) -> bool:
        """Whether a contact presses that the law of some body feels; takes what presses."""
        keys = self._reader.pressing()
        if keys is None:
            self._seen, self._keys, self._felt, self._contact = 0, (), Felt(), None
            self._felt_keys = ()
            return False
        self._seen += 1
        for observe in self._observers:
            observe()
        if self._seen < 2:
            return False
        if keys != self._keys:
            self._follow(keys)
        felt, count = self._felt, self.count
        if not felt.points:
            return False
        count.felt += 1
        count.most_points = max(count.most_points, len(felt.points))
        if felt.rows > 3 * MOST_POINTS:
            count.crowded += 1
            self._note_unpredicted()
            self._contact = None
            return False
        if self._waits:
            self._waits -= 1
            return False
        return True

    def _note_unpredicted(self) -> None:
        if self.count.first is None:
            self.count.first = self.count.steps - 1, self._felt.parts

    def _follow(self, keys: Sequence[Hashable]) -> None:
        """Find which of the points that press now are felt; the contact stays if they are known."""
        felt = self._known.get(tuple(keys))
        if felt is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            felt = self._known[tuple(keys)] = self._find_felt()
        before = self._felt_keys
        self._felt_keys = tuple(keys[index] for index in felt.points)
        if not set(before).issuperset(self._felt_keys):
            self._waits = IMPACT_STEPS
        if before != self._felt_keys:
            self._contact, self._age = self._recent.get(self._felt_keys), STEPS_KEPT
        self._keys, self._felt = keys, felt
        self._reader.follow(felt.points)

    def _find_felt(self) -> Felt:
        pairs = self._reader.pairs()
        points, parts = connected(pairs, self._parts)
        frictions = [self._reader.pair(pairs[index]).friction for index in points]
        return Felt(points, parts, sum(3 if friction > 0 else 1 for friction in frictions))

    def _present_contact(self) -> CoupledContact:
        """Return the contact at the points that are felt, its geometry renewed where it is old."""
        contact = self._contact
        self._age += 1
        if contact is not None and self._age < STEPS_KEPT:
            return contact
        self._age = 0
        points = self._reader.points()
        if contact is None or not contact.is_still(points):
            parts = [(number, self._parts[number]) for number in self._felt.parts]
            contact = self._contact = CoupledContact(points, parts, self._reader, self._step)
            if all(part.has_fixed_coordinates for _, part in parts):
                self._remember(contact)
        contact.renew()
        return contact

    def _remember(self, contact: CoupledContact) -> None:
        """Keep a contact: points that bounce come and go every few steps."""
        recent = self._recent
        recent.pop(self._felt_keys, None)
        if len(recent) >= MOST_RECENT:
            del recent[next(iter(recent))]
        recent[self._felt_keys] = contact


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
