"""Check trajectories in the format of sorotraj."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, cast

from somo_cli.document.parse import Document
from somo_cli.document.validate import schema_problems
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, in_reading_order
from somo_cli.scene.sorotraj import SAMPLED_WAVEFORMS

_WAVEFORM_KEYS = ("waveform_type", "waveform_freq", "waveform_max", "waveform_min")
_CHANNEL_LIST_KEYS = ("waveform_max", "waveform_min", "channels")


def is_trajectory(document: Document) -> bool:
    """Return whether a document has the keys of a trajectory file."""
    data = document.data
    return isinstance(data, dict) and {"settings", "config"} <= data.keys()


def trajectory_file_problems(document: Document) -> tuple[Problem, ...]:
    """Return all errors in a trajectory file, in reading order."""
    problems = [found.problem for found in schema_problems(document, "sorotraj")]
    if not problems:
        problems.extend(trajectory_problems(document, (), cast(Mapping[str, Any], document.data)))
    return in_reading_order(problems, document.texts)


def _trajectory_entries(document: Document) -> list[Any]:
    data = document.data
    found = data.get("trajectories") if isinstance(data, Mapping) else None
    return found if isinstance(found, list) else []


def scene_trajectory_problems(document: Document, is_sound: IsSound) -> Iterator[Problem]:
    """Yield the errors of the trajectories that a scene names."""
    seen: set[str] = set()
    for index, item in enumerate(_trajectory_entries(document)):
        at: Pointer = ("trajectories", index)
        if not isinstance(item, Mapping) or not is_sound(at):
            continue
        yield from trajectory_problems(document, (*at, "sorotraj"), item["sorotraj"])
        yield from trajectory_use_problems(document, at, item)
        if item["name"] in seen:
            place = document.span((*at, "name"))
            yield Problem(place, f"two trajectories are called '{item['name']}'")
        seen.add(item["name"])


def channel_counts_by_trajectory(document: Document, is_sound: IsSound) -> Mapping[str, int | None]:
    """Return the number of channels of each trajectory, None for those with errors."""
    return {
        str(item["name"]): channel_count(item["sorotraj"])
        if is_sound(("trajectories", index))
        else None
        for index, item in enumerate(_trajectory_entries(document))
        if isinstance(item, Mapping) and "name" in item
    }


def trajectory_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the errors of a trajectory at `at` that fits the schema."""
    config = data["config"]
    here: Pointer = (*at, "config")
    setpoints = config.get("setpoints") or {}
    count = channel_count(data)
    for part in ("prefix", "main", "suffix"):
        yield from _knot_problems(
            document, (*here, "setpoints", part), setpoints.get(part) or [], count
        )
    if data["settings"]["traj_type"] == "waveform":
        yield from _waveform_problems(document, here, config)
    else:
        is_cubic = _is_cubic(data)
        yield from _main_part_problems(document, here, setpoints.get("main") or [], is_cubic)
    if _needs_samples(data) and config.get("subsample_num") is None:
        yield Problem(
            document.span(here, key=True),
            "missing key 'subsample_num'",
            "give the number of samples of the main part",
        )


def _is_cubic(data: Mapping[str, Any]) -> bool:
    kind: str = data["settings"]["traj_type"]
    return kind == "interp" and bool(data["config"].get("interp_type") == "cubic")


def _needs_samples(data: Mapping[str, Any]) -> bool:
    """Return whether sorotraj samples the main part."""
    config = data["config"]
    if data["settings"]["traj_type"] == "waveform":
        return config.get("waveform_type") in SAMPLED_WAVEFORMS
    main = (config.get("setpoints") or {}).get("main") or []
    return len(main) > 1 and _is_cubic(data)


def _main_part_problems(
    document: Document, at: Pointer, rows: list[list[float]], is_cubic: bool
) -> Iterator[Problem]:
    """Yield the errors of a main part that its knots define."""
    if len(rows) < 2:
        place = document.span((*at, "setpoints", "main"), key=not rows)
        yield Problem(place, f"the main part has {len(rows)} knots", "give two or more")
    elif is_cubic and rows[0][1:] != rows[-1][1:]:
        place = document.span((*at, "setpoints", "main", len(rows) - 1))
        message = "a cubic main part must end with the values it starts with"
        yield Problem(place, message, f"end with {rows[0][1:]}, or use linear")


def trajectory_use_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the errors in how the entry at `at` uses a trajectory without errors."""
    count = channel_count(data["sorotraj"])
    invert = data.get("invert")
    for index, channel in enumerate(invert if isinstance(invert, list) else ()):
        if channel >= count:
            yield Problem(
                document.span((*at, "invert", index)),
                f"there is no channel {channel}",
                f"the trajectory has {count} channels, numbered from 0",
            )


def channel_count(data: Mapping[str, Any]) -> int:
    """Return the number of channels, from `channels` of a waveform or the first main knot."""
    config = data["config"]
    if data["settings"]["traj_type"] == "waveform":
        return len(config.get("channels") or ())
    rows = (config.get("setpoints") or {}).get("main") or [[0]]
    return len(rows[0]) - 1


def _knot_problems(
    document: Document, at: Pointer, rows: list[list[float]], count: int
) -> Iterator[Problem]:
    for index, row in enumerate(rows):
        if len(row) - 1 != count:
            yield Problem(
                document.span((*at, index)),
                f"{len(row) - 1} channels in this knot, {count} in the main part",
                "a knot is [time, channel, channel, ...]",
            )
        if index and row[0] <= rows[index - 1][0]:
            yield Problem(
                document.span((*at, index)),
                f"time {row[0]} s does not come after {rows[index - 1][0]} s",
                "each knot needs a later time than the one before",
            )
    if rows and rows[0][0] < 0:
        place = document.span((*at, 0))
        yield Problem(place, f"time {rows[0][0]} s is before the start of the part")


def _waveform_problems(
    document: Document, at: Pointer, config: Mapping[str, Any]
) -> Iterator[Problem]:
    missing = [
        key for key in (*_WAVEFORM_KEYS, "channels", "num_cycles") if config.get(key) is None
    ]
    for key in missing:
        yield Problem(document.span(at, key=True), f"missing key '{key}'", "a waveform needs it")
    lengths = {key: len(config[key]) for key in _CHANNEL_LIST_KEYS if key not in missing}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{key} {length}" for key, length in lengths.items())
        *_, last = lengths.values()
        key = next(key for key in lengths if lengths[key] != last)
        yield Problem(
            document.span((*at, key)),
            f"the lists have different numbers of channels: {listed}",
            "give one value per channel in each",
        )
    if (config.get("setpoints") or {}).get("main"):
        place = document.span((*at, "setpoints", "main"), key=True)
        message = "main has no meaning for a waveform, which defines the main part itself"
        yield Problem(place, message, "leave it out, or use traj_type: direct")
