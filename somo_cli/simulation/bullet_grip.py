"""Friction that depends on the direction, between the engine's steps: its contacts, our forces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.simulation.grip import Grip, Key
from somo_cli.simulation.springs import Array
from somo_cli.simulation.surface import Surface


@dataclass(frozen=True, slots=True)
class Skin:
    """A link in the engine and its surface; `axes` are the link's in its inertial frame."""

    body: int
    link: int
    surface: Surface
    mass: float
    axes: Array

    @staticmethod
    def of(
        bullet: Any,
        client: int,
        body: int,
        link: int,
        surface: Surface,
        axes: geometry.Matrix | None = None,
    ) -> Skin:
        """Return the skin of a loaded link; `axes` where the engine does not know the link's."""
        told = bullet.getDynamicsInfo(body, link, client)
        axes = axes or geometry.transposed(geometry.rotation_from_quaternion(told[4]))
        return Skin(body, link, surface, told[0], np.array(axes))


@dataclass(frozen=True, slots=True)
class Motions:
    """Of links, in the world: centres, axes of the inertial frames (n, 3, 3), and velocities."""

    centres: Array
    axes: Array
    velocities: Array
    spins: Array

    def of(self, numbers: Sequence[int]) -> Motions:
        """Return the motions of these links, in this order."""
        return Motions(
            self.centres[numbers], self.axes[numbers], self.velocities[numbers], self.spins[numbers]
        )

    def at(self, points: Array) -> Array:
        """Return the velocity of a point of each link."""
        moving: Array = self.velocities + np.cross(self.spins, points - self.centres)
        return moving

    def seen(self, points: Array) -> Array:
        """Return a point of the world for each link, in the link's axes."""
        seen: Array = np.einsum("pji,pj->pi", self.axes, points - self.centres)
        return seen


@dataclass(frozen=True, slots=True)
class Touching:
    """What is known of the two links of each contact; `factors` in the inertial frame."""

    own: Motions
    other: Motions
    frictions: Array
    masses: Array
    factors: Array


class BulletGrip:
    """Applies, before a step, the friction at the contacts that the last step has found."""

    def __init__(self, bullet: Any, client: int, time_step: float, skins: Sequence[Skin]) -> None:
        self._bullet = bullet
        self._client = client
        self._grip = Grip(time_step)
        self._skins: Mapping[tuple[int, int], Skin] = {(one.body, one.link): one for one in skins}
        self.rubs: list[tuple[Key, Sequence[float], list[float]]] = []
        """What was applied for the last step: to which links, where, the force on the first."""
        self._bodies = sorted({one.body for one in skins if one.surface.anisotropy is not None})
        self._factors: Mapping[tuple[int, int], Array] = {
            place: one.axes @ np.diag(one.surface.anisotropy) @ one.axes.T
            for place, one in self._skins.items()
            if one.surface.anisotropy is not None
        }

    def act(self) -> None:
        """Apply the friction for the coming step to all that touch."""
        contacts = list(self._contacts())
        self.rubs = []
        if not contacts:
            self._grip.let_go()
            return
        told = [one for _, one in contacts]
        keys = tuple(key for key, _ in contacts)
        touching = self._touching(keys)
        points, others = (np.array([one[place] for one in told]) for place in (5, 6))
        slips = touching.own.at(points) - touching.other.at(others)
        forces = self._grip.forces(
            keys,
            places=touching.own.seen(points),
            normals=np.array([one[7] for one in told]),
            slips=slips,
            limits=touching.frictions * [one[9] for one in told],
            masses=touching.masses,
            factors=touching.own.axes @ touching.factors @ touching.own.axes.transpose(0, 2, 1),
        )
        for key, point, other, force in zip(
            keys, points.tolist(), others.tolist(), forces, strict=True
        ):
            self.rubs.append((key, point, force.tolist()))
            self._push(key[:2], force, point)
            self._push(key[2:], -force, other)

    def _touching(self, keys: Sequence[Key]) -> Touching:
        """Return what is known of the two links of each contact."""
        places = list(dict.fromkeys(place for key in keys for place in (key[:2], key[2:])))
        numbers = {place: number for number, place in enumerate(places)}
        motions = Motions(*map(np.array, zip(*map(self._ask, places), strict=True)))
        counts = Counter(key[:2] for key in keys)
        pairs = [(self._skins[key[:2]], self._skins[key[2:]]) for key in keys]
        masses = [
            _lighter(own.mass, other.mass) / counts[key[:2]]
            for key, (own, other) in zip(keys, pairs, strict=True)
        ]
        return Touching(
            motions.of([numbers[key[:2]] for key in keys]),
            motions.of([numbers[key[2:]] for key in keys]),
            np.array([own.surface.friction * other.surface.friction for own, other in pairs]),
            np.array(masses),
            np.array([self._factors[key[:2]] for key in keys]),
        )

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

    def _push(self, place: tuple[int, int], force: Array, point: Sequence[float]) -> None:
        """Apply a force to a link at a point of the world."""
        if self._skins[place].mass > 0:
            bullet = self._bullet
            bullet.applyExternalForce(
                *place, force.tolist(), point, bullet.WORLD_FRAME, physicsClientId=self._client
            )


def _lighter(mass: float, other: float) -> float:
    """Return what two bodies weigh against each other; 0 stands for one that cannot move."""
    if mass == 0 or other == 0:
        return mass or other
    return mass * other / (mass + other)
