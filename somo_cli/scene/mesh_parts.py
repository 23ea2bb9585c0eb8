"""Load the parts of an OBJ or STL text as triangle meshes, and check their numbers."""

from __future__ import annotations

import logging
import re
import warnings
from io import BytesIO
from typing import Any

import numpy as np

from somo_cli.manipulator.geometry import Vector
from somo_cli.problems import MAX_NUMBER

FORMATS = (".obj", ".stl")
MAX_PARTS = 1000
"""The most named parts of an OBJ: measuring one takes 0.3 ms."""
_NAME_OF_PART = re.compile(r"^[ \t]*[og][ \t]", re.MULTILINE)


class MeshError(ValueError):
    """A mesh that cannot be used: the reason, and a hint how to correct it."""

    def __init__(self, message: str, hint: str) -> None:
        self.hint = hint
        super().__init__(message)


def usable_parts(text: str, source: str, scale: Vector) -> list[Any]:
    """Return the parts of a mesh file as trimesh meshes, with the axes scaled by three factors.

    Raises MeshError.
    """
    parts = _load_parts(text, source)
    for part in parts:
        _require_usable(part)
        part.apply_scale(scale)
        _require_bounded(part)
    return parts


def joined(parts: list[Any]) -> Any:
    """Return one mesh with the vertices and faces of all parts."""
    import trimesh

    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    vertices = np.concatenate([part.vertices for part in parts])
    return trimesh.Trimesh(vertices, np.concatenate(faces), process=False)


def _load_parts(text: str, source: str) -> list[Any]:
    import trimesh

    kind = next((one for one in FORMATS if source.lower().endswith(one)), None)
    if kind is None:
        raise MeshError(
            "this is neither an OBJ nor an STL file", "its name must end in .obj or .stl"
        )
    log = logging.getLogger("trimesh")
    if not log.handlers:
        # without a handler, trimesh prints a traceback of each error that is reported below
        log.addHandler(logging.NullHandler())
    content = text.encode("utf-8", "surrogateescape")
    # trimesh 5.2 does not wrap the errors that its parsing causes
    parsing_errors = (
        *(ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError),
        DeprecationWarning,
    )
    options: dict[str, Any] = {}
    if kind == ".obj":
        _require_few_parts(text)
        options = {"skip_materials": True, "group_material": False}
        options |= {"split_objects": True, "split_groups": True}
    try:
        with warnings.catch_warnings():
            # numpy before 2.3 only warns, and omits the numbers that it cannot read
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            scene = trimesh.load_scene(
                BytesIO(content), file_type=kind[1:], process=False, **options
            )
    except parsing_errors as error:
        reason = (str(error).splitlines() or [""])[0]
        raise MeshError(
            f"this cannot be read: {reason}", "export it again, as triangles"
        ) from error
    # seen in trimesh 5.2: the last part comes first
    found = [one for one in reversed(scene.geometry.values()) if hasattr(one, "faces")]
    if not any(len(one.faces) for one in found):
        raise MeshError("it has no faces", "export it again, as triangles")
    return [one for one in found if len(one.faces)]


def _require_few_parts(text: str) -> None:
    parts = len(_NAME_OF_PART.findall(text))
    if parts > MAX_PARTS:
        message = f"it has {parts} named parts; at most {MAX_PARTS} are allowed"
        raise MeshError(message, "join parts, or leave out their names (o, g)")


def _require_usable(mesh: Any) -> None:
    hint = "export it again, as triangles"
    if mesh.vertices.ndim != 2 or mesh.vertices.shape[1:] != (3,) or not len(mesh.faces):
        raise MeshError("it has no faces", hint)
    if not np.isfinite(mesh.vertices).all():
        raise MeshError("one of its vertices is not finite", hint)
    if not (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices)):
        raise MeshError("a face names a vertex that does not exist", hint)


def _require_bounded(mesh: Any) -> None:
    extent = float(np.abs(mesh.vertices).max())
    if extent > MAX_NUMBER:
        message = f"one of its vertices is at {extent:.3g} m"
        raise MeshError(message, f"no number may be larger than {MAX_NUMBER:g}")
