"""Friction that depends on the direction, between the engine's steps: its contacts, our forces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.simulation.engine.bullet.anisotropic_friction import Grip, Key

Place = tuple[int, int]
"""A link of the engine: body and link."""

OnePose = tuple[Array, Array]
"""Centre and axes of the inertial frame of a link, in the world."""


@dataclass(frozen=True, slots=True)
class Skin:
    """A link in the engine and its surface; `axes` are the link's in its inertial frame."""

    body: int
    link: int
    surface: ContactSurface
    mass: float
    axes: Array

    @staticmethod
    def of(
        bullet: Any,
        client: int,
        body: int,
        link: int,
        surface: ContactSurface,
        axes: geometry.Matrix | None = None,
    ) -> Skin:
        """Return the skin of a loaded link; `axes` where the engine does not know the link's."""
        told = bullet.getDynamicsInfo(body, link, client)
        axes = axes or geometry.transposed(geometry.rotation_from_quaternion(told[4]))
        return Skin(body, link, surface, told[0], np.array(axes))


@dataclass(frozen=True, slots=True)
class Poses:
    """Of links in the world: their centres (n, 3), and the axes of the inertial frames."""

    centres: Array
    axes: Array

    def of(self, numbers: Sequence[int]) -> Poses:
        """Return the poses of these links, in this order."""
        return Poses(self.centres[numbers], self.axes[numbers])

    def seen(self, points: Array) -> Array:
        """Return a point of the world for each link, in the link's axes."""
        seen: Array = np.einsum("pji,pj->pi", self.axes, points - self.centres)
        return seen

    def placed(self, seen: Array) -> Array:
        """Return where in the world points of the links are."""
        placed: Array = self.centres + np.einsum("pij,pj->pi", self.axes, seen)
        return placed

    def back(self, time: float, velocities: Array, spins: Array) -> Poses:
        """Return where links come from that have moved so for a short time."""
        turned = np.cross(spins[:, None, :], self.axes.transpose(0, 2, 1)).transpose(0, 2, 1)
        return Poses(self.centres - time * velocities, self.axes - time * turned)


@dataclass(frozen=True, slots=True)
class Trail:
    """The poses of links now, a step ago and two steps ago.

    How fast points move is told from these, not from the velocities that the engine gives of links.
    Seen in 3.2.7: it steps velocities first, so these are those of half a step ago, but at the
    angles of now. What a link on a chain does is then off by h / 2 times its centripetal
    acceleration, more the farther it is from the base: the crawling snake was 3.8 % faster, at
    2 ms, with its base behind than with its base ahead.
    """

    now: Poses
    before: Poses
    earlier: Poses

    def of(self, numbers: Sequence[int]) -> Trail:
        """Return the trails of these links, in this order."""
        return Trail(self.now.of(numbers), self.before.of(numbers), self.earlier.of(numbers))

    def at(self, points: Array, time_step: float) -> Array:
        """Return the velocity of a point of each link now, to second order."""
        seen = self.now.seen(points)
        before = self.before.placed(seen)
        change: Array = 1.5 * (points - before) - 0.5 * (before - self.earlier.placed(seen))
        return change / time_step


@dataclass(frozen=True, slots=True)
class Touching:
    """What is known of the two links of each contact; `factors` in the inertial frame."""

    own: Trail
    other: Trail
    frictions: Array
    masses: Array
    factors: Array


