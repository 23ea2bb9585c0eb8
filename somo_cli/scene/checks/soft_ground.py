"""Warn of bodies on soft ground that may gain energy because contact springs act late.

In each step the engine finds only the deepest contact point between the ground and a cylinder or a
mesh. The other points of a face are found once they are as deep as the first; the spring of each
then adds the energy k d²/2, with its stiffness k [N/m] and its depth d [m]. `make sliding` measures
the gain: a fifth of the body's energy for cylinders that land, more than half for meshes. More
damping reduces it; a smaller time step does not.
"""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.document.parse import Document
from somo_cli.manipulator.chain import Link
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import Box, Sphere
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.scene.model import Scene
from somo_cli.scene.round_body import round_body_of


def soft_ground_problems(document: Document, scene: Scene) -> Iterator[Problem]:
    """Yield a warning for each free body of a scene that may gain energy on soft ground."""
    if scene.ground is None:
        return
    ground = scene.ground.surface
    for index, one in enumerate(scene.manipulators):
        links = one.compiled.chain.links
        if one.base == "free" and _is_soft(ground, *one.surfaces.all) and _act_late(links):
            yield _finding(document, ("manipulators", index), one.name)
    for index, rigid_object in enumerate(scene.objects):
        is_free = not rigid_object.has_prescribed_pose
        links = rigid_object.chain.links
        if is_free and _is_soft(ground, rigid_object.surface) and _act_late(links):
            yield _finding(document, ("objects", index), rigid_object.name)


def has_prompt_springs(link: Link) -> bool:
    """Return whether the engine finds every contact point of a link with the ground in every step.

    It does for boxes, balls and capsules, and for round links whose ends are balls or capsules.
    """
    solids = [shape.solid for shape in link.shapes]
    if all(isinstance(solid, Box) for solid in solids):
        return True
    return round_body_of(link) is not None and any(
        isinstance(one, Sphere | Capsule) for one in solids
    )


def _is_soft(*surfaces: ContactSurface) -> bool:
    return any(surface.compliance is not None for surface in surfaces)


def _act_late(links: tuple[Link, ...]) -> bool:
    return not all(has_prompt_springs(link) for link in links)


def _finding(document: Document, at: Pointer, name: str) -> Problem:
    return Problem(
        document.span(at),
        f"'{name}' has flat faces but is not made of boxes: it may gain energy when it lands or "
        "rocks on soft ground, because contact springs under a face act late",
        "raise contact_damping, make it of boxes, balls or capsules, or leave out "
        "contact_stiffness",
        "warning",
        "late-springs",
    )
