"""Check one manipulator of a scene: its base, start, actuation and loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import assembly_checks
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled, DefinitionCompiler
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, has_errors
from somo_cli.scene.checks import actuation as actuation_checks
from somo_cli.scene.checks import actuation_targets as actuation_target_checks
from somo_cli.scene.checks import ground as ground_checks
from somo_cli.scene.checks import loads as loads_checks
from somo_cli.scene.checks import motion as motion_checks
from somo_cli.scene.model import NEUTRAL
from somo_cli.scene.reader import initial_angles_of


def manipulator_problems(
    document: Document,
    index: int,
    data: Mapping[str, Any],
    is_sound: IsSound,
    channel_counts: Mapping[str, int | None],
    definitions: DefinitionCompiler,
) -> Iterator[Problem]:
    """Yield the errors and warnings about the manipulator `data`, number `index` of its scene.

    `channel_counts` has the number of channels of each trajectory, None if it is unknown;
    `definitions` compiles the manipulator's definition if it has no error.
    """
    at: Pointer = ("manipulators", index)
    definition_at: Pointer = (*at, "definition")
    has_definition = "definition" in data
    in_definition: list[Problem] = []
    if has_definition:
        in_definition.extend(assembly_checks.assembly_problems(document, definition_at, is_sound))
    yield from in_definition
    yield from _base_problems(document, at, data, is_sound, channel_counts)
    yield from _entry_problems(document, at, data, is_sound)
    if has_definition and is_sound(definition_at) and not has_errors(in_definition):
        compiled = definitions.at(definition_at)
        yield from _compiled_problems(document, at, data, is_sound, channel_counts, compiled)


def _base_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    is_sound: IsSound,
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    base = data.get("base", "static")
    for key in ("linear_velocity", "angular_velocity"):
        if key in data and base in ("static", "constrained"):
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} is for a free base, and this one is {base}",
                "set base: free, or leave it out",
            )
    place: Pointer = (*at, "motion")
    if is_sound(place) and isinstance(data.get("motion"), Mapping):
        yield from motion_checks.base_motion_problems(document, at, data, channel_counts)


def _entries(data: Mapping[str, Any], key: str) -> list[Any]:
    entries = data.get(key)
    return entries if isinstance(entries, list) else []


def _entry_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield the errors of actuation and loads that can be found without the definition."""
    for number, entry in enumerate(_entries(data, "actuation")):
        place: Pointer = (*at, "actuation", number)
        if isinstance(entry, Mapping) and is_sound(place):
            yield from actuation_checks.actuation_problems(document, place, entry)
    base = str(data.get("base", "static"))
    for number, entry in enumerate(_entries(data, "loads")):
        place = (*at, "loads", number)
        if isinstance(entry, Mapping) and is_sound(place):
            yield from loads_checks.load_problems(document, place, entry, base)


def _compiled_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    is_sound: IsSound,
    channel_counts: Mapping[str, int | None],
    compiled: Compiled,
) -> Iterator[Problem]:
    """Yield the errors that can be found only with the compiled definition."""
    chain = compiled.chain
    if not chain.joints:
        yield Problem(
            document.span((*at, "definition")),
            "no joint of this manipulator moves, so there is nothing to simulate",
        )
    yield from _start_problems(document, at, data, chain, is_sound)
    yield from ground_checks.ground_problems(document, at, data, chain, is_sound)
    place: Pointer = (*at, "actuation")
    if is_sound(place):
        yield from actuation_target_checks.actuation_target_problems(
            document, place, _entries(data, "actuation"), compiled, channel_counts
        )
    for number, entry in enumerate(_entries(data, "loads")):
        place = (*at, "loads", number)
        if is_sound(place):
            yield from loads_checks.load_link_problems(document, place, entry, chain)


def _start_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], chain: Chain, is_sound: IsSound
) -> Iterator[Problem]:
    count = len(chain.joints)
    has_counts = True
    for key in ("initial_angles", "initial_rates"):
        values = data.get(key)
        if is_sound((*at, key)) and isinstance(values, list) and len(values) != count:
            yield Problem(
                document.span((*at, key)),
                f"{key} has {len(values)} values for {count} joints",
                "give one value per joint, base to tip, or one number for all",
            )
            has_counts = False
    if has_counts and is_sound((*at, "initial_angles")):
        yield from _joint_limit_problems(document, at, data.get("initial_angles"), chain)


def _joint_limit_problems(
    document: Document, at: Pointer, initial_angles: Any, chain: Chain
) -> Iterator[Problem]:
    place = document.span((*at, "initial_angles"))
    hint = "start within the limits, or widen them in the definition"
    is_list, is_neutral = isinstance(initial_angles, list), initial_angles == NEUTRAL
    if initial_angles is None:
        place, hint = document.span((*at, "definition"), key=True), "set initial_angles"
    elif is_neutral:
        hint = "change joint_neutral_position or the limits in the definition, or start elsewhere"
    reported: set[object] = set()
    angles = initial_angles_of(initial_angles or 0, chain)
    for index, (joint, angle) in enumerate(zip(chain.joints, angles, strict=True)):
        if not joint.is_limited or joint.lower <= angle <= joint.upper:
            continue
        # one number for all joints is one error, and so is the neutral position of one axis
        cause = (joint.actuator, joint.channel) if is_neutral else None
        if not is_list and cause in reported:
            continue
        reported.add(cause)
        where = f"its neutral position, {angle:g} rad" if is_neutral else f"{angle:g} rad"
        yield Problem(
            document.span((*at, "initial_angles", index)) if is_list else place,
            f"joint '{joint.name}' starts at {where}, outside its limits "
            f"[{joint.lower:g}, {joint.upper:g}]",
            hint,
        )
