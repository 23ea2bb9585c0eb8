"""A world behind its protocol: it refuses whatever the interface of an engine does not name."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from somo_cli.simulation.engine.interface import (
    World,
    WorldBody,
    WorldFreeBody,
    WorldKinematicObject,
    WorldObject,
    WorldPrescribedBody,
)
from somo_cli.simulation.engine.pressing import ContactReader
from somo_cli.simulation.plan.model import Body, Plan, PlannedObject

Use = tuple[str, str]
"""A protocol and one of its members, by name."""


class Guarded:
    """Anything of an engine, of which only the members of its protocol can be had.

    Methods take only what the protocol's signature takes, by the names that it has there. Each use
    is noted in `uses`, under the protocol that declares the member.
    """

    def __init__(self, protocol: type, inner: Any, uses: set[Use]) -> None:
        self._protocol = protocol
        self._inner = inner
        self._uses = uses

    def __getattr__(self, name: str) -> Any:
        owners = [one for one in self._protocol.__mro__ if name in members(one)]
        if not owners:
            raise AssertionError(f"{self._protocol.__name__} has no '{name}'")
        self._uses.add((owners[-1].__name__, name))
        found = getattr(self._inner, name)
        declared = inspect.getattr_static(owners[0], name, None)
        return _checked(declared, found) if inspect.isfunction(declared) else found


class GuardedWorld(Guarded):
    """A world whose bodies, objects and reader of contacts are guarded as well."""

    def __init__(self, plan: Plan, world: World) -> None:
        super().__init__(World, world, set())
        self.uses = self._uses
        self.bodies = [
            Guarded(protocol_of_body(body), inner, self.uses)
            for body, inner in zip(plan.bodies, world.bodies, strict=True)
        ]
        self.objects = [
            Guarded(protocol_of_object(planned), inner, self.uses)
            for planned, inner in zip(plan.objects, world.objects, strict=True)
        ]

    def contact_reader(self) -> Any:
        """Return the reader of contacts, guarded."""
        return Guarded(ContactReader, self.__getattr__("contact_reader")(), self.uses)


def protocol_of_body(body: Body) -> type:
    """Return what a run may ask of a body."""
    if body.path is not None:
        return WorldPrescribedBody
    return WorldFreeBody if body.base == "free" else WorldBody


def protocol_of_object(planned: PlannedObject) -> type:
    """Return what a run may ask of an object."""
    return WorldObject if planned.path is None else WorldKinematicObject


def members(protocol: type) -> set[str]:
    """Return the names that a protocol declares itself."""
    annotated = vars(protocol).get("__annotations__", {})
    return {name for name in {*vars(protocol), *annotated} if not name.startswith("_")}


def all_members() -> set[Use]:
    """Return every member of the interface that objects of a world have, but bodies and objects."""
    protocols = (
        World, WorldBody, WorldFreeBody, WorldPrescribedBody, WorldObject, WorldKinematicObject,
        ContactReader,
    )  # fmt: skip
    declared = {(one.__name__, name) for one in protocols for name in members(one)}
    return declared - {("World", "bodies"), ("World", "objects")}


def _checked(declared: Any, found: Callable[..., Any]) -> Callable[..., Any]:
    """Return a method that takes what the protocol says."""
    signature = inspect.signature(declared)

    def call(*arguments: Any, **named: Any) -> Any:
        signature.bind(None, *arguments, **named)
        return found(*arguments, **named)

    return call
