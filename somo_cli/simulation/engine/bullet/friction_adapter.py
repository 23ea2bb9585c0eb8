"""Apply anisotropic friction between steps, at the contacts that the engine has found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.simulation.engine.bullet.anisotropic_friction import AnisotropicFriction
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.engine_links import EngineLinks
from somo_cli.simulation.engine.bullet.last_contacts import (
    ContactKey,
    EngineContact,
    EngineLinkId,
    contacts_of_body,
)

InertialPose = tuple[Array, Array]
"""Centre and axes of the inertial frame of a link, in the world."""


@dataclass(frozen=True, slots=True)
class FrictionLink:
    """A link in the engine and its surface; `axes` are the link's in its inertial frame."""

    body: int
    link: int
    surface: ContactSurface
    mass: float
    axes: Array

    @staticmethod
    def of(
        engine: BulletClient,
        body: int,
        link: int,
        surface: ContactSurface,
        axes: geometry.Matrix | None = None,
    ) -> FrictionLink:
        """Return the surface data of a loaded link; `axes` if the engine does not know them."""
        reported = engine.getDynamicsInfo(body, link)
        axes = axes or geometry.transposed(geometry.rotation_from_quaternion(reported[4]))
        return FrictionLink(body, link, surface, reported[0], np.array(axes))


@dataclass(frozen=True, slots=True)
class InertialPoses:
    """Of links in the world: their centres (n, 3), and the axes of the inertial frames."""

    centres: Array
    axes: Array

    def of(self, numbers: Sequence[int]) -> InertialPoses:
        """Return the poses of these links, in this order."""
        return InertialPoses(self.centres[numbers], self.axes[numbers])

    def to_link_frames(self, points: Array) -> Array:
        """Return a point of the world for each link, in the link's axes."""
        seen: Array = np.einsum("pji,pj->pi", self.axes, points - self.centres)
        return seen

    def to_world(self, seen: Array) -> Array:
        """Return the world positions of points of the links."""
        placed: Array = self.centres + np.einsum("pij,pj->pi", self.axes, seen)
        return placed

    def moved_back(self, time: float, velocities: Array, spins: Array) -> InertialPoses:
        """Return the poses of links a short time ago, by their velocities."""
        turned = np.cross(spins[:, None, :], self.axes.transpose(0, 2, 1)).transpose(0, 2, 1)
        return InertialPoses(self.centres - time * velocities, self.axes - time * turned)


@dataclass(frozen=True, slots=True)
class PoseHistory:
    """The poses of links now, a step ago and two steps ago.

    Velocities of points come from these, not from the velocities that the engine gives of links.
    Seen in 3.2.7: it steps velocities first, so these are those of half a step ago, but at the
    angles of now. What a link on a chain does is then off by h / 2 times its centripetal
    acceleration, more the farther it is from the base: the crawling snake was 3.8 % faster, at
    2 ms, with its base behind than with its base ahead.
    """

    now: InertialPoses
    before: InertialPoses
    earlier: InertialPoses

    def of(self, numbers: Sequence[int]) -> PoseHistory:
        """Return the trails of these links, in this order."""
        return PoseHistory(self.now.of(numbers), self.before.of(numbers), self.earlier.of(numbers))

    def point_velocities(self, points: Array, time_step: float) -> Array:
        """Return the velocity of a point of each link now, to second order."""
        seen = self.now.to_link_frames(points)
        before = self.before.to_world(seen)
        change: Array = 1.5 * (points - before) - 0.5 * (before - self.earlier.to_world(seen))
        return change / time_step


@dataclass(frozen=True, slots=True)
class ContactData:
    """The data of the two links of each contact; `factors` are in the inertial frame."""

    own: PoseHistory
    other: PoseHistory
    frictions: Array
    masses: Array
    factors: Array


