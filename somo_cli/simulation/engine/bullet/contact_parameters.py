"""The contact parameters that PyBullet is given for each surface, and for bodies to rebound."""

from __future__ import annotations

from collections.abc import Mapping

from somo_cli.manipulator import geometry
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.simulation.plan.model import Plan

REBOUND_GAP = 5e-5  # m: how near surfaces must be for the engine to let them collide
DEFAULT_GAP = 0.02  # share of the size of the smaller body; the engine's own
SOFT_GAP = 0.2  # share of the size of the smaller body, where the ground gives way
REBOUND_ERP = 0.02  # share of a depth that is undone in a step
REBOUND_STEPS = 2.0  # a slower approach than gravity's in so many steps is no impact


def surface_settings(surface: ContactSurface) -> Mapping[str, float]:
    """Return the options of `changeDynamics` for a surface; engine units.

    A value of zero is left out, so that the engine's solver has no row for it.
    """
    # `friction_adapter` applies anisotropic friction, so the engine must not
    friction = 0.0 if surface.friction_anisotropy else surface.friction
    options = {
        "lateralFriction": friction,
        "spinningFriction": surface.spinning_friction,
        "rollingFriction": surface.rolling_friction,
        "restitution": surface.restitution,
    }
    options = {key: value for key, value in options.items() if value or key == "lateralFriction"}
    if surface.compliance is not None:
        options["contactStiffness"] = surface.compliance.stiffness
        options["contactDamping"] = surface.compliance.damping
    return options


def contact_parameters(plan: Plan) -> Mapping[str, float]:
    """Return the engine's options for contact; more of them where something rebounds.

    Seen in 3.2.7: the engine adds to the speed after an impact what is left of the gap in front of
    a body, or what it has to push out, so that a ball of restitution 0.5 came back with 0 to 0.6
    of its speed, and one that rests goes on hopping if gravity gives it more than a
    threshold of 0.2 engine units per second in a step. So bodies collide when they touch, are
    pushed out slowly, and come to rest below a threshold that goes with the step.

    The gap also decides how near a new contact point must be to an old one to replace it, and how
    far an old one may lag behind a body that slides. With the engine's own gap, a body that rolls
    on soft ground leaves old points behind, which go on to press (see `rolling_adapter`), and one
    that slides flat loses them at once and stands on one: a disc without friction tilted by 27
    degrees.
    """
    if not any(surface.restitution for surface in plan.surfaces):
        # seen in 3.2.7: this one is shared by all engines of a process, so none may be left out
        return {"contactBreakingThreshold": SOFT_GAP if has_soft_ground(plan) else DEFAULT_GAP}
    return {
        "contactBreakingThreshold": REBOUND_GAP * plan.scale.length,
        "contactERP": REBOUND_ERP,
        "restitutionVelocityThreshold": REBOUND_STEPS
        * geometry.norm(plan.gravity)
        * plan.time_step,
    }


def has_soft_ground(plan: Plan) -> bool:
    """Whether contact with the ground has a finite stiffness."""
    ground = plan.ground
    return ground is not None and any(one.compliance for one in (ground.surface, *plan.surfaces))
