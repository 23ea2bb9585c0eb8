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
    EngineContact,
    EngineLinkId,
    LastContacts,
)
from somo_cli.simulation.engine.contacts import LinkIndex
from somo_cli.simulation.engine.pressing import ContactPair, Pair, PressingForces, PressingPoints
from somo_cli.simulation.plan.model import Plan

RECOVERY = 0.08  # seen in 3.2.7: share of an overlap that is undone in a step, if not told
SLOP = 1e-5  # engine units; seen in 3.2.7: added to every gap
UNTOLD_DAMPING = 0.1  # engine units; seen in 3.2.7: of a rigid surface, against one that is not
LIMIT = 1e-5  # relative: friction as near to its limit slides


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
        self._pressing: Sequence[tuple[Any, ...]] = ()
        self.recovery = contact_parameters(plan).get("contactERP", RECOVERY)

    def pressing(self) -> PressingForces | None:
        """Return what pressed in the last step, None where nothing is near anything."""
        points = self._contacts.reported()
        if not points:
            return None
        self._pressing = [one for one in points if one[NORMAL_FORCE] > 0]
        keys: list[ContactKey] = []
        forces: list[float] = []
        gaps: list[float] = []
        slides: list[bool] = []
        limits = self._limits
        for one in self._pressing:
            _, a, b, i, j, _, _, (x, y, z), gap, n, f, (fx, fy, fz), g, (gx, gy, gz) = one
            key = a, i, b, j
            keys.append(key)
            forces += n * x + f * fx + g * gx, n * y + f * fy + g * gy, n * z + f * fz + g * gz
            gaps.append(gap + SLOP)
            limit = limits[key] if key in limits else self._limit(key)
            slides.append(f * f + g * g >= limit * n * n)
        return PressingForces(keys, forces, gaps, slides)

    def points(self) -> PressingPoints:
        """Return where it presses, of what `pressing` returned last."""
        pressing = [EngineContact(*one) for one in self._pressing]
        rows = np.array([(one.on_first, one.on_second, one.normal) for one in pressing])
        rows = rows.reshape(len(pressing), 3, 3)
        pairs = [self._pair_of(one.key) for one in pressing]
        return PressingPoints(pairs, rows[:, 0], rows[:, 1], rows[:, 2])

    def pair(self, pair: Pair) -> ContactPair:
        """Return how the engine treats two surfaces."""
        known = self._pairs.get(pair)
        if known is None:
            known = self._pairs[pair] = self._ask(pair)
        return known

    def _pair_of(self, key: ContactKey) -> Pair:
        return self._places[key[:2]], self._places[key[2:]]

    def _limit(self, key: ContactKey) -> float:
        limit = self._limits[key] = self.pair(self._pair_of(key)).friction ** 2 * (1 - 2 * LIMIT)
        return limit

    def _ask(self, pair: Pair) -> ContactPair:
        first, second = (self._engine.getDynamicsInfo(*self._indices[place]) for place in pair)
        friction = first[1] * second[1]
        # seen in 3.2.7: a rigid surface has a stiffness of -1
        stiffnesses = [one[9] for one in (first, second) if one[9] > 0]
        if not stiffnesses:
            return ContactPair(friction)
        damping = sum(one[8] if one[9] > 0 else UNTOLD_DAMPING for one in (first, second))
        return ContactPair(friction, (1 / sum(1 / one for one in stiffnesses), damping))