class FrictionAdapter:
    """Applies, before a step, the friction at the contacts that the last step has found."""

    def __init__(
        self, engine_links: EngineLinks, time_step: float, links: Sequence[FrictionLink]
    ) -> None:
        self._engine_links = engine_links
        self._time_step = time_step
        self._friction = AnisotropicFriction(time_step)
        self._histories: Mapping[EngineLinkId, tuple[InertialPose, InertialPose]] = {}
        self._links: Mapping[EngineLinkId, FrictionLink] = {
            (one.body, one.link): one for one in links
        }
        self.applied: list[tuple[ContactKey, Sequence[float], list[float]]] = []
        """The friction applied in the last step: both links, the point, the force on the first."""
        self._bodies = sorted(
            {one.body for one in links if one.surface.friction_anisotropy is not None}
        )
        self._factors: Mapping[EngineLinkId, Array] = {
            place: one.axes @ np.diag(one.surface.friction_anisotropy) @ one.axes.T
            for place, one in self._links.items()
            if one.surface.friction_anisotropy is not None
        }

    def apply(self) -> None:
        """Apply the friction of the coming step at every contact."""
        reported = list(self._contacts())
        self.applied = []
        if not reported:
            self._friction.clear()
            self._histories = {}
            return
        keys = tuple(one.key for one in reported)
        data = self._contact_data(keys)
        points = np.array([one.on_first for one in reported])
        others = np.array([one.on_second for one in reported])
        step, axes = self._time_step, data.own.now.axes
        slip_velocities = data.own.point_velocities(points, step) - data.other.point_velocities(
            others, step
        )
        forces = self._friction.forces(
            keys,
            local_points=data.own.now.to_link_frames(points),
            normals=np.array([one.normal for one in reported]),
            slip_velocities=slip_velocities,
            limits=data.frictions * [one.normal_force for one in reported],
            masses=data.masses,
            factors=axes @ data.factors @ axes.transpose(0, 2, 1),
        )
        for key, point, other, force, opposite in zip(
            keys, points.tolist(), others.tolist(), forces.tolist(), (-forces).tolist(), strict=True
        ):
            self.applied.append((key, point, force))
            self._apply_force(key[:2], force, point)
            self._apply_force(key[2:], opposite, other)

    def _contact_data(self, keys: Sequence[ContactKey]) -> ContactData:
        """Return the data of the two links of each contact."""
        places = list(dict.fromkeys(place for key in keys for place in (key[:2], key[2:])))
        numbers = {place: number for number, place in enumerate(places)}
        history = self._pose_history(places)
        counts = Counter(key[:2] for key in keys)
        pairs = [(self._links[key[:2]], self._links[key[2:]]) for key in keys]
        masses = [
            _reduced_mass(own.mass, other.mass) / counts[key[:2]]
            for key, (own, other) in zip(keys, pairs, strict=True)
        ]
        return ContactData(
            history.of([numbers[key[:2]] for key in keys]),
            history.of([numbers[key[2:]] for key in keys]),
            np.array([own.surface.friction * other.surface.friction for own, other in pairs]),
            np.array(masses),
            np.array([self._factors[key[:2]] for key in keys]),
        )

    def _pose_history(self, places: Sequence[EngineLinkId]) -> PoseHistory:
        """Return the trails of links.

        For a link that has just begun to touch, earlier poses follow from its present velocity. So
        do those of a link that has not moved: it rests, or the start of the run undid a trial step.
        """
        reported = zip(*map(self._inertial_state, places), strict=True)
        centres, axes, velocities, spins = map(np.array, reported)
        now = InertialPoses(centres, axes)
        before, earlier = (
            now.moved_back(time, velocities, spins)
            for time in (self._time_step, 2 * self._time_step)
        )
        for number, place in enumerate(places):
            known = self._histories.get(place)
            if known is None or np.array_equal(known[0][0], centres[number]):
                continue
            (before.centres[number], before.axes[number]), older = known
            earlier.centres[number], earlier.axes[number] = older
        self._histories = {
            place: ((centres[number], axes[number]), (before.centres[number], before.axes[number]))
            for number, place in enumerate(places)
        }
        return PoseHistory(now, before, earlier)

    def _contacts(self) -> Iterator[EngineContact]:
        """Yield each contact of a link whose friction is applied here, once; that link is first."""
        for body in self._bodies:
            for contact in contacts_of_body(self._engine_links.engine, body):
                key = contact.key
                if key[0] == key[2] or key[:2] not in self._factors:
                    continue
                # if both links are anisotropic, the factors of the first body count
                if key[2:] in self._factors and key[2] < key[0]:
                    continue
                yield contact

    def _inertial_state(self, place: EngineLinkId) -> tuple[Vector, Matrix, Vector, Vector]:
        """Return centre, principal axes, velocity and spin of a link in the world."""
        state = self._engine_links.state(place)
        return state.centre, state.axes, state.velocity, state.spin

    def _apply_force(
        self, place: EngineLinkId, force: Sequence[float], point: Sequence[float]
    ) -> None:
        """Apply a force to a link at a point of the world."""
        if self._links[place].mass > 0:
            self._engine_links.apply_force(place, force, point)


def _reduced_mass(mass: float, other: float) -> float:
    """Return the reduced mass of two bodies; 0 stands for one that cannot move."""
    if mass == 0 or other == 0:
        return mass or other
    return mass * other / (mass + other)
