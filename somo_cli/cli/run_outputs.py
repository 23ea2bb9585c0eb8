"""Choose the columns that a run records, and the files of its rows and contact events."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import typer

from somo_cli import files, output_files
from somo_cli.cli.application import require
from somo_cli.cli.outputs import Output

if TYPE_CHECKING:
    from somo_cli.api.runs import PreparedRun
    from somo_cli.scene.model import Scene
    from somo_cli.simulation.run import RunSummary

Targets: TypeAlias = tuple[str, str | None]
"""The path of the rows, and of the contact events if they are recorded."""


def with_columns(scene: Scene, patterns: Sequence[str]) -> Scene:
    """Return the scene with the columns that --record selects; exit with a usage error if wrong."""
    from somo_cli.scene.checks.recording import select_by_patterns

    try:
        return select_by_patterns(scene, patterns)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--record'") from error


def target_of_events(scene: Scene, output: str, events: str | None) -> str | None:
    """Return the path of contact events: the option, else beside the output, None if unwanted."""
    if events is None and scene.has_contact_events:
        message = "the scene records events, but the rows go to no file: name a file for the events"
        require(_is_file(output), "--events", message)
        return beside(output, "events.csv")
    if events is not None:
        from somo_cli.scene.checks.recording import AMBIGUOUS_GROUND, is_ground_name_ambiguous

        require(not is_ground_name_ambiguous(scene), "--events", AMBIGUOUS_GROUND)
        require(not events == output == "-", "--events", "- is the output of the rows")
    return events


def outputs_of(targets: Targets) -> list[Output]:
    """Return every file that a run writes, those of unfinished rows and events included."""
    output, events = targets
    found: list[Output] = []
    if _is_file(output):
        paths = (output, f"{output}.partial", beside(output, "meta.json"))
        found += [(path, "--output") for path in paths]
    if events is not None and _is_file(events):
        found += [(path, "--events") for path in (events, f"{events}.partial")]
    return found


def metadata_of(
    prepared: PreparedRun,
    summary: RunSummary,
    sets: Sequence[str],
    output: str,
    events: int | None,
) -> dict[str, Any]:
    """Return the metadata of a run, with the path of its scene from the output on."""
    about = prepared.metadata(summary, sets)
    about["scene"] = files.relative_path(prepared.document.source, output)
    if events is not None:
        about["events"] = events
    return about


def write_metadata(output: str, about: Mapping[str, Any]) -> None:
    """Write metadata beside an output, unless that is a stream or a device."""
    if _is_file(output):
        text = json.dumps(about, indent=2) + "\n"
        output_files.write_atomically(beside(output, "meta.json"), text)


def _is_file(output: str) -> bool:
    """Whether an output is a file, beside which others can stand."""
    return output != "-" and not output_files.is_direct(output)


def beside(output: str, suffix: str) -> str:
    """Return the path beside an output with another suffix than its `.csv`."""
    path = Path(output)
    stem = path.name.removesuffix(".csv")
    return str(path.with_name(f"{stem}.{suffix}"))
