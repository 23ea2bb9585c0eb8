"""Joint stiffness from the material of a link: Young's modulus times the section that bends.

A joint stands for `span` of backbone. About an axis across the backbone its stiffness is E I / span
(Bernoulli and Euler), about the backbone itself G J / span (Saint-Venant), G = E / (2 + 2 ν).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from somo_cli.manipulator import geometry
from somo_cli.manipulator.section import Section
from somo_cli.manipulator.solids import Box, Cylinder, Solid

INCOMPRESSIBLE = 0.5
"""Poisson's ratio of rubber, the default."""

_ALONG = 1e-9  # of an axis: a smaller part along the backbone, or across it, is none


class NoSection(ValueError):
    """A link or an axis from which no stiffness follows."""


def section_of(shape_type: str, solid: Solid) -> Section:
    """Return the section of a link across the backbone, in the units of its file.

    Raises NoSection for a sphere.
    """
    if isinstance(solid, Box):
        x, y, _ = solid.size
        return Section(shape_type, (x / 2, y / 2), 0.0)
    if isinstance(solid, Cylinder):
        return Section(shape_type, (0.0, 0.0), solid.radius)
    raise NoSection("a sphere has no section that is the same along the backbone")


def joint_stiffness(
    link: Mapping[str, Any], solid: Solid, axis: geometry.Vector, span: float
) -> float:
    """Return the stiffness of a joint about an axis [N·m/rad] that stands for `span` [m].

    `link` has `modulus` [Pa] and maybe `poisson_ratio`, without errors. Raises NoSection for a
    sphere, and for an axis that is neither across the backbone nor along it.
    """
    section, modulus = section_of(link["shape_type"], solid), float(link["modulus"])
    size, across = geometry.norm(axis), math.hypot(axis[0], axis[1])
    if abs(axis[2]) <= _ALONG * size:
        return modulus * section.second_moment((axis[0], axis[1])) / span
    if across <= _ALONG * size:
        ratio = link.get("poisson_ratio")
        ratio = INCOMPRESSIBLE if ratio is None else float(ratio)
        return modulus / (2 + 2 * ratio) * section.torsion_constant() / span
    raise NoSection("the axis is neither across the backbone nor along it")
