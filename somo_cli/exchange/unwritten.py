"""Say what a scene has that MJCF has no element for."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.exchange.mjcf_sensors import unread_quantities
from somo_cli.scene.columns import Recorded
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.scene.model import Scene


def recorded_of(scene: Scene) -> Recorded:
    """Return the quantities that a scene records."""
    return Recorded(
        tuple((one.name, one.compiled.chain) for one in scene.manipulators),
        tuple(one.name for one in scene.objects),
        scene.ground is not None,
        scene.columns,
        scene.object_quantities if scene.objects else (),
        scene.only,
    )


def parts_not_in_mjcf(scene: Scene) -> tuple[str, ...]:
    """Return a line for each part of a scene that its MJCF does not have."""
    return tuple(_parts(scene))


def _parts(scene: Scene) -> Iterator[str]:
    profiles = [entry.profile for one in scene.manipulators for entry in one.actuation]
    if any(profile.constant_value is None for profile in profiles):
        yield "torques over time: the controls are those at the start"
    loads = [load for one in scene.manipulators for load in one.loads]
    if any(len(load.waypoints) > 1 for load in loads):
        yield "loads over time: the controls are the factors at the start"
    motions = [one.motion for one in scene.manipulators] + [one.motion for one in scene.objects]
    if any(motion is not None for motion in motions):
        yield "prescribed motion: move the mocap bodies"
    if scene.stop_conditions:
        yield "stop conditions"
    yield from _surface_parts(scene)
    if unread := unread_quantities(recorded_of(scene)):
        yield f"sensors for {', '.join(unread)}"


def _surface_parts(scene: Scene) -> Iterator[str]:
    surfaces: list[ContactSurface] = [one.surface for one in scene.objects]
    surfaces += [surface for one in scene.manipulators for surface in one.surfaces.all]
    if any(one.friction_anisotropy is not None for one in surfaces):
        yield "anisotropic friction: the friction is equal in all directions"
    if any(one.restitution > 0 for one in surfaces):
        yield "restitution"
    ground = [] if scene.ground is None else [scene.ground.surface]
    if any(one.compliance is not None for one in (*surfaces, *ground)):
        yield "contact stiffness and damping: MuJoCo's own softness"
