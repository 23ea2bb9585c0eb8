"""Report what a run leaves out, what it keeps, why, and what that saves; no engine is needed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from somo_cli.scene import columns
from somo_cli.simulation import savings
from somo_cli.simulation.integrator.contact_prediction import MOST_POINTS
from somo_cli.simulation.integrator.object_rotation import (
    ACCELERATION_ERROR,
    ENERGY_GROWTH,
)
from somo_cli.simulation.integrator.refresh_policy import (
    FAST_REFRESH,
    MONITORING_INTERVAL,
    SLOW_REFRESH,
)
from somo_cli.simulation.integrator.spinning_base import ENERGY_GROWTH as SPIN_ENERGY_GROWTH
from somo_cli.simulation.integrator.spinning_base import spin_to_follow
from somo_cli.simulation.monitoring.penetration import steps_between_samples
from somo_cli.simulation.plan.build import needs_engine_limits
from somo_cli.simulation.plan.model import Plan


@dataclass(frozen=True, slots=True)
class Decision:
    """Whether a run does one of the tasks that it could do, and why.

    `saves` says what leaving it out saves in this scene, None if that is nothing or unknown.
    """

    what: str
    is_kept: bool
    why: str
    saves: str | None = None

    def __str__(self) -> str:
        saves = "" if self.saves is None else f"; saves {self.saves}"
        return f"{'kept' if self.is_kept else 'left out':8}  {self.what}: {self.why}{saves}"


def explain(plan: Plan) -> tuple[Decision, ...]:
    """Return every decision of a plan."""
    return (
        *_shape_decisions(plan),
        *_contact_decisions(plan),
        *_marker_decisions(plan),
        *_joint_decisions(plan),
        *_rotation_decisions(plan),
        *_engine_decisions(plan),
        *_state_decisions(plan),
    )


def plain_data(plan: Plan) -> list[dict[str, object]]:
    """Return the decisions as plain data."""
    return [
        {"what": one.what, "kept": one.is_kept, "why": one.why, "saves": one.saves}
        for one in explain(plan)
    ]


def _shape_decisions(plan: Plan) -> Iterator[Decision]:
    solids = _count(savings.solids(plan), "shape") if plan.bodies else None
    yield _collision_shape_decision(plan, solids)
    if plan.keeps_unused:
        yield Decision("visual shapes", True, "asked for")
    else:
        yield Decision("visual shapes", False, "nothing is rendered", solids)
    if not plan.bodies:
        return
    merged = savings.merged_links(plan)
    why = "what is rigid is one link" if merged else "every link is one solid"
    saves = f"{_count(merged, 'link')} and as many fixed joints" if merged else None
    yield Decision("links joined by fixed joints", False, why, saves)


def _collision_shape_decision(plan: Plan, solids: str | None) -> Decision:
    what = "collision shapes"
    if plan.can_touch:
        parts = [_count(len(plan.bodies), "manipulator")] if plan.bodies else []
        parts += [_count(len(plan.objects), "object")] if plan.objects else []
        parts += ["the ground"] if plan.ground is not None else []
        return Decision(what, True, f"{', '.join(parts)} can touch")
    if not plan.bodies:
        return Decision(what, True, "of objects they are loaded always, though nothing can touch")
    is_alone = len(plan.bodies) == 1 and not plan.objects and plan.ground is None
    what_is = (
        "one manipulator, no ground, no objects"
        if is_alone
        else "all of it out of reach of each other, wherever joints go"
    )
    why = f"{what_is}, self_collision off: nothing can touch"
    if plan.keeps_unused:
        return Decision(what, True, f"asked for, though {why}")
    return Decision(what, False, why, f"{solids} to move in every step")


def _contact_decisions(plan: Plan) -> Iterator[Decision]:
    if not plan.can_touch:
        yield Decision("looks at how deep bodies are in each other", False, "nothing can touch")
        return
    between = steps_between_samples(plan.time_step, MONITORING_INTERVAL)
    sampled = f"the list of contact points in {between - 1} of {between} steps"
    what, seldom = "looks at how deep bodies are in each other", "at most 8 ms apart"
    yield Decision(what, True, seldom, sampled if between > 1 else None)
    yield _prediction_decision(plan)
    slides = "found every few steps; only what slides, and not along the engine's own directions"
    yield Decision("direction of sliding friction", True, slides)
    if plan.bodies:
        yield _self_collision_decision(plan)
    if held := savings.fixed_pairs(plan):
        saves = _count(held, "pair")
        yield Decision("collisions of what is held", False, "neither would yield", saves)
    rebounds = any(surface.restitution > 0 for surface in plan.surfaces)
    why = "a restitution is above 0" if rebounds else "no restitution is above 0"
    yield Decision("engine parameters for rebounds", rebounds, why)
    is_directed = any(surface.friction_anisotropy is not None for surface in plan.surfaces)
    what = "friction by direction, between the engine's steps"
    if is_directed:
        yield Decision(what, True, "a surface has anisotropic_friction")
    else:
        yield Decision(what, False, "no anisotropic_friction", "a look at contact in every step")


def _self_collision_decision(plan: Plan) -> Decision:
    able = [body.name for body in plan.bodies if body.has_self_collision]
    why = f"of {', '.join(able)}" if able else "self_collision is off"
    spared = savings.untested_link_pairs(plan)
    saves = f"{'at least ' if able else ''}{_count(spared, 'pair')} of links" if spared else None
    return Decision("collisions within a manipulator", bool(able), why, saves)


def _marker_decisions(plan: Plan) -> Iterator[Decision]:
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


def _joint_decisions(plan: Plan) -> Iterator[Decision]:
    if plan.bodies:
        yield _motor_decision(plan)
        yield _limit_decision(plan)
        yield _inertia_decision(plan)
    paths = [*(body.path for body in plan.bodies), *(one.path for one in plan.objects)]
    moved = any(path is not None for path in paths)
    yield Decision("prescribed motion", moved, "motion is given" if moved else "no motion is given")
    if plan.bodies:
        is_loaded = any(body.loads for body in plan.bodies)
        why = "loads are given" if is_loaded else "no loads"
        yield Decision("external loads", is_loaded, why)


def _inertia_decision(plan: Plan) -> Decision:
    angles = f"{FAST_REFRESH:g} rad, moving slowly {SLOW_REFRESH:g} rad"
    why = f"renewed once joints have moved by {angles}, or less where it changes faster"
    sizes = sorted({len(body.chain.joints) for body in plan.bodies})
    of_sizes = ", ".join(f"{size} x {size}" for size in sizes)
    saves = f"inertia and inverse, {of_sizes}, of {_count(len(plan.bodies), 'body')} in all others"
    return Decision("inertia of the joints in every step", False, why, saves)


def _rotation_decisions(plan: Plan) -> Iterator[Decision]:
    yield from _base_decisions(plan)
    free = [one for one in plan.objects if not one.rigid_object.has_prescribed_pose]
    if not free:
        return
    what = "gyroscopic torque of objects, to second order"
    turning = [one.rigid_object.name for one in free if one.has_gyroscopic_torque]
    if not turning:
        why = "the moments of inertia of each are equal"
        yield Decision(what, False, why, f"{_count(len(free), 'torque')} in every step")
        return
    why = (
        f"of {', '.join(turning)}, while the engine alone would be off by "
        f"{ACCELERATION_ERROR:g} rad/s² or add {ENERGY_GROWTH:g} of the energy in a second, "
        f"checked every {MONITORING_INTERVAL} steps"
    )
    equal = len(free) - len(turning)
    saves = f"{_count(equal, 'object')} with equal moments" if equal else None
    yield Decision(what, True, why, saves)


def _base_decisions(plan: Plan) -> Iterator[Decision]:
    free = [body.name for body in plan.bodies if body.base == "free"]
    if not free:
        return
    what = "momentum of free bases that spin"
    if plan.integrator == "explicit":
        yield Decision(what, False, "the explicit integrator leaves their spin to the engine")
        return
    rate = f"{spin_to_follow(plan.time_step):.2g} rad/s"
    why = f"of {', '.join(free)}, above {rate}, where energy would grow by more than"
    yield Decision(what, True, f"{why} {SPIN_ENERGY_GROWTH:g} of itself in a second")


def _motor_decision(plan: Plan) -> Decision:
    what = "motor rows of joints"
    joints = [joint for body in plan.bodies for joint in body.chain.joints]
    rubbing = sum(joint.friction > 0 for joint in joints)
    idle = len(joints) - rubbing
    why = (
        f"dry friction of {_count(rubbing, 'joint')}, one row each"
        if rubbing
        else "no dry friction"
    )
    if idle and any(body.has_zero_torque_motors for body in plan.bodies):
        more = f"{why}, asked for of {idle} more" if rubbing else f"asked for, though {why}"
        return Decision(what, True, more)
    # every joint has a motor by default, whose row asks the solver for all of its iterations
    return Decision(
        what, rubbing > 0, why, f"{_count(idle, 'row')} in every step" if idle else None
    )


def _limit_decision(plan: Plan) -> Decision:
    what = "joint limits in the engine"
    limited = sum(joint.is_limited for body in plan.bodies for joint in body.chain.joints)
    if not limited:
        return Decision(what, False, "no joint has any")
    have = f"{_count(limited, 'joint')} with limits"
    if any(body.has_engine_limits for body in plan.bodies):
        needs = (
            needs_engine_limits(plan.can_touch, plan.integrator, body.base) for body in plan.bodies
        )
        asked = "" if any(needs) else ", asked for, though the law stops them"
        # seen in 3.2.7: a limit has a row only while its joint is beyond it
        return Decision(what, True, f"{have}, a row only beyond one{asked}")
    # the engine has two rows in mind for each, and sorts and asks them in every step
    return Decision(
        what, False, f"{have}, at which the law stops them", f"{limited} constraints in every step"
    )


def _engine_decisions(plan: Plan) -> Iterator[Decision]:
    yield Decision("dampers and springs of the engine", False, "in nobody's model")
    yield Decision("sleeping of the engine", False, "springs act on what is at rest as well")
    # as many as `bullet` allows; without a row the first one is the last
    why = (
        "200 at most, 50 with more than 16 points of contact, fewer once a step is solved; "
        "one in a step without constraints, contacts, limits and dry friction"
    )
    yield Decision("iterations of the solver", True, why)


def _state_decisions(plan: Plan) -> Iterator[Decision]:
    groups = columns.column_groups(plan.recorded)
    needs = columns.needs_of(groups)
    recorded = ", ".join(sorted({group.quantity for group in groups})) or "nothing but the time"
    every = "every step" if plan.every == 1 else f"every {plan.every} steps"
    yield Decision("recorded state", True, f"{recorded}, {every}", _skipped_columns(plan))
    what = "contact points of recorded steps"
    if "contacts" in needs:
        yield Decision(what, True, "columns need them")
    else:
        saves = "their list for every row" if plan.can_touch else None
        yield _unless_asked(plan, what, "no column needs them", saves)
    # with the implicit law velocities live at half steps, so a row needs those of the step after it
    halves = plan.integrator == "implicit"
    what = "velocities of the step after a row"
    if halves and "velocities" in needs:
        yield Decision(what, True, "columns need velocities")
    elif halves:
        why, saves = "no column needs velocities between steps", "a step beyond the last row"
        yield _unless_asked(plan, what, why, saves)
    else:
        yield Decision(what, False, "no column needs velocities between steps")
    ends = bool(plan.stop_conditions)
    why = (
        f"{_count(len(plan.stop_conditions), 'condition')} of stop" if ends else "no stop is given"
    )
    saves = None if ends else f"a look every {MONITORING_INTERVAL} steps"
    yield Decision("looks at what ends the run", ends, why, saves)


def _unless_asked(plan: Plan, what: str, why: str, saves: str | None) -> Decision:
    if plan.keeps_unused:
        return Decision(what, True, f"asked for, though {why}")
    return Decision(what, False, why, saves)


def _skipped_columns(plan: Plan) -> str | None:
    sampled, available = len(columns.header(plan.recorded)) - 1, savings.available_columns(plan)
    parts = (
        [f"{available - sampled} of {available} columns in every row"]
        if sampled < available
        else []
    )
    parts += [f"all of them in {plan.every - 1} of {plan.every} steps"] if plan.every > 1 else []
    return " and ".join(parts) or None


def _count(number: int, noun: str) -> str:
    plural = "bodies" if noun == "body" else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"
