"""The contact points of the last step as PyBullet reports them, read once a step, with names."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeAlias

from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.engine.bullet.client import BulletClient

EngineLinkId: TypeAlias = tuple[int, int]
"""A link as the engine numbers it: the body and the link, -1 for the base."""

ContactKey: TypeAlias = tuple[int, int, int, int]
"""The two links of a contact: body and link of the first, body and link of the second."""


class EngineContact(NamedTuple):
    """One contact point, in engine units and the world's axes, in the engine's order of fields.

    Forces act on the first link, the opposite ones on the second.
    """

    flag: int
    first_body: int
    second_body: int
    first_link: int
    second_link: int
    on_first: Vector
    """The point on the surface of the first link."""
    on_second: Vector
    normal: Vector
    """A unit vector from the second link to the first."""
    gap: float
    """The distance between the surfaces, negative in an overlap."""
    normal_force: float
    friction_1: float
    """The friction force along `tangent_1`."""
    tangent_1: Vector
    friction_2: float
    tangent_2: Vector

    @property
    def key(self) -> ContactKey:
        """The two links."""
        return self.first_body, self.first_link, self.second_body, self.second_link


NORMAL_FORCE = EngineContact._fields.index("normal_force")
"""Where the normal force stands in a contact as the engine reports it."""

# a third of the time of EngineContact(*fields), which counts where many points touch
_named: Callable[[tuple[Any, ...]], EngineContact] = partial(tuple.__new__, EngineContact)


def contacts_of_body(engine: BulletClient, body: int) -> list[EngineContact]:
    """Return the contact points of a body, which is always the first.

    Seen in 3.2.7: asked for one body, the engine swaps the links where that body is the second,
    and turns the normal; friction forces it does not turn.
    """
    return list(map(_named, engine.getContactPoints(body)))


class LastContacts:
    """The contact points of the last step.

    With `is_shared`, all readers of a step share one list, and the caller must call `clear` before
    it steps the engine. In a list of all points, the engine does not swap links or turn normals.
    """

    def __init__(self, engine: BulletClient, is_shared: bool = False) -> None:
        self._engine = engine
        self._is_shared = is_shared
        self._reported: Sequence[tuple[Any, ...]] | None = None
        self._points: list[EngineContact] | None = None

    def reported(self) -> Sequence[tuple[Any, ...]]:
        """Return every contact point as the engine has it, to be unpacked as an `EngineContact`.

        For what reads all points in every step: with names it takes twice as long.
        """
        found = self._reported
        if found is None:
            found = self._engine.getContactPoints()
            if self._is_shared:
                self._reported = found
        return found

    def points(self) -> list[EngineContact]:
        """Return every contact point, in the engine's order."""
        found = self._points
        if found is None:
            found = list(map(_named, self.reported()))
            if self._is_shared:
                self._points = found
        return found

    def clear(self) -> None:
        """Drop the list of points; call this before the engine steps."""
        self._reported = self._points = None
