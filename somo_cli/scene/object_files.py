"""Replace the paths of meshes and URDFs in the objects of a scene by their texts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from somo_cli.document.include import include
from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene import urdf_xml

MAX_MESH_BYTES = 20_000_000  # bytes

_MESHES = (("objects", "*", "mesh"), ("objects", "*", "mesh", "*"))
_URDFS = (("objects", "*", "urdf"),)
_MESHES_OF_URDFS = (("objects", "*", "urdf", "meshes", "*"),)
FILE_POINTERS: tuple[tuple[str, ...], ...] = (*_MESHES, *_URDFS, *_MESHES_OF_URDFS)
"""The places where an object may name a file instead of holding its text."""


def include_object_files(
    document: Document, open_text: Callable[..., tuple[str, str]]
) -> tuple[Document, tuple[Problem, ...]]:
    """Return the document with every path replaced by a mapping of source and text, and the errors.

    `open_text` is `files.open_reference`. Paths of meshes in a URDF are relative to the URDF, and
    may lead into the folder of the scene.
    """
    open_mesh = partial(open_text, largest=MAX_MESH_BYTES, is_binary=True)
    open_mesh_of_urdf = partial(open_mesh, root=document.source)
    document, of_meshes = include(document, _MESHES, open_mesh, _mesh)
    document, of_urdfs = include(document, _URDFS, open_text, _urdf)
    document, of_both = include(document, _MESHES_OF_URDFS, open_mesh_of_urdf, _mesh)
    return document, (*of_meshes, *of_urdfs, *of_both)


def _mesh(text: str, source: str, naming: Span) -> Document:
    # errors in a mesh are reported where the scene names it: nobody reads the lines of a mesh
    return Document(
        source, {"source": source, "text": text}, {source: text}, {(): (naming, naming)}
    )


def _urdf(text: str, source: str, naming: Span) -> Document:
    names = urdf_xml.mesh_filenames(text, source)
    data = {"source": source, "text": text, "meshes": list(names)}
    spans: dict[Pointer, tuple[Span, Span]] = {(): (naming, naming)}
    for index, span in enumerate(names.values()):
        spans["meshes", index] = (span, span)
    return Document(source, data, {source: text}, spans)


def with_pieces(document: Document, pieces: Callable[[str, str], str | None]) -> Document:
    """Return the document with convex pieces added to each mesh of objects with hulls: decompose.

    `pieces(text, source)` returns the pieces as an OBJ text, or None if it cannot compute them.
    """
    data = document.data
    if not isinstance(data, dict) or not isinstance(data.get("objects"), list):
        return document
    objects = data["objects"]
    if not any(map(_is_decomposed, objects)):
        return document
    completed = [
        _object_with_pieces(one, pieces) if _is_decomposed(one) else one for one in objects
    ]
    return replace(document, data={**data, "objects": completed})


def _is_decomposed(item: Any) -> bool:
    return isinstance(item, dict) and item.get("hulls") == "decompose"


def _object_with_pieces(
    item: dict[str, Any], pieces: Callable[[str, str], str | None]
) -> dict[str, Any]:
    return {
        key: _with_pieces(value, pieces) if key in ("mesh", "urdf") else value
        for key, value in item.items()
    }


def _with_pieces(file: Any, pieces: Callable[[str, str], str | None]) -> Any:
    """Return a mesh, a list of meshes or a URDF with its pieces, anything else unchanged."""
    if isinstance(file, list):
        return [_with_pieces(one, pieces) for one in file]
    if not isinstance(file, dict) or "pieces" in file:
        return file
    if "meshes" in file:
        return {**file, "meshes": _with_pieces(file["meshes"], pieces)}
    text, source = file.get("text"), file.get("source")
    found = pieces(text, source) if isinstance(text, str) and isinstance(source, str) else None
    return file if found is None else {**file, "pieces": found}
