"""Recognise and read assemblies: several manipulators, the limbs, on one body."""

from __future__ import annotations

from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator import read as manipulator_read
from somo_cli.manipulator.definition import Definition, LimbDefinition, WorldScale
from somo_cli.problems import Pointer

_OWN_KEYS = frozenset({"assembly_name", "body_definition", "limbs"})
_OTHERS_KEYS = frozenset({"manipulators", "manipulator_name", "actuator_definitions"})


def is_assembly(data: object) -> bool:
    """Return whether the keys are those of an assembly, not of a manipulator or a scene."""
    keys = set(data) if isinstance(data, dict) else set()
    return not keys.isdisjoint(_OWN_KEYS) and keys.isdisjoint(_OTHERS_KEYS)


def read(document: Document, at: Pointer = ()) -> Definition:
    """Return the definition of a manipulator or an assembly at a pointer without errors."""
    data: Any = document.at(at)
    if not is_assembly(data):
        return manipulator_read.read(document, at)
    parts = [
        manipulator_read.read(document, (*at, "limbs", index, "definition"))
        for index in range(len(data["limbs"]))
    ]
    return Definition(
        name=data["assembly_name"],
        urdf_filename=manipulator_read.filename(data),
        base=manipulator_read.link_from(data["body_definition"]),
        actuators=tuple(actuator for part in parts for actuator in part.actuators),
        tips=(),
        limbs=tuple(
            LimbDefinition(
                name=item["name"],
                position=geometry.vector(item.get("position", (0, 0, 0))),
                rpy=geometry.vector(item.get("rpy", (0, 0, 0))),
                base=part.base,
                n_actuators=len(part.actuators),
                tips=part.tips,
            )
            for item, part in zip(data["limbs"], parts, strict=True)
        ),
    )


def world_scale(document: Document, at: Pointer = ()) -> WorldScale:
    """Return the world scale at a pointer, else that of an assembly's limbs; None without one."""
    data: Any = document.at(at)
    own = manipulator_read.world_scale(document, at)
    if own is not None or not is_assembly(data):
        return own
    limbs = data.get("limbs")
    for index, limb in enumerate(limbs if isinstance(limbs, list) else ()):
        if isinstance(limb, dict) and isinstance(limb.get("definition"), dict):
            return manipulator_read.world_scale(document, (*at, "limbs", index, "definition"))
    return None
