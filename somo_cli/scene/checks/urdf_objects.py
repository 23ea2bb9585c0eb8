"""Check an object that a URDF describes: its shapes, its mass and its inertia."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.link_checks import INERTIA_FACTOR
from somo_cli.problems import Pointer, Problem, Span
from somo_cli.scene import compound, object_shapes
from somo_cli.scene.checks.meshes import hull_warnings
from somo_cli.scene.object_inertia import has_own_mass, takes_solid, urdf_inertial, with_mass
from somo_cli.scene.possible_inertia import described, impossibility
from somo_cli.scene.urdf_rigid_body import UrdfLink, UrdfRigidBody


def urdf_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], is_free: bool
) -> Iterator[Problem]:
    """Yield the errors and warnings about the URDF of the object `data` at `at`."""
    if has_own_mass(data) and not takes_solid(data):
        key = "mass" if "mass" in data else "density"
        message = f"{key} needs inertia: solid; without it the masses of the URDF count"
        hint = "leave it out, or set inertia: solid"
        yield Problem(document.span((*at, key), key=True), message, hint)
    body = object_shapes.object_urdf_body(data)
    yield from body.problems
    if body.problems:
        return
    collides = data.get("collides", True)
    if body.is_drawn_only and collides:
        hint = "set collides: false: the object is then drawn, and nothing can touch it"
        yield Problem(body.span, "the URDF has no collision shape", hint)
    if collides:
        yield from _shape_problems(body)
    if is_free:
        yield from _inertia_problems(body, data)


def _shape_problems(body: UrdfRigidBody) -> Iterator[Problem]:
    solids = [one.solid for one in body.solids]
    if compound.is_too_much(solids):
        others = compound.shape_count(solids) - 1
        most = f"the engine takes at most {compound.MAX_SHAPES - 1} beside meshes"
        counted = "a capsule counts as three"
        message = f"the object has meshes and {others} other shapes, and {most}; {counted}"
        hint = "leave some out, or use meshes alone, or none: then any number is possible"
        yield Problem(body.span, message, hint)
    for span, name, found in body.meshes:
        yield from hull_warnings(span, f"mesh '{name}'", found)


def _inertia_problems(body: UrdfRigidBody, data: Mapping[str, Any]) -> Iterator[Problem]:
    if not (takes_solid(data) and has_own_mass(data)):
        for name, span in body.links_without_inertia:
            message = f"link '{name}' has a shape but no inertia"
            yield Problem(span, message, "give it <inertial>, or set fixed: true")
        if body.links_without_inertia:
            return
    problems = [
        problem
        for link in body.links
        if link.declared is not None and not (takes_solid(data) and link.filled is not None)
        for problem in _link_problems(link)
    ]
    yield from problems
    if any(problem.severity == "error" for problem in problems):
        return
    whole = urdf_inertial(body, data)
    if whole is None:
        message = "no link has a mass"
        yield Problem(body.span, message, "give one of them <inertial>, or set fixed: true")
        return
    _, moments = compound.principal_axes(whole.inertia)
    if not min(moments) > 0:
        found = f"{moments[0]:.3g}, {moments[1]:.3g} and {moments[2]:.3g} kg·m²"
        message = f"the principal moments of inertia of the object are {found}"
        hint = "each must be greater than 0; inertia: solid takes those of the shapes"
        yield Problem(_inertia_span(body), message, hint)


def _inertia_span(body: UrdfRigidBody) -> Span:
    with_mass_of_file = [link for link in body.links if link.declared is not None]
    return with_mass_of_file[0].span if len(with_mass_of_file) == 1 else body.span


def _link_problems(link: UrdfLink) -> Iterator[Problem]:
    assert link.declared is not None, "only links with a mass are checked"
    own = None if link.filled is None else with_mass(link.filled, link.declared.mass)
    hint = "correct it in the URDF"
    if own is not None:
        hint = f"set inertia: solid, which takes that of the shapes, {described(own.inertia)}"
    if why := impossibility(link.declared.inertia):
        message = f"no body can have the inertia of link '{link.name}': {why}"
        yield Problem(link.span, message, hint, code="impossible-inertia")
        return
    if own is None:
        return
    ratio = geometry.farthest_moment_ratio(link.declared.inertia, own.inertia)
    if ratio > 0 and not 1 / INERTIA_FACTOR <= ratio <= INERTIA_FACTOR:
        message = (
            f"the declared inertia of link '{link.name}' is {ratio:.3g} times that of its shapes "
            "filled with its mass"
        )
        yield Problem(link.span, message, hint, "warning", "declared-inertia")