class BulletGrip:
    """Applies, before a step, the friction at the contacts that the last step has found."""

    def __init__(self, bullet: Any, client: int, time_step: float, skins: Sequence[Skin]) -> None:
        self._bullet = bullet
        self._client = client
        self._time_step = time_step
        self._grip = Grip(time_step)
        self._trails: Mapping[Place, tuple[OnePose, OnePose]] = {}
        self._skins: Mapping[tuple[int, int], Skin] = {(one.body, one.link): one for one in skins}
        self.rubs: list[tuple[Key, Sequence[float], list[float]]] = []
        """What was applied for the last step: to which links, where, the force on the first."""
        self._bodies = sorted(
            {one.body for one in skins if one.surface.friction_anisotropy is not None}
        )
        self._factors: Mapping[tuple[int, int], Array] = {
            place: one.axes @ np.diag(one.surface.friction_anisotropy) @ one.axes.T
            for place, one in self._skins.items()
            if one.surface.friction_anisotropy is not None
        }

    def act(self) -> None:
        """Apply the friction for the coming step to all that touch."""
        contacts = list(self._contacts())
        self.rubs = []
        if not contacts:
            self._grip.let_go()
            self._trails = {}
            return
        told = [one for _, one in contacts]
        keys = tuple(key for key, _ in contacts)
        touching = self._touching(keys)
        points, others = (np.array([one[place] for one in told]) for place in (5, 6))
        step, axes = self._time_step, touching.own.now.axes
        slips = touching.own.at(points, step) - touching.other.at(others, step)
        forces = self._grip.forces(
            keys,
            places=touching.own.now.seen(points),
            normals=np.array([one[7] for one in told]),
            slips=slips,
            limits=touching.frictions * [one[9] for one in told],
            masses=touching.masses,
            factors=axes @ touching.factors @ axes.transpose(0, 2, 1),
        )
        for key, point, other, force, opposite in zip(
            keys, points.tolist(), others.tolist(), forces.tolist(), (-forces).tolist(), strict=True
        ):
            self.rubs.append((key, point, force))
            self._push(key[:2], force, point)
            self._push(key[2:], opposite, other)

    def _touching(self, keys: Sequence[Key]) -> Touching:
        """Return what is known of the two links of each contact."""
        places = list(dict.fromkeys(place for key in keys for place in (key[:2], key[2:])))
        numbers = {place: number for number, place in enumerate(places)}
        trail = self._follow(places)
        counts = Counter(key[:2] for key in keys)
        pairs = [(self._skins[key[:2]], self._skins[key[2:]]) for key in keys]
        masses = [
            _lighter(own.mass, other.mass) / counts[key[:2]]
            for key, (own, other) in zip(keys, pairs, strict=True)
        ]
        return Touching(
            trail.of([numbers[key[:2]] for key in keys]),
            trail.of([numbers[key[2:]] for key in keys]),
            np.array([own.surface.friction * other.surface.friction for own, other in pairs]),
            np.array(masses),
            np.array([self._factors[key[:2]] for key in keys]),
        )

    def _follow(self, places: Sequence[Place]) -> Trail:
        """Return the trails of links.

        One that touches only now came by its present velocity, and so did one that is where it was:
        it rests, or a trial step at the start of the run was undone.
        """
        told = zip(*map(self._ask, places), strict=True)
        centres, axes, velocities, spins = map(np.array, told)
        now = Poses(centres, axes)
        before, earlier = (
            now.back(time, velocities, spins) for time in (self._time_step, 2 * self._time_step)
        )
        for number, place in enumerate(places):
            known = self._trails.get(place)
            if known is None or np.array_equal(known[0][0], centres[number]):
                continue
            (before.centres[number], before.axes[number]), older = known
            earlier.centres[number], earlier.axes[number] = older
        self._trails = {
            place: ((centres[number], axes[number]), (before.centres[number], before.axes[number]))
            for number, place in enumerate(places)
        }
        return Trail(now, before, earlier)

    def _contacts(self) -> Iterator[tuple[Key, Any]]:
        """Yield each contact of a link whose friction is ours, once, and what the engine tells."""
        for body in self._bodies:
            for told in self._bullet.getContactPoints(body, physicsClientId=self._client):
                key = (told[1], told[3], told[2], told[4])
                if key[0] == key[2] or key[:2] not in self._factors:
                    continue
                # two such links: the first body's factors count
                if key[2:] in self._factors and key[2] < key[0]:
                    continue
                yield key, told

    def _ask(self, place: tuple[int, int]) -> tuple[Any, Any, Any, Any]:
        """Return centre, axes of the inertial frame, velocity and spin of a link in the world."""
        bullet, client = self._bullet, self._client
        body, link = place
        if link < 0:
            centre, turn = bullet.getBasePositionAndOrientation(body, client)
            velocity, spin = bullet.getBaseVelocity(body, client)
        else:
            state = bullet.getLinkState(body, link, 1, 1, client)
            centre, turn, velocity, spin = state[0], state[1], state[6], state[7]
        return centre, geometry.rotation_from_quaternion(turn), velocity, spin

    def _push(self, place: Place, force: Sequence[float], point: Sequence[float]) -> None:
        """Apply a force to a link at a point of the world."""
        if self._skins[place].mass > 0:
            bullet = self._bullet
            bullet.applyExternalForce(
                *place, force, point, bullet.WORLD_FRAME, physicsClientId=self._client
            )


def _lighter(mass: float, other: float) -> float:
    """Return what two bodies weigh against each other; 0 stands for one that cannot move."""
    if mass == 0 or other == 0:
        return mass or other
    return mass * other / (mass + other)
