"""Check the limbs that an entry of `actuation` names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.definition import Definition
from somo_cli.problems import Pointer, Problem, did_you_mean


def limb_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], definition: Definition
) -> Iterator[Problem]:
    """Yield an error for each limb that the entry `data` at `at` names wrongly or fails to name."""
    given = [key for key in ("limb", "limbs") if key in data]
    known = [limb.name for limb in definition.limbs]
    if not known:
        for key in given:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for an assembly, and '{definition.name}' has no limbs",
                "leave it out",
            )
    elif not given:
        yield Problem(
            document.span(at, key=True),
            "missing key 'limb'",
            f"name one limb, or several with limbs; {_known_limbs_hint(known)}",
        )
    elif len(given) > 1:
        yield Problem(
            document.span((*at, "limbs"), key=True),
            "both limb and limbs are given",
            "keep one of them",
        )
    else:
        yield from _unknown_limb_problems(document, (*at, given[0]), data[given[0]], known)


def _unknown_limb_problems(
    document: Document, at: Pointer, value: Any, known: list[str]
) -> Iterator[Problem]:
    names = enumerate(value) if isinstance(value, list) else [(None, value)]
    for index, name in names:
        if name in known or (at[-1] == "limbs" and index is None):
            continue
        yield Problem(
            document.span(at if index is None else (*at, index)),
            f"there is no limb '{name}'",
            did_you_mean(name, known) or _known_limbs_hint(known),
        )


def _known_limbs_hint(known: list[str]) -> str:
    if len(known) == 1:
        return f"the only limb is '{known[0]}'"
    return f"the limbs are {', '.join(known)}"
