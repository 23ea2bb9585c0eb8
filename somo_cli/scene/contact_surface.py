"""Contact properties of the surfaces of manipulators and objects, and of the ground."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    ContactDamping,
    ContactStiffness,
    Length,
    Number,
)

GROUND_NAME = "ground"
"""The name of the ground where bodies are named, as in columns of contacts."""


@dataclass(frozen=True, slots=True)
class ContactCompliance:
    """A spring [N/m] and a damper [N·s/m] in every contact point, in place of a rigid contact."""

    stiffness: ContactStiffness
    damping: ContactDamping


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """The contact properties of a body or a link.

    The friction coefficient of a contact is the product of those of both bodies, and so is the
    coefficient of restitution. Spinning and rolling friction are moment arms [m]; that of a contact
    is a.arm * b.friction + b.arm * a.friction. `friction_anisotropy` has factors on the friction
    along the axes of the link frame [-].
    """

    friction: Number
    spinning_friction: Length = 0.0
    rolling_friction: Length = 0.0
    restitution: Number = 0.0
    compliance: ContactCompliance | None = None
    friction_anisotropy: tuple[Number, Number, Number] | None = None


@dataclass(frozen=True, slots=True)
class ManipulatorSurfaces:
    """The surfaces of a manipulator: of its base, of its tip links and of all other links."""

    base: ContactSurface
    links: ContactSurface
    tips: ContactSurface

    def of_link(self, link: int, chain: Chain) -> ContactSurface:
        """Return the surface of link number `link` of a chain; 0 is the base."""
        if link == 0:
            return self.base
        is_last = any(link == limb.last_link for limb in chain.backbones)
        return self.tips if is_last else self.links

    @property
    def all(self) -> tuple[ContactSurface, ...]:
        """The surfaces of base, other links and tip links."""
        return self.base, self.links, self.tips


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane z = `height` [m] of the world frame; free bodies stay above it."""

    height: Length
    surface: ContactSurface


DEFAULT_SURFACE = ContactSurface(0.5)
"""The surface of manipulators and objects unless the scene gives another."""

DEFAULT_GROUND_SURFACE = ContactSurface(1.0, restitution=1.0)
"""The surface of the ground unless the scene gives another: the other body alone counts."""


def read_surfaces(data: Mapping[str, Any]) -> ManipulatorSurfaces:
    """Return the surfaces of a manipulator from a `surface` mapping without errors."""
    whole = read_surface(data)
    base, links, tips = (
        read_surface(data.get(part, {}), whole) for part in ("base", "links", "tips")
    )
    return ManipulatorSurfaces(base, links, tips)


def read_surface(
    data: Mapping[str, Any], default: ContactSurface = DEFAULT_SURFACE
) -> ContactSurface:
    """Return the surface from a mapping without errors; other keys of it are ignored.

    Properties that the mapping does not give are those of `default`.
    """
    given: dict[str, Any] = {
        key: float(data[key])
        for key in ("friction", "spinning_friction", "rolling_friction", "restitution")
        if key in data
    }
    if "contact_stiffness" in data:
        stiffness, damping = float(data["contact_stiffness"]), float(data["contact_damping"])
        given["compliance"] = ContactCompliance(stiffness, damping)
    if "anisotropic_friction" in data:
        x, y, z = map(float, data["anisotropic_friction"])
        given["friction_anisotropy"] = (x, y, z)
    return dataclasses.replace(default, **given)


def read_ground(data: Mapping[str, Any]) -> Ground:
    """Return the ground from a mapping without errors."""
    return Ground(float(data.get("height", 0)), read_surface(data, DEFAULT_GROUND_SURFACE))
