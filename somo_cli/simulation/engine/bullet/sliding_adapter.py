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
from typing import Any

from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.sliding_friction import (
    LinkMotion,
    MissingFriction,
    Point,
    SlidingLink,
    missing_friction,
)

LIMIT_RATIO = 0.999  # of the friction limit: below it, a point sticks
STARTING_STEPS = 16  # with a check in each; later sliding is found at the next check of contact

Place = tuple[int, int]
"""A link of the engine: body and link."""

Key = tuple[int, int, int, int]
"""Body and link, and body and link of the other, as the engine orders them in a contact."""


class SlidingAdapter:
    """Corrects the direction of sliding friction from step to step.

    Call `apply` before every step; it works while the friction of something that slides has a part
    missing. `check`, called now and then, finds what has begun to slide.
    """

    def __init__(
        self, engine: BulletClient, time_step: float, frictions: Mapping[Place, float]
    ) -> None:
        self._engine = engine
        self._time_step = time_step
        self._frictions = frictions
        self._limits: dict[Key, float] = {}  # squares of products of coefficients
        self._masses: dict[Place, tuple[float, float]] = {}
        self._missing: dict[Key, MissingFriction] = {}
        self._sliding: dict[Key, list[Point]] | None = None  # as found by `check`
        self._first = STARTING_STEPS
        self.is_active = True
        self.applied: list[tuple[Key, Sequence[float], Sequence[float]]] = []
        """What was applied for the last step: the links, the point, the force on the first."""

    def check(self, reported: Iterable[Any]) -> None:
        """Start to correct if any contact of the last step, as the engine reports it, slides."""
        if not self.is_active:
            self._sliding = self._sliding_points(reported)
            self.is_active = bool(self._sliding)

    def apply(self) -> None:
        """Apply the friction that was missing in the last step."""
        if not self.is_active:
            return
        sliding = self._sliding
        if sliding is None:
            reported = self._engine.getContactPoints()
            sliding = self._sliding_points(reported)
        self._sliding = None
        self.applied = []
        lacking: dict[Key, MissingFriction] = {}
        links: dict[Place, SlidingLink] = {}
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

    def _sliding_points(self, reported: Iterable[Any]) -> dict[Key, list[Point]]:
        """Return the contact points whose friction is at its limit, by their links."""
        found: dict[Key, list[Point]] = {}
        limits = self._limits
        for one in reported:
            normal = one[9]
            if normal > 0:
                a, b = one[10], one[12]
                key = (one[1], one[3], one[2], one[4])
                least = limits.get(key)
                if least is None:
                    least = limits[key] = self._limit(key)
                if 0 < least * normal * normal <= a * a + b * b:
                    point = Point(one[5], one[7], (one[11], one[13]), (a, b))
                    found.setdefault(key, []).append(point)
        return found

    def _limit(self, key: Key) -> float:
        limit = LIMIT_RATIO * self._frictions[key[:2]] * self._frictions[key[2:]]
        return limit * limit

    def _mass(self, place: Place) -> tuple[float, float]:
        """Return one over mass and over least moment of inertia of a link; 0 if fixed."""
        known = self._masses.get(place)
        if known is None:
            reported = self._engine.getDynamicsInfo(*place)
            known = (1 / reported[0], 1 / min(reported[2])) if reported[0] > 0 else (0.0, 0.0)
            self._masses[place] = known
        return known

    def _moving(self, place: Place) -> LinkMotion:
        engine = self._engine
        body, link = place
        if link < 0:
            (x, y, z), _ = engine.getBasePositionAndOrientation(body)
            velocity, spin = engine.getBaseVelocity(body)
            (vx, vy, vz), time = velocity, self._time_step
            # the pose at the start of the step, as of the contact points
            return LinkMotion((x - time * vx, y - time * vy, z - time * vz), velocity, spin)
        # without new kinematics this is the pose at the start of the step, too
        state = engine.getLinkState(body, link, 1, 0)
        return LinkMotion(state[0], state[6], state[7])

    def _push(self, key: Key, found: MissingFriction) -> None:
        """Apply a wrench to the first link of a pair, the opposite to the other."""
        engine, world = self._engine, self._engine.WORLD_FRAME
        self.applied.append((key, found.point, found.force))
        (fx, fy, fz), (tx, ty, tz) = found.force, found.torque
        if self._mass(key[:2])[0] > 0:
            engine.applyExternalForce(*key[:2], (fx, fy, fz), found.point, world)
            engine.applyExternalTorque(*key[:2], (tx, ty, tz), world)
        if self._mass(key[2:])[0] > 0:
            engine.applyExternalForce(*key[2:], (-fx, -fy, -fz), found.point, world)
            engine.applyExternalTorque(*key[2:], (-tx, -ty, -tz), world)
