"""Contact points that press: what the prediction of contact forces needs of an engine."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

from somo_cli.arrays import Array
from somo_cli.simulation.engine.contacts import LinkIndex

Pair: TypeAlias = tuple[LinkIndex, LinkIndex]
"""The two places that touch at a point, in the order of the engine."""


@dataclass(frozen=True, slots=True)
class ContactPair:
    """How the engine treats two surfaces; engine units.

    `compliance` is a stiffness and a damping, None where the engine takes both as rigid.
    """

    friction: float
    compliance: tuple[float, float] | None = None


class PressingForces(NamedTuple):
    """What presses in the last step, at m points, in the world and in engine units."""

    keys: Sequence[Hashable]
    """Which links touch at each point, as the engine numbers them."""
    forces: Sequence[float]
    """The forces on the first sides, friction included: 3 m numbers."""
    gaps: Sequence[float]
    """Gaps at the start of the last step, as the engine counts them; negative in an overlap."""
    is_sliding: Sequence[bool]
    """Whether friction is at its limit."""


@dataclass(frozen=True, slots=True)
class PressingPoints:
    """Where it presses, as it was when the last step began: pairs of places, and (m, 3) each.

    The points on the first and on the second sides, and unit normals from second to first.
    """

    pairs: Sequence[Pair]
    on_first: Array
    on_second: Array
    normals: Array


class ContactReader(Protocol):
    """What the prediction of contact forces needs of an engine."""

    recovery: float
    """Share of an overlap of rigid parts that the engine undoes in a step."""

    def pressing(self) -> PressingForces | None:
        """Return what pressed in the last step, None where nothing is near anything."""

    def points(self) -> PressingPoints:
        """Return where it presses, of what `pressing` returned last."""

    def pair(self, pair: Pair) -> ContactPair:
        """Return how the engine treats two surfaces."""
