"""Errors and warnings about an assembly and its limbs that a schema cannot express."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import assembly, assembly_chain, definition_checks, link_checks
from somo_cli.manipulator import read as manipulator_read
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.definition import MAXIMUM_JOINTS
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.link_checks import IsSound
from somo_cli.problems import Pointer, Problem, has_errors


def assembly_problems(document: Document, at: Pointer, is_sound: IsSound) -> Iterator[Problem]:
    """Yield the errors and warnings about the definition or assembly at a pointer.

    Parts in which the schema found errors are skipped.
    """
    data = document.at(at)
    if not isinstance(data, Mapping) or not assembly.is_assembly(data):
        yield from definition_checks.definition_problems(document, at, is_sound)
        return
    if isinstance(data.get("urdf_filename"), str):
        place = (*at, "urdf_filename")
        yield from definition_checks.filename_problems(document, place, data["urdf_filename"])
    if isinstance(data.get("body_definition"), Mapping):
        yield from link_checks.link_problems(document, (*at, "body_definition"), is_sound)
    found: list[Problem] = []
    for index, limb in _limbs(data):
        found.extend(_limb_problems(document, (*at, "limbs", index), limb, is_sound))
    yield from found
    yield from _name_problems(document, at, data, is_sound)
    yield from _scale_problems(document, at, data, is_sound)
    if is_sound(at) and not has_errors(found):
        yield from _count_problems(document, at)


def wrong_file_kinds(document: Document, at: Pointer) -> Mapping[Pointer, Problem]:
    """Return, by pointer, one error for each limb that is a file of another kind.

    It replaces the schema's errors below that pointer.
    """
    data = document.at(at)
    found: dict[Pointer, Problem] = {}
    if not isinstance(data, Mapping) or not assembly.is_assembly(data):
        return found
    for index, limb in _limbs(data):
        definition: Any = limb.get("definition")
        place: Pointer = (*at, "limbs", index, "definition")
        hint = "name a manipulator definition: it has actuator_definitions"
        if assembly.is_assembly(definition):
            key = next(
                key for key in ("limbs", "assembly_name", "body_definition") if key in definition
            )
            message = "this is an assembly, but a limb must be a manipulator"
            found[place] = Problem(document.span((*place, key), key=True), message, hint)
        elif isinstance(definition, Mapping) and "manipulators" in definition:
            message = "this is a scene, not a manipulator definition"
            span = document.span((*place, "manipulators"), key=True)
            found[place] = Problem(span, message, hint)
    return found


def _limbs(data: Mapping[str, Any]) -> Iterator[tuple[int, Mapping[str, Any]]]:
    limbs = data.get("limbs")
    for index, limb in enumerate(limbs if isinstance(limbs, list) else ()):
        if isinstance(limb, Mapping):
            yield index, limb


def _limb_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    place = (*at, "definition")
    if "definition" not in data:
        return
    found = list(definition_checks.definition_problems(document, place, is_sound))
    yield from found
    if not is_sound(place) or has_errors(found):
        return
    if not build_chain(manipulator_read.read(document, place)).joints:
        yield Problem(
            document.span(place),
            "no joint of this limb moves",
            "make it part of the body: give body_definition its shape and mass",
        )


def _name_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    seen: set[str] = set()
    for index, limb in _limbs(data):
        place: Pointer = (*at, "limbs", index, "name")
        if "name" not in limb or not is_sound(place):
            continue
        if limb["name"] in seen:
            message = f"two limbs are called '{limb['name']}'"
            hint = "give each limb a different name"
            yield Problem(document.span(place), message, hint)
        seen.add(limb["name"])


def _scale_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_sound: IsSound
) -> Iterator[Problem]:
    """Yield an error for each limb with another world scale than the first.

    There is none if the assembly has its own world scale.
    """
    if "world_scale" in data:
        return
    first = None
    for index, limb in _limbs(data):
        place: Pointer = (*at, "limbs", index, "definition")
        if not isinstance(limb.get("definition"), Mapping):
            continue
        if not is_sound((*place, "world_scale")):
            continue
        scale = manipulator_read.world_scale(document, place) or Scale()
        first = first or scale
        if scale != first:
            yield Problem(
                document.span(place, key=True),
                f"this limb has world_scale {scale.described()}, the first one {first.described()}",
                "set world_scale in the assembly: it applies to all limbs",
            )


def _count_problems(document: Document, at: Pointer) -> Iterator[Problem]:
    count = len(assembly_chain.build(assembly.read(document, at)).joints)
    if count > MAXIMUM_JOINTS:
        yield Problem(
            document.span((*at, "limbs"), key=True),
            f"{count} joints, but the engine ignores commands beyond {MAXIMUM_JOINTS} joints",
            "use fewer limbs, or fewer and longer segments",
        )
