"""How bodies touch: the surfaces of manipulators and objects, and the ground."""

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
"""What the ground is called where objects are called by their names."""


@dataclass(frozen=True, slots=True)
class ContactCompliance:
    """A spring and a damper in every point of contact, in place of a hard surface."""

    stiffness: ContactStiffness
    damping: ContactDamping


@dataclass(frozen=True, slots=True)
class ContactSurface:
    """What a body or a link is like to touch.

    The friction of a contact is the product of both bodies', as is the restitution. The lever arm
    of its spinning and rolling friction is a.arm * b.friction + b.arm * a.friction.
    `friction_anisotropy` are factors of the friction along the link's own axes.
    """

    friction: Number
    spinning_friction: Length = 0.0
    rolling_friction: Length = 0.0
    restitution: Number = 0.0
    compliance: ContactCompliance | None = None
    friction_anisotropy: tuple[Number, Number, Number] | None = None


@dataclass(frozen=True, slots=True)
class ManipulatorSurfaces:
    """The surfaces of a manipulator: its first link, the last of every limb, and those between."""

    base: ContactSurface
    links: ContactSurface
    tips: ContactSurface

    def of_link(self, link: int, chain: Chain) -> ContactSurface:
        """Return the surface of a link of a chain, 0 the base."""
        if link == 0:
            return self.base
        is_last = any(link == limb.last_link for limb in chain.backbones)
        return self.tips if is_last else self.links

    @property
    def all(self) -> tuple[ContactSurface, ...]:
        """The three."""
        return self.base, self.links, self.tips


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane z = `height` in the world, which nothing passes from above."""

    height: Length
    surface: ContactSurface


DEFAULT_SURFACE = ContactSurface(0.5)
"""Of a manipulator and an object."""

DEFAULT_GROUND_SURFACE = ContactSurface(1.0, restitution=1.0)
"""Where the other body alone decides."""


def read_surfaces(data: Mapping[str, Any]) -> ManipulatorSurfaces:
    """Return the surfaces that a sound mapping of a manipulator describes."""
    whole = read_surface(data)
    base, links, tips = (
        read_surface(data.get(part, {}), whole) for part in ("base", "links", "tips")
    )
    return ManipulatorSurfaces(base, links, tips)


def read_surface(
    data: Mapping[str, Any], default: ContactSurface = DEFAULT_SURFACE
) -> ContactSurface:
    """Return the surface of a sound mapping, whose other keys are of no interest here."""
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
    """Return the ground that a sound mapping describes."""
    return Ground(float(data.get("height", 0)), read_surface(data, DEFAULT_GROUND_SURFACE))
