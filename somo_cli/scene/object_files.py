"""The files that objects of a scene name, meshes and URDFs, put where they are named, as texts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
"""Where an object may name a file instead of holding its text."""


def include_object_files(
    document: Document, open_text: Callable[..., tuple[str, str]]
) -> tuple[Document, tuple[Problem, ...]]:
    """Put a mapping of source and text in place of every path; return the faults as well.

    `open_text` is `files.open_reference`. A URDF may name meshes in the folder of the scene.
    """
    open_mesh = partial(open_text, largest=MAX_MESH_BYTES, is_binary=True)
    open_mesh_of_urdf = partial(open_mesh, root=document.source)
    document, of_meshes = include(document, _MESHES, open_mesh, _mesh)
    document, of_urdfs = include(document, _URDFS, open_text, _urdf)
    document, of_both = include(document, _MESHES_OF_URDFS, open_mesh_of_urdf, _mesh)
    return document, (*of_meshes, *of_urdfs, *of_both)


def _mesh(text: str, source: str, naming: Span) -> Document:
    # faults of a mesh are told where it is named: nobody looks for a line in it
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
    """Put the convex pieces beside every mesh of objects that have hulls: decompose.

    `pieces(text, source)` gives them as an OBJ text, None if there are none to be had.
    """
    data = document.data
    objects = data.get("objects") if isinstance(data, Mapping) else None
    if not isinstance(data, dict) or not isinstance(objects, list):
        return document
    if not any(isinstance(one, dict) and one.get("hulls") == "decompose" for one in objects):
        return document

    def completed(file: Any) -> Any:
        if isinstance(file, list):
            return [completed(one) for one in file]
        if not isinstance(file, dict) or "pieces" in file:
            return file
        if "meshes" in file:
            return {**file, "meshes": completed(file["meshes"])}
        if not isinstance(file.get("text"), str) or not isinstance(file.get("source"), str):
            return file
        found = pieces(file["text"], file["source"])
        return file if found is None else {**file, "pieces": found}

    changed = [
        {key: completed(value) if key in ("mesh", "urdf") else value for key, value in one.items()}
        if isinstance(one, dict) and one.get("hulls") == "decompose"
        else one
        for one in objects
    ]
    return replace(document, data={**data, "objects": changed})
