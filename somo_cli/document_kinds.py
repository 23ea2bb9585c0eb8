"""What kind of document a file holds, and refusals of kinds that a command does not take."""

from __future__ import annotations

from somo_cli.document.parse import Document
from somo_cli.manipulator.assembly import is_assembly
from somo_cli.problems import InvalidFile, Pointer, Problem
from somo_cli.scene import model as scene_model
from somo_cli.scene.checks import sorotraj as sorotraj_checks


def refuse_trajectory(document: Document) -> None:
    """Raise InvalidFile if the document is a trajectory, not a definition or a scene."""
    if sorotraj_checks.is_trajectory(document):
        place = document.span(("settings",), key=True)
        message = "this is a trajectory, not a manipulator definition or a scene"
        hint = "a scene names it under trajectories"
        raise InvalidFile([Problem(place, message, hint)], document.texts)


def refuse_study(document: Document) -> None:
    """Raise InvalidFile if the document is a study of a sweep, not a definition or a scene."""
    if is_study(document):
        place = document.span(("scene",), key=True)
        message = "this is a study, not a manipulator definition or a scene"
        raise InvalidFile([Problem(place, message, "somo sweep runs it")], document.texts)


def refuse_scene(document: Document) -> None:
    """Raise InvalidFile if the document is a scene or a trajectory, not a definition."""
    refuse_trajectory(document)
    refuse_study(document)
    if scene_model.is_scene(document):
        place = document.span(("manipulators",), key=True)
        hint = "somo run takes scenes; build the definitions that this one names"
        problem = Problem(place, "this is a scene, not a manipulator definition", hint)
        raise InvalidFile([problem], document.texts)


def refuse_multiple(document: Document, found: scene_model.Scene, what_is: str) -> None:
    """Raise InvalidFile unless a scene has one manipulator; `what_is` is such as "a fit is"."""
    refuse_without_manipulators(document, found, f"{what_is} about one")
    if len(found.manipulators) > 1:
        place = document.span(("manipulators", 1))
        message = f"there are several manipulators, and {what_is} about one"
        raise InvalidFile([Problem(place, message, "give a scene of one")], document.texts)
    if found.manipulators[0].compiled.chain.limbs:
        is_scene = scene_model.is_scene(document)
        refuse_assembly(document, what_is, ("manipulators", 0, "definition") if is_scene else ())


def refuse_without_manipulators(document: Document, found: scene_model.Scene, what_is: str) -> None:
    """Raise InvalidFile for a scene of objects alone; `what_is` says what needs a manipulator."""
    if not found.manipulators:
        place = document.span(("manipulators",), key=True)
        message = f"there is no manipulator, and {what_is}"
        raise InvalidFile([Problem(place, message, "give a scene with one")], document.texts)


def refuse_assembly(document: Document, what_is: str, at: Pointer = ()) -> None:
    """Raise InvalidFile if an assembly is at a pointer; `what_is` is such as "a fit is"."""
    if is_assembly(document.at(at)):
        place = document.span((*at, "limbs"), key=True)
        message = f"this is an assembly, and {what_is} about one manipulator"
        hint = "give the definition of one of its limbs"
        raise InvalidFile([Problem(place, message, hint)], document.texts)


def is_study(document: Document) -> bool:
    """Return whether a document is meant as a study of a sweep."""
    return isinstance(document.data, dict) and {"scene", "parameters"} <= document.data.keys()
