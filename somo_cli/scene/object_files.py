"""The files that objects of a scene name, meshes and URDFs, put where they are named, as texts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

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
