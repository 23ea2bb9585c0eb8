"""What all closed forms ask of the scene that names one."""

from __future__ import annotations

from somo_cli.scene.model import Manipulator, Scene

TOLERANCE = 1e-9  # relative: what counts as equal, parallel or zero in a scene


class ReferenceMismatch(ValueError):
    """The closed form that a scene names does not describe this scene."""


def single_manipulator(scene: Scene) -> Manipulator:
    """Return the only manipulator of a scene; raise ReferenceMismatch unless its base is static."""
    if len(scene.manipulators) != 1:
        raise ReferenceMismatch(f"it is about one manipulator, not {len(scene.manipulators)}")
    one = scene.manipulators[0]
    if one.compiled.chain.limbs:
        raise ReferenceMismatch("it is about a manipulator by itself, not an assembly")
    if one.base != "static":
        raise ReferenceMismatch(f"it is about a static base, not a {one.base} one")
    return one
