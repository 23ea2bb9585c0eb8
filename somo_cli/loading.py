"""Load a file and the files that it names, check it, and make the scene to run."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial
from typing import Literal, TypeAlias

from somo_cli import document_kinds, files
from somo_cli.document.edit import override
from somo_cli.document.include import include
from somo_cli.document.parse import Document, parse
from somo_cli.manipulator import compile as compiler
from somo_cli.packages import Packages, open_reference
from somo_cli.problems import (
    EngineMissing,
    EngineRefused,
    InvalidFile,
    Problem,
    has_errors,
    in_reading_order,
)
from somo_cli.scene import model as scene_model
from somo_cli.scene import motion_files, object_files, proximity
from somo_cli.scene import reader as scene_reader
from somo_cli.scene.checks import scene as scene_checks
from somo_cli.scene.checks import sorotraj as sorotraj_checks
from somo_cli.scene.model import Scene

Auto: TypeAlias = Literal["auto"]


def load(
    path: str,
    sets: Sequence[str] = (),
    allow_outside: bool = False,
    packages: Packages | None = None,
    announce: Callable[[str], None] | None = None,
) -> Document:
    """Return a definition or scene with the files that it names, its values overridden by `sets`.

    Files must lie in the folder of the file that names them, or below, unless `allow_outside`.
    Names that start with package:// or model:// lie in the folders of `packages`. Raises OSError,
    and InvalidFile with all problems of the document if a file cannot be included. `announce` takes
    a message before each decomposition of a mesh.
    """
    return load_text(files.read_text(path), path, sets, allow_outside, packages, announce)


def load_text(
    text: str,
    source: str,
    sets: Sequence[str] = (),
    allow_outside: bool = False,
    packages: Packages | None = None,
    announce: Callable[[str], None] | None = None,
) -> Document:
    """Return what `load` does, from a text; the files that it names are relative to `source`."""
    document = _with_parts(parse(text, source), allow_outside, packages or {}, announce)
    return with_overrides(document, sets, allow_outside, packages, announce)


def with_overrides(
    document: Document,
    sets: Sequence[str],
    allow_outside: bool = False,
    packages: Packages | None = None,
    announce: Callable[[str], None] | None = None,
) -> Document:
    """Return a loaded document with values overridden by `sets`; raises what `load` raises."""
    for assignment in sets:
        changed = override(document, assignment)
        document = _with_parts(changed, allow_outside, packages or {}, announce)
    return document


def check(document: Document) -> tuple[Problem, ...]:
    """Return all errors and warnings about a definition, an assembly, a scene or a trajectory."""
    if sorotraj_checks.is_trajectory(document):
        return sorotraj_checks.trajectory_file_problems(document)
    return (
        scene_checks.scene_problems(document)
        if scene_model.is_scene(document)
        else compiler.document_problems(document)
    )


def check_with_overlaps(document: Document) -> tuple[Problem, ...]:
    """Return the problems that `check` finds and, without errors, the overlaps at the start.

    All are in reading order. The engine finds overlaps; without an engine none are reported.
    """
    if not scene_model.is_scene(document) or sorotraj_checks.is_trajectory(document):
        return check(document)
    checked = scene_checks.check_scene(document)
    if checked.scene is None:
        return checked.problems
    found = (*checked.problems, *overlaps(document, checked.scene))
    return in_reading_order(found, document.texts)


def as_scene(document: Document) -> Document:
    """Return a scene as it is, and a definition as the scene of that manipulator alone."""
    return (
        document
        if scene_model.is_scene(document)
        else scene_model.single_manipulator_scene(document)
    )


def scene_of(
    document: Document, every: int | None = None, time_step: float | Auto | None = None
) -> tuple[Scene, tuple[Problem, ...]]:
    """Return the scene of a document and the warnings about it; raise InvalidFile for errors.

    A definition becomes the scene of that one manipulator. `every` (steps between two rows) and
    `time_step` [s] replace what the scene says; for "auto" the recommended time step is taken.
    """
    document_kinds.refuse_trajectory(document)
    document_kinds.refuse_study(document)
    if not scene_model.is_scene(document):
        problems = compiler.document_problems(document)
        if has_errors(problems):
            raise InvalidFile(problems, document.texts)
        document = as_scene(document)
    checked = scene_checks.check_scene(document)
    found, problems = checked.scene, checked.problems
    if found is None:
        raise InvalidFile(problems, document.texts)
    if every is not None:
        found = dataclasses.replace(found, every=every)
    if time_step == "auto":
        found = dataclasses.replace(found, is_time_step_automatic=True)
    elif time_step is not None:
        found = dataclasses.replace(found, time_step=time_step, is_time_step_automatic=False)
    return (_with_chosen_step(found, document) if found.is_time_step_automatic else found), problems


def refuse_overlaps(document: Document, found: Scene) -> None:
    """Raise InvalidFile for a scene whose parts overlap at the start."""
    problems = overlaps(document, found)
    if problems:
        raise InvalidFile(problems, document.texts)


def overlaps(document: Document, found: Scene | None = None) -> tuple[Problem, ...]:
    """Return an error for each pair of parts that overlap at the start of a scene.

    The scene has no other errors; `found` is the scene, if it has been read already. There are none
    for a definition, and none without an engine.
    """
    if not scene_model.is_scene(document):
        return ()
    found = found or scene_reader.read_scene(document)
    if not proximity.can_overlap_at_start(found):
        return ()
    # the engine's own contact detection decides what a run would push apart; few scenes need it
    from somo_cli.scene.checks import overlap as overlap_checks
    from somo_cli.simulation.engine.bullet.world import BulletWorld
    from somo_cli.simulation.plan.build import make_plan

    plan = make_plan(found)
    try:
        with BulletWorld(plan) as world:
            depths = world.depths()
    except (EngineMissing, EngineRefused):
        return ()  # reported when the scene is run
    lengths = {pair: depth / plan.scale.length for pair, depth in depths.items()}
    return tuple(overlap_checks.overlap_problems(document, found, lengths))


def _with_chosen_step(found: Scene, document: Document) -> Scene:
    # slow to import, and few scenes need it before they run
    from somo_cli.analysis.modes import SingularInertia
    from somo_cli.analysis.stability import recommended_step
    from somo_cli.simulation.plan.build import make_plan

    if not found.manipulators:
        place = document.span(("time_step",))
        problem = Problem(place, scene_checks.NO_AUTOMATIC_TIME_STEP, "give a number")
        raise InvalidFile([problem], document.texts)
    try:
        step, tip_error = recommended_step(make_plan(found))
    except SingularInertia as error:
        place = document.span(("time_step",))
        message = f"no time step can be chosen: {error}"
        raise InvalidFile([Problem(place, message, "give a time_step")], document.texts) from error
    return dataclasses.replace(found, time_step=step, expected_tip_error=tip_error)


def _convex_pieces(announce: Callable[[str], None] | None, text: str, source: str) -> str | None:
    # slow to import, and few scenes need it before they run
    from somo_cli.scene.mesh import triangles_as_obj
    from somo_cli.scene.mesh_parts import MeshError
    from somo_cli.simulation.engine.bullet.convex_decomposition import convex_pieces

    try:
        triangles = triangles_as_obj(text, source)
        if announce is not None:
            announce(f"decomposing {source} into convex parts, which may take half a minute")
        return convex_pieces(triangles)
    except MeshError:
        return None  # the checks of meshes report it


def _with_parts(
    document: Document,
    allow_outside: bool,
    packages: Packages,
    announce: Callable[[str], None] | None,
) -> Document:
    is_scene = scene_model.is_scene(document)
    places = scene_model.FILE_POINTERS if is_scene else compiler.FILE_POINTERS
    open_text = partial(open_reference, packages, is_outside_allowed=allow_outside)
    document, problems = include(document, places, open_text)
    if is_scene:
        document, of_objects = object_files.include_object_files(document, open_text)
        document, of_motions = motion_files.include_motion_files(document, open_text)
        problems += (*of_objects, *of_motions)
        document = object_files.with_pieces(document, partial(_convex_pieces, announce))
    if problems:
        raise InvalidFile([*problems, *check(document)], document.texts)
    return document
