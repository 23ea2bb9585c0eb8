"""Write XML with exact numbers: the same tree gives the same bytes."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.urdf import number

_HEADER = '<?xml version="1.0" encoding="utf-8"?>\n'


def numbers(values: Iterable[float]) -> str:
    """Return numbers with blanks between them, each the shortest that reads back exactly."""
    return " ".join(number(value) for value in values)


def wxyz(rotation: Matrix) -> str:
    """Return the unit quaternion of a rotation as MuJoCo has it, real part first."""
    x, y, z, w = geometry.quaternion_from_rotation(rotation)
    return numbers((w, x, y, z))


def pose_attributes(position: Vector, rotation: Matrix) -> dict[str, str]:
    """Return `pos` and `quat` of MJCF, without those that are its defaults."""
    found = {}
    if position != geometry.ZERO:
        found["pos"] = numbers(position)
    if rotation != geometry.IDENTITY:
        found["quat"] = wxyz(rotation)
    return found


def document_text(root: ET.Element, comment: str) -> str:
    """Return the text of a document, with a comment as its second line."""
    ET.indent(root)
    safe = comment.replace("--", "- -")
    return f"{_HEADER}<!-- {safe} -->\n{ET.tostring(root, encoding='unicode')}\n"
