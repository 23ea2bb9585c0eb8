"""Contact points of PyBullet that press, and how the engine treats the surfaces there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.contact_parameters import contact_parameters
from somo_cli.simulation.engine.bullet.last_contacts import (
    NORMAL_FORCE,
    ContactKey,
    EngineLinkId,
    LastContacts,
)
from somo_cli.simulation.engine.contacts import LinkIndex
from somo_cli.simulation.engine.pressing import ContactPair, Pair, PressingForces, PressingPoints
from somo_cli.simulation.plan.model import Plan

RECOVERY = 0.08  # seen in 3.2.7: share of an overlap undone in a step, by default
SLOP = 1e-5  # engine units; seen in 3.2.7: added to every gap
RIGID_DAMPING = 0.1  # engine units; seen in 3.2.7: of a rigid surface, against one that is not
LIMIT = 1e-5  # relative: friction this near to its limit slides


class BulletContactReader:
    """Reads the contact points of a world; `places` maps the engine's bodies and links."""

    def __init__(
        self,
        engine: BulletClient,
        contacts: LastContacts,
        plan: Plan,
        places: Mapping[EngineLinkId, LinkIndex],
    ) -> None:
        self._engine = engine
        self._contacts = contacts
        self._places = places
        self._indices = {place: index for index, place in reversed(list(places.items()))}
        self._pairs: dict[Pair, ContactPair] = {}
        self._limits: dict[ContactKey, float] = {}  # squares of the coefficients of friction
        # all that pressed in the last step, and which of them are followed
        self._pressing: Sequence[tuple[Any, ...]] = ()
        self._keys: Sequence[ContactKey] = ()
        self._kept: Sequence[int] = ()
        self._kept_limits: Sequence[float] = ()
        self._kept_pairs: Sequence[Pair] = ()
        self._takes_all = False
        self.recovery = contact_parameters(plan).get("contactERP", RECOVERY)

    def pressing(self) -> Sequence[ContactKey] | None:
        """Return the links at each point that pressed in the last step, None if nothing is near."""
        points = self._contacts.reported()
        if not points:
            return None
        self._pressing = pressing = [one for one in points if one[NORMAL_FORCE] > 0]
        self._keys = [(one[1], one[3], one[2], one[4]) for one in pressing]
        return self._keys

    def pairs(self) -> Sequence[Pair]:
        """Return the places of each point that `pressing` returned last."""
        return [self._pair_of(key) for key in self._keys]

    def follow(self, kept: Sequence[int]) -> None:
        """Choose the points that `points` and `forces` return, by their order in `pressing`."""
        self._kept = list(kept)
        self._takes_all = len(kept) == len(self._keys)
        self._kept_limits = [self._limit(self._keys[index]) for index in kept]
        self._kept_pairs = [self._pair_of(self._keys[index]) for index in kept]

    def points(self) -> PressingPoints:
        """Return the positions of the points that are followed."""
        rows = np.array([one[5:8] for one in self._followed()])
        return PressingPoints(self._kept_pairs, rows[:, 0], rows[:, 1], rows[:, 2])

    def forces(self) -> PressingForces:
        """Return the forces at the points that are followed."""
        forces: list[float] = []
        gaps: list[float] = []
        slides: list[bool] = []
        for one, limit in zip(self._followed(), self._kept_limits, strict=True):
            _, _, _, _, _, _, _, (x, y, z), gap, n, f, (fx, fy, fz), g, (gx, gy, gz) = one
            forces += n * x + f * fx + g * gx, n * y + f * fy + g * gy, n * z + f * fz + g * gz
            gaps.append(gap + SLOP)
            slides.append(f * f + g * g >= limit * n * n)
        return PressingForces(forces, gaps, slides)

    def _followed(self) -> Sequence[tuple[Any, ...]]:
        pressing = self._pressing
        return pressing if self._takes_all else [pressing[index] for index in self._kept]

    def pair(self, pair: Pair) -> ContactPair:
        """Return the contact parameters of two surfaces."""
        known = self._pairs.get(pair)
        if known is None:
            known = self._pairs[pair] = self._ask(pair)
        return known

    def _pair_of(self, key: ContactKey) -> Pair:
        return self._places[key[:2]], self._places[key[2:]]

    def _limit(self, key: ContactKey) -> float:
        limit = self._limits.get(key)
        if limit is None:
            friction = self.pair(self._pair_of(key)).friction
            limit = self._limits[key] = friction * friction * (1 - 2 * LIMIT)
        return limit

    def _ask(self, pair: Pair) -> ContactPair:
        first, second = (self._engine.getDynamicsInfo(*self._indices[place]) for place in pair)
        friction = first[1] * second[1]
        # seen in 3.2.7: a rigid surface has a stiffness of -1
        stiffnesses = [one[9] for one in (first, second) if one[9] > 0]
        if not stiffnesses:
            return ContactPair(friction)
        damping = sum(one[8] if one[9] > 0 else RIGID_DAMPING for one in (first, second))
        return ContactPair(friction, (1 / sum(1 / one for one in stiffnesses), damping))
