"""Check that an actuator can have the taper that it asks for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem


def taper_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for a taper of links that cannot get thinner and stay as long, or as given."""
    link = data.get("link_definition")
    if not isinstance(link, Mapping) or not is_sound((*at, "link_definition")):
        return
    if not is_sound((*at, "taper")) or (data.get("taper") or 1) == 1:
        return
    place = document.span((*at, "taper"))
    if link["shape_type"] == "sphere":
        hint = "use a cylinder, a capsule or a box"
        yield Problem(place, "spheres cannot have a taper: their length is their width", hint)
    elif link.get("inertial_values") is not None:
        hint = "leave inertial_values out; each link then has the inertia of its solid"
        yield Problem(place, "a taper and inertial_values exclude each other", hint)
