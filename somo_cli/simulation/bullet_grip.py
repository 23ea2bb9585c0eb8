"""Friction that depends on the direction, between the engine's steps: its contacts, our forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
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
    def of(bullet: Any, client: int, body: int, link: int, surface: Surface) -> Skin:
        """Return the skin of a loaded link."""
        told = bullet.getDynamicsInfo(body, link, client)
        axes = np.array(geometry.rotation_from_quaternion(told[4])).T
        return Skin(body, link, surface, told[0], axes)


@dataclass(frozen=True, slots=True)
class Motion:
    """Of a link, in the world: its centre, the axes of its inertial frame, and its velocities."""

    centre: Array
    axes: Array
    velocity: Array
    spin: Array

    def at(self, point: Array) -> Array:
        """Return the velocity of a point of the link."""
        (x, y, z), (a, b, c) = (point - self.centre).tolist(), self.spin.tolist()
        turning = np.array((b * z - c * y, c * x - a * z, a * y - b * x))
        moving: Array = self.velocity + turning
        return moving


class BulletGrip:
    """Applies, before a step, the friction at the contacts that the last step has found."""

    def __init__(self, bullet: Any, client: int, time_step: float, skins: Sequence[Skin]) -> None:
        self._bullet = bullet
        self._client = client
        self._grip = Grip(time_step)
        self._skins: Mapping[tuple[int, int], Skin] = {(one.body, one.link): one for one in skins}
        self._bodies = sorted({one.body for one in skins if one.surface.anisotropy is not None})
        self._factors: Mapping[tuple[int, int], Array] = {
            place: one.axes @ np.diag(one.surface.anisotropy) @ one.axes.T
            for place, one in self._skins.items()
            if one.surface.anisotropy is not None
        }
        self._motions: dict[tuple[int, int], Motion] = {}

    def act(self) -> None:
        """Apply the friction for the coming step to all that touch."""
        self._motions.clear()
        contacts = list(self._contacts())
        if not contacts:
            self._grip.forces((), *(np.zeros((0, 3)),) * 3, *(np.zeros(0),) * 2, np.zeros((0, 3, 3)))
            return
        keys = tuple(key for key, _ in contacts)
        counts: dict[tuple[int, int], int] = {}
        for key in keys:
            counts[key[:2]] = counts.get(key[:2], 0) + 1
        places, normals, slips, limits, masses, factors = [], [], [], [], [], []
        for key, told in contacts:
            own, other = self._skins[key[:2]], self._skins[key[2:]]
            motion = self._motion(key[:2])
            point = np.array(told[5])
            places.append((point - motion.centre) @ motion.axes)
            normals.append(told[7])
            slips.append(motion.at(point) - self._motion(key[2:]).at(np.array(told[6])))
            limits.append(own.surface.friction * other.surface.friction * told[9])
            masses.append(_lighter(own.mass, other.mass) / counts[key[:2]])
            factors.append(motion.axes @ self._factors[key[:2]] @ motion.axes.T)
        forces = self._grip.forces(keys, *map(np.array, (places, normals, slips, limits, masses, factors)))
        for (key, told), force in zip(contacts, forces, strict=True):
            self._push(key[:2], force, told[5])
            self._push(key[2:], -force, told[6])

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

    def _motion(self, place: tuple[int, int]) -> Motion:
        known = self._motions.get(place)
        if known is None:
            known = self._motions[place] = self._ask(*place)
        return known

    def _ask(self, body: int, link: int) -> Motion:
        bullet, client = self._bullet, self._client
        if link < 0:
            centre, turn = bullet.getBasePositionAndOrientation(body, client)
            velocity, spin = bullet.getBaseVelocity(body, client)
        else:
            state = bullet.getLinkState(body, link, 1, 1, client)
            centre, turn, velocity, spin = state[0], state[1], state[6], state[7]
        axes = np.array(geometry.rotation_from_quaternion(turn))
        return Motion(np.array(centre), axes, np.array(velocity), np.array(spin))

    def _push(self, place: tuple[int, int], force: Array, point: Vector) -> None:
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
