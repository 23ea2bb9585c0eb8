"""Report bodies that overlap at the start of a scene, as the engine finds them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.extents import MAX_RELATIVE_DEPTH
from somo_cli.scene.model import Scene

OVERLAP_TOLERANCE = 1e-5
"""The overlap of touching bodies [m] that is no error, if MAX_RELATIVE_DEPTH allows no more."""


def overlap_problems(
    document: Document, scene: Scene, depths: Mapping[tuple[int, int], float]
) -> Iterator[Problem]:
    """Yield an error for each pair of bodies that overlap by more than the tolerance.

    `depths` holds the penetration depth [m] by pair of body numbers, the smaller number first;
    numbers count manipulators, then objects, then the ground.
    """
    owners: list[Pointer] = [("manipulators", index) for index in range(len(scene.manipulators))]
    owners += [("objects", index) for index in range(len(scene.objects))]
    chains = [one.compiled.chain for one in scene.manipulators]
    chains += [one.chain for one in scene.objects]
    names = [f"'{one.name}'" for one in scene.manipulators]
    names += [f"'{one.name}'" for one in scene.objects]
    for (first, second), depth in sorted(depths.items()):
        is_ground = second == len(owners)
        lengths = [chains[one].length for one in (first, second) if one < len(owners)]
        if depth <= max(OVERLAP_TOLERANCE, MAX_RELATIVE_DEPTH * min(lengths)):
            continue
        late, early = (first, "the ground") if is_ground else (second, names[first])
        yield Problem(
            document.span(_pose_pointer(document, owners[late])),
            f"{names[late]} overlaps {early} by {depth * 1e3:.2g} mm at the start",
            _hint(owners[late]),
        )


def _pose_pointer(document: Document, owner: Pointer) -> Pointer:
    """Return the pointer of the key that gives a body its position, else that of the body."""
    for key in ("place", "position"):
        if (*owner, key) in document.spans:
            return (*owner, key)
    return owner


def _hint(owner: Sequence[str | int]) -> str:
    if owner[0] == "objects":
        return "move one of them with position, or set place: the object then stands on another"
    return "move one of them with position"
