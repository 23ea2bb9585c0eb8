"""Check the forces and moments that act on the links of a manipulator."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.chain import Chain
from somo_cli.problems import Pointer, Problem, did_you_mean
from somo_cli.scene.checks.waypoints import waypoint_problems
from somo_cli.scene.reader import limbs_by_tip_name, link_index


def load_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], base: str
) -> Iterator[Problem]:
    """Yield the errors and warnings about the load `data` at `at`.

    `base` is the type of the manipulator's base: static, free or constrained.
    """
    if "force" not in data and "moment" not in data:
        yield Problem(
            document.span(at, key=True),
            "missing force or moment",
            "give a force [N], a moment [N·m], or both",
        )
    elif "force" not in data and "point" in data:
        yield Problem(
            document.span((*at, "point"), key=True),
            "point has no meaning without a force",
            "leave it out: a moment acts on the whole link",
        )
    elif not _is_nonzero(data):
        yield Problem(
            document.span(at, key=True),
            "this load is zero at all times",
            "leave it out, or give it a force, a moment or a factor that is not zero",
            severity="warning",
        )
    if data.get("link") == "base" and base in ("static", "constrained"):
        yield Problem(
            document.span((*at, "link")),
            f"a load on the base does nothing, because the base is {base}",
            "set base: free, or name another link",
            severity="warning",
        )
    if "waypoints" in data:
        yield from waypoint_problems(document, at, data, "factor", "")
        return
    for key in ("interpolation", "repeat"):
        if key in data:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} has no meaning for a constant load",
                "leave it out, or give waypoints: [[time, factor], ...]",
            )


def load_link_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], chain: Chain
) -> Iterator[Problem]:
    """Yield an error if the load `data` at `at` acts on a link that the chain does not have."""
    name = data.get("link", "tip")
    try:
        link_index(name, chain)
    except ValueError:
        known = [*limbs_by_tip_name(chain), *(link.name for link in chain.links)]
        yield Problem(
            document.span((*at, "link")),
            f"there is no link '{name}'",
            did_you_mean(name, known, 0.8) or f"the links are {', '.join(known)}",
        )


def _is_nonzero(data: Mapping[str, Any]) -> bool:
    vectors = (*data.get("force", ()), *data.get("moment", ()))
    factors = [factor for _, factor in data.get("waypoints", ((0, 1),))]
    return any(vectors) and any(factors)
