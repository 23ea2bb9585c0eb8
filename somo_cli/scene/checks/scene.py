"""Check a scene and the definitions in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from somo_cli.document.include import unresolved_references
from somo_cli.document.parse import Document
from somo_cli.document.validate import schema_problems, soundness_test
from somo_cli.manipulator import assembly, assembly_checks
from somo_cli.manipulator.compile import DefinitionCompiler
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, has_errors, in_reading_order
from somo_cli.scene import motion_files, object_files
from somo_cli.scene.checks import objects as objects_checks
from somo_cli.scene.checks import recording as recording_checks
from somo_cli.scene.checks import soft_ground as soft_ground_checks
from somo_cli.scene.checks import sorotraj as sorotraj_checks
from somo_cli.scene.checks import stop_conditions as stop_conditions_checks
from somo_cli.scene.checks.manipulator import manipulator_problems
from somo_cli.scene.model import AUTOMATIC_TIME_STEP, FILE_POINTERS, Scene
from somo_cli.scene.reader import manipulator_name_of, read_scene

NO_AUTOMATIC_TIME_STEP = (
    "no time step can be chosen: one is chosen for joints of manipulators, and the scene has none"
)


@dataclass(frozen=True, slots=True)
class CheckedScene:
    """All errors and warnings about a scene, in reading order, and the scene if it has no error."""

    problems: tuple[Problem, ...]
    scene: Scene | None


def scene_problems(document: Document) -> tuple[Problem, ...]:
    """Return all errors and warnings about a scene and its definitions, in reading order."""
    return check_scene(document).problems


def check_scene(document: Document) -> CheckedScene:
    """Check a scene and its definitions; compile each definition without errors once."""
    definitions = DefinitionCompiler(document)
    in_schema = schema_problems(document, "scene")
    missing = unresolved_references(
        document, (*FILE_POINTERS, *object_files.FILE_POINTERS, *motion_files.FILE_POINTERS)
    )
    is_sound = soundness_test(in_schema, missing)
    misplaced_files = _misplaced_files(document)
    problems = [
        found.problem for found in in_schema if not _is_below_any(found.pointer, misplaced_files)
    ]
    problems.extend(misplaced_files.values())
    data = document.data
    problems.extend(sorotraj_checks.scene_trajectory_problems(document, is_sound))
    channel_counts = sorotraj_checks.channel_counts_by_trajectory(document, is_sound)
    problems.extend(objects_checks.object_problems(document, is_sound, channel_counts))
    manipulators = data.get("manipulators") if isinstance(data, Mapping) else None
    if isinstance(manipulators, list):
        for index, item in enumerate(manipulators):
            if isinstance(item, Mapping):
                problems.extend(
                    manipulator_problems(
                        document, index, item, is_sound, channel_counts, definitions
                    )
                )
        problems.extend(_name_problems(document, manipulators, is_sound))
        problems.extend(_scale_problems(document, manipulators, is_sound))
    if is_sound(()):
        problems.extend(_problems_without_manipulators(document))
    problems.extend(stop_conditions_checks.stop_condition_problems(document, is_sound))
    if missing or has_errors(problems):
        return CheckedScene(in_reading_order(problems, document.texts), None)
    scene = read_scene(document, definitions)
    problems.extend(recording_checks.recording_problems(document, scene))
    problems.extend(soft_ground_checks.soft_ground_problems(document, scene))
    is_sound_as_a_whole = not has_errors(problems)
    return CheckedScene(
        in_reading_order(problems, document.texts), scene if is_sound_as_a_whole else None
    )


def _problems_without_manipulators(document: Document) -> Iterator[Problem]:
    """Yield what is wrong with a scene of objects alone; its shape is that of the schema."""
    data: Any = document.data
    if data.get("manipulators"):
        return
    if all(item.get("fixed", False) for item in data.get("objects", ())):
        yield Problem(
            document.span(("manipulators",), key=True),
            "the scene has no manipulators and no object that can move, so nothing happens in it",
            "add manipulators, or an object that is not fixed",
        )
    if data.get("time_step") == AUTOMATIC_TIME_STEP:
        yield Problem(document.span(("time_step",)), NO_AUTOMATIC_TIME_STEP, "give a number")
    if data.get("record", {}).get("columns"):
        yield Problem(
            document.span(("record", "columns"), key=True),
            "these are columns of manipulators, and the scene has none",
            "leave it out; record.objects says what is recorded of objects",
            "warning",
        )


def _is_below_any(pointer: Pointer, places: Mapping[Pointer, Problem]) -> bool:
    return any(pointer[: len(place)] == place for place in places)


def _misplaced_files(document: Document) -> Mapping[Pointer, Problem]:
    """Return, by pointer, one error for each file of another kind that is named as a definition.

    It replaces the schema's errors below that pointer.
    """
    data = document.data
    manipulators = data.get("manipulators") if isinstance(data, Mapping) else None
    misplaced_files: dict[Pointer, Problem] = {}
    for index, item in enumerate(manipulators if isinstance(manipulators, list) else ()):
        definition = item.get("definition") if isinstance(item, Mapping) else None
        at: Pointer = ("manipulators", index, "definition")
        if isinstance(definition, Mapping):
            misplaced_files.update(assembly_checks.wrong_file_kinds(document, at))
        if isinstance(definition, Mapping) and "manipulators" in definition:
            misplaced_files[at] = Problem(
                document.span((*at, "manipulators"), key=True),
                "this is a scene, not a manipulator definition",
                "name a manipulator definition: it has actuator_definitions",
            )
    return misplaced_files


def _name_problems(
    document: Document, manipulators: list[Any], is_sound: IsSound
) -> Iterator[Problem]:
    seen: set[str] = set()
    for index, item in enumerate(manipulators):
        at: Pointer = ("manipulators", index)
        if not is_sound((*at, "name")) or not isinstance(item, Mapping):
            continue
        if "name" not in item and not _has_name(item):
            continue
        name = str(item["name"]) if "name" in item else manipulator_name_of(item)
        if name in seen:
            has_name = "name" in item
            yield Problem(
                document.span((*at, "name" if has_name else "definition"), key=not has_name),
                f"two manipulators are called '{name}'",
                "give each manipulator a different name",
            )
        seen.add(name)


def _has_name(item: Mapping[str, Any]) -> bool:
    definition = item.get("definition")
    keys = {"manipulator_name", "assembly_name"}
    return isinstance(definition, Mapping) and not keys.isdisjoint(definition)


def _scale_problems(
    document: Document, manipulators: list[Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for each definition with another scale than the first."""
    data = document.data
    if not isinstance(data, Mapping) or "world_scale" in data:
        return
    first = None
    for index, item in enumerate(manipulators):
        at: Pointer = ("manipulators", index, "definition")
        is_mapping = isinstance(item, Mapping) and isinstance(item.get("definition"), Mapping)
        if not is_mapping or not is_sound((*at, "world_scale")):
            continue
        scale = assembly.world_scale(document, at)
        scale = scale or Scale()
        first = first or scale
        if scale != first:
            yield Problem(
                document.span(at, key=True),
                f"this definition has world_scale {scale.described()}, "
                f"the first one {first.described()}",
                "set world_scale in the scene: it applies to all",
            )
