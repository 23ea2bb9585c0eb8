"""How bodies touch: the surfaces of manipulators, and the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from somo_cli.manipulator.dimensions import Length, Number


@dataclass(frozen=True, slots=True)
class Surface:
    """A coefficient of dry friction; that of a contact is the product of both bodies'."""

    friction: Number


@dataclass(frozen=True, slots=True)
class Ground:
    """The plane z = `height` in the world, which nothing passes from above."""

    height: Length
    surface: Surface


def surface(data: Mapping[str, Any]) -> Surface:
    """Return the surface that a sound mapping of a manipulator describes."""
    return Surface(float(data.get("friction", 0.5)))


def ground(data: Mapping[str, Any]) -> Ground:
    """Return the ground that a sound mapping describes."""
    return Ground(float(data.get("height", 0)), Surface(float(data.get("friction", 1))))
