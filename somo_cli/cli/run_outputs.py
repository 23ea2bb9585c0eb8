"""What a run writes and where: columns picked on the command line, and the place of events."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from somo_cli import files
from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.scene.model import Scene

Targets: TypeAlias = tuple[str, str | None]
"""Where rows go, and where events go if anywhere."""

_TWO_GROUNDS = "the scene calls something ground, as the ground is called in contacts: rename it"


def with_columns(scene: Scene, patterns: Sequence[str]) -> Scene:
    """Return the scene with columns picked from all there are."""
    from somo_cli.scene.checks.recording import is_ground_name_ambiguous, unmatched_pattern_hint
    from somo_cli.scene.model import ALL_OBJECT_QUANTITIES, ALL_QUANTITIES

    require(not is_ground_name_ambiguous(scene), "--record", _TWO_GROUNDS)
    whole = dataclasses.replace(
        scene, columns=ALL_QUANTITIES, object_quantities=ALL_OBJECT_QUANTITIES
    )
    for pattern in patterns:
        hint = unmatched_pattern_hint(whole, pattern)
        require(hint is None, "--record", f"no column matches {pattern!r}; {hint}")
    return dataclasses.replace(whole, only=tuple(patterns))


def target_of_events(scene: Scene, output: str, events: str | None) -> str | None:
    """Return where events go: beside the output unless told; nowhere if nobody asks for them."""
    if events is None and scene.has_contact_events:
        message = "the scene records events, and there is no file to put them beside: name one"
        require(output != "-" and not files.is_direct(output), "--events", message)
        return beside(output, "events.csv")
    if events is not None:
        from somo_cli.scene.checks.recording import is_ground_name_ambiguous

        require(not is_ground_name_ambiguous(scene), "--events", _TWO_GROUNDS)
        is_same = os.path.realpath(events) == os.path.realpath(output)
        require(not is_same, "--events", f"{events} is where the rows go")
    return events


def beside(output: str, report_errors: str) -> str:
    """Return the path beside an output with another report_errors than its `.csv`."""
    path = Path(output)
    stem = path.name.removesuffix(".csv")
    return str(path.with_name(f"{stem}.{report_errors}"))
