"""Load, check and build definitions and scenes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Literal, TypeAlias

from somo_cli import document_kinds, loading
from somo_cli.document.parse import Document
from somo_cli.manipulator.compile import Compiled, compile_definition
from somo_cli.manipulator.dimensions import Scale
from somo_cli.problems import InvalidFile, Problem, has_errors
from somo_cli.scene.model import is_scene

Source: TypeAlias = "Document | str | PathLike[str]"
"""A document that was loaded, or the path of a file to load."""


def load(
    path: str | PathLike[str],
    sets: Sequence[str] = (),
    allow_outside: bool = False,
    packages: Mapping[str, str] | None = None,
) -> Document:
    """Load a definition, an assembly, a scene or a trajectory, with the files that it names.

    `sets` overrides values as `--set` does, such as "integrator=euler". Files must be in the folder
    of the file that names them, or below, unless `allow_outside`; `packages` has the folders of
    names that begin with package:// or model://.

    Raises:
        InvalidFile: With every error of all files, each at its line and column.
        OSError: A file cannot be read.
    """
    document = loading.load(fspath(path), sets, allow_outside, packages)
    problems = loading.check(document)
    if has_errors(problems):
        raise InvalidFile(problems, document.texts)
    return document


def document_of(source: Source) -> Document:
    """Return a document as it is, or read the one at a path, without checking it.

    Raises InvalidFile if a text is not YAML or a file that it names cannot be included, and
    OSError.
    """
    return source if isinstance(source, Document) else loading.load(fspath(source))


def check(
    source: Source, allow_outside: bool = False, packages: Mapping[str, str] | None = None
) -> tuple[Problem, ...]:
    """Return all errors and warnings about a file, in reading order, without raising InvalidFile.

    If the engine is installed, they include bodies of a scene that overlap at the start. Raises
    OSError if the file cannot be read.
    """
    try:
        document = (
            source
            if isinstance(source, Document)
            else loading.load(fspath(source), (), allow_outside, packages)
        )
    except InvalidFile as error:
        return error.problems
    return loading.check_with_overlaps(document)


def compiled(source: Source) -> Compiled:
    """Return the compiled definition of a manipulator or an assembly.

    Raises InvalidFile and OSError.
    """
    document = document_of(source)
    document_kinds.refuse_scene(document)
    return compile_definition(document)


def build(
    source: Source,
    scale: float | None = None,
    tip_frame: str | None = None,
    format: Literal["urdf", "sdf", "mjcf"] = "urdf",
) -> str:
    """Return the text of a definition or an assembly as URDF, SDF or MJCF, or of a scene as MJCF.

    Lengths of a URDF are in engine units: metres times the length factor of the file's world_scale,
    or times `scale` if it is given. SDF and MJCF are in SI, their base fixed to the world. With
    `tip_frame` a massless link of that name is added at each tip; it names the site in the MJCF of
    a definition.

    Raises:
        InvalidFile: With every error, each at its line and column.
        OSError: A file cannot be read.
        ValueError: A scale or a tip frame is given where there is none.
    """
    if format != "urdf" and scale not in (None, 1):
        raise ValueError("SDF and MJCF are in SI: they take no scale")
    document = document_of(source)
    if format == "mjcf":
        return _mjcf(document, tip_frame)
    found = compiled(document)
    if format == "sdf":
        from somo_cli.exchange import sdf

        return sdf.render_chain(found.chain, tip_frame)
    own = found.scale or Scale()
    return found.urdf(own if scale is None else Scale(scale, own.mass), tip_frame)


def _mjcf(document: Document, tip_frame: str | None) -> str:
    # slow to import, and only MJCF needs the time step of its springs
    from somo_cli.analysis.explicit_springs import stable_step
    from somo_cli.exchange import mjcf, mjcf_scene

    scene, _ = loading.scene_of(document)
    if not is_scene(document):
        chain = scene.manipulators[0].compiled.chain
        return mjcf.render_chain(chain, stable_step(scene), tip_frame=tip_frame or "tip")
    name = Path(document.source).stem if document.source != "-" else "scene"
    if tip_frame is not None:
        raise ValueError("the sites of a scene are called tip")
    return mjcf_scene.render_scene(scene, name, stable_step(scene))
