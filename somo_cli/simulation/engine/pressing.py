"""The interface of contact points that press, for the prediction of contact forces."""

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
    """The contact parameters of two surfaces; engine units.

    `compliance` is a stiffness and a damping, None where both surfaces are rigid.
    """

    friction: float
    compliance: tuple[float, float] | None = None


class PressingForces(NamedTuple):
    """The forces at m points in the last step, in the world and in engine units."""

    forces: list[float]
    """The forces on the first sides, friction included: 3 m numbers."""
    gaps: list[float]
    """Gaps at the start of the last step, as the engine counts them; negative in an overlap."""
    is_sliding: Sequence[bool]
    """Whether friction is at its limit."""


@dataclass(frozen=True, slots=True)
class PressingPoints:
    """The points that press, as the last step began: pairs of places, and (m, 3) each.

    The points on the first and on the second side, and unit normals from the second to the first.
    """

    pairs: Sequence[Pair]
    on_first: Array
    on_second: Array
    normals: Array


class ContactReader(Protocol):
    """Reads the contact points that press."""

    recovery: float
    """Share of an overlap of rigid parts that the engine undoes in a step."""

    def pressing(self) -> Sequence[Hashable] | None:
        """Return the links at each point that pressed in the last step, None if nothing is near."""

    def pairs(self) -> Sequence[Pair]:
        """Return the places of each point that `pressing` returned last."""

    def follow(self, kept: Sequence[int]) -> None:
        """Choose the points that `points` and `forces` return, by their order in `pressing`.

        They stay the same until it returns other links.
        """

    def points(self) -> PressingPoints:
        """Return the positions of the points that are followed."""

    def forces(self) -> PressingForces:
        """Return the forces at the points that are followed."""

    def pair(self, pair: Pair) -> ContactPair:
        """Return the contact parameters of two surfaces."""
