"""The decisions of a plan about contact: what a run does, and what it leaves out."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.simulation import savings
from somo_cli.simulation.decision import Decision, count_of
from somo_cli.simulation.integrator.contact_prediction import MOST_POINTS
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.penetration import steps_between_samples
from somo_cli.simulation.plan.model import Plan


def contact_decisions(plan: Plan) -> Iterator[Decision]:
    """Yield what is checked and computed where bodies and objects can touch."""
    if not plan.can_touch:
        yield Decision(
            "monitoring of contact: depth, force, energy, missed contact",
            False,
            "nothing can touch",
        )
        return
    between = steps_between_samples(plan.time_step, MONITORING_INTERVAL)
    sampled = f"the list of contact points in {between - 1} of {between} steps"
    what, seldom = (
        "monitoring of contact: depth, force, energy, missed contact",
        "at most 8 ms apart",
    )
    yield Decision(what, True, seldom, sampled if between > 1 else None)
    yield _prediction_decision(plan)
    slides = "found every few steps; only what slides, and not along the engine's own directions"
    yield Decision("direction of sliding friction", True, slides)
    if plan.bodies:
        yield _self_collision_decision(plan)
    if held := savings.fixed_pairs(plan):
        saves = count_of(held, "pair")
        yield Decision("collisions between fixed bodies", False, "neither can move", saves)
    rebounds = any(surface.restitution > 0 for surface in plan.surfaces)
    why = "a restitution is above 0" if rebounds else "no restitution is above 0"
    yield Decision("engine parameters for rebounds", rebounds, why)
    is_directed = any(surface.friction_anisotropy is not None for surface in plan.surfaces)
    what = "friction by direction, between the engine's steps"
    if is_directed:
        yield Decision(what, True, "a surface has anisotropic_friction")
    else:
        yield Decision(what, False, "no anisotropic_friction", "contact points in every step")


def _self_collision_decision(plan: Plan) -> Decision:
    able = [body.name for body in plan.bodies if body.has_self_collision]
    why = f"of {', '.join(able)}" if able else "self_collision is off"
    spared = savings.untested_link_pairs(plan)
    saves = f"{'at least ' if able else ''}{count_of(spared, 'pair')} of links" if spared else None
    return Decision("collisions within a manipulator", bool(able), why, saves)


def marker_decisions(plan: Plan) -> Iterator[Decision]:
    """Yield what is left out for objects that nothing touches."""
    markers = [one.rigid_object.name for one in plan.objects if not one.rigid_object.collides]
    if markers:
        yield Decision("collisions of markers", False, f"collides is false of {', '.join(markers)}")


def _prediction_decision(plan: Plan) -> Decision:
    what = "prediction of contact forces"
    if not plan.bodies:
        return Decision(what, False, "there are no joints whose springs could shake a grasp")
    if plan.integrator == "explicit":
        return Decision(what, False, "the explicit integrator does without")
    why = f"at up to {MOST_POINTS} points with friction, since a late force shakes a grasp"
    return Decision(what, True, why)
