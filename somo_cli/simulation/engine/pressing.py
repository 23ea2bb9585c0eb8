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
    """How m points pressed in the last step, in the world and in engine units."""

    forces: list[float]
    """The forces on the first sides, friction included: 3 m numbers."""
    gaps: list[float]
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

    def pressing(self) -> Sequence[Hashable] | None:
        """Return which links pressed at each point in the last step, None where nothing is near."""

    def pairs(self) -> Sequence[Pair]:
        """Return the places of each point that `pressing` returned last."""

    def follow(self, kept: Sequence[int]) -> None:
        """Take the points that `points` and `forces` are about, by their order in `pressing`.

        They stay the same until it returns other links.
        """

    def points(self) -> PressingPoints:
        """Return where the points that are followed are."""

    def forces(self) -> PressingForces:
        """Return how the points that are followed press."""

    def pair(self, pair: Pair) -> ContactPair:
        """Return how the engine treats two surfaces."""
