"""Tell, before a run, that nothing of a scene will move."""

from __future__ import annotations

import numpy as np

from somo_cli.scene.actuation import ActuationProfile, WaypointProfile
from somo_cli.scene.model import ExternalLoad, Manipulator, Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics

_ROUNDING = 1e-12  # of weight times length: a smaller moment is that of rounding

HINT = "add actuation or a load, or turn the base by its rpy so that gravity bends it"


def why_nothing_moves(scene: Scene) -> str | None:
    """Return why nothing of a scene moves, None if something does or may.

    Nothing moves where all bodies are held, at rest and in equilibrium at the start, and nothing
    acts on them but gravity, which bends no joint. The equilibrium may be unstable, as that of a
    slender column.
    """
    if not scene.manipulators or not all(one.has_prescribed_pose for one in scene.objects):
        return None
    moved = any(one.motion is not None for one in scene.manipulators)
    moved = moved or any(one.motion is not None for one in scene.objects)
    if moved or not all(_is_at_rest(one, scene) for one in scene.manipulators):
        return None
    gravity = "gravity bends no joint" if any(scene.gravity) else "there is no gravity"
    return f"nothing moves: no torque drives a joint, no load acts on a link, and {gravity}"


def _is_at_rest(one: Manipulator, scene: Scene) -> bool:
    is_held = one.base == "static" and not any(one.initial_rates)
    is_left = all(_is_zero(drive.profile) for drive in one.actuation)
    return is_held and is_left and all(map(_is_no_load, one.loads)) and _is_balanced(one, scene)


def _is_zero(profile: ActuationProfile) -> bool:
    if isinstance(profile, WaypointProfile):
        return not any(value for _, value in profile.points)
    return profile.wave.amplitude == profile.wave.offset == 0


def _is_no_load(load: ExternalLoad) -> bool:
    return not any((*load.force, *load.moment)) or not any(value for _, value in load.waypoints)


def _is_balanced(one: Manipulator, scene: Scene) -> bool:
    """Return whether springs and gravity give no torque in any joint at the start."""
    chain = one.compiled.chain
    dynamics = ChainDynamics(chain)
    angles = np.array(one.initial_angles)
    weight = float(dynamics.masses.sum() * np.linalg.norm(scene.gravity))
    by_gravity = dynamics.at(angles, one.pose).gravity_force(scene.gravity)[6:]
    by_springs = dynamics.stiffness * (dynamics.neutral - angles)
    return bool(np.all(np.abs(by_gravity + by_springs) <= _ROUNDING * weight * chain.length))
