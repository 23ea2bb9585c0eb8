"""Report what a run leaves out, what it keeps, why, and what that saves; no engine is needed."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.scene import columns
from somo_cli.simulation import savings
from somo_cli.simulation.contact_decisions import contact_decisions, marker_decisions
from somo_cli.simulation.decision import Decision, count_of, unless_asked
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.motion_decisions import joint_decisions, rotation_decisions
from somo_cli.simulation.object_decisions import object_decisions
from somo_cli.simulation.plan.model import Plan


def explain(plan: Plan) -> tuple[Decision, ...]:
    """Return every decision of a plan."""
    return (
        *_shape_decisions(plan),
        *contact_decisions(plan),
        *marker_decisions(plan),
        *joint_decisions(plan),
        *rotation_decisions(plan),
        *object_decisions(plan),
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
    solids = count_of(savings.solids(plan), "shape") if plan.bodies else None
    yield _collision_shape_decision(plan, solids)
    if plan.keeps_unused:
        yield Decision("visual shapes", True, "asked for")
    else:
        yield Decision("visual shapes", False, "nothing is rendered", solids)
    if not plan.bodies:
        return
    merged = savings.merged_links(plan)
    why = "what is rigid is one link" if merged else "every link is one solid"
    saves = f"{count_of(merged, 'link')} and as many fixed joints" if merged else None
    yield Decision("links joined by fixed joints", False, why, saves)


def _collision_shape_decision(plan: Plan, solids: str | None) -> Decision:
    what = "collision shapes"
    if plan.can_touch:
        parts = [count_of(len(plan.bodies), "manipulator")] if plan.bodies else []
        parts += [count_of(len(plan.objects), "object")] if plan.objects else []
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


def _engine_decisions(plan: Plan) -> Iterator[Decision]:
    yield Decision("dampers and springs of the engine", False, "the model has its own")
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
        yield unless_asked(plan, what, "no column needs them", saves)
    # with the implicit law velocities live at half steps, so a row needs those of the step after it
    halves = plan.integrator == "implicit"
    what = "velocities of the step after a row"
    if halves and "velocities" in needs:
        yield Decision(what, True, "columns need velocities")
    elif halves:
        why, saves = "no column needs velocities between steps", "a step beyond the last row"
        yield unless_asked(plan, what, why, saves)
    else:
        yield Decision(what, False, "no column needs velocities between steps")
    ends = bool(plan.stop_conditions)
    why = (
        f"{count_of(len(plan.stop_conditions), 'stop condition')}" if ends else "the scene has none"
    )
    saves = None if ends else f"one check every {MONITORING_INTERVAL} steps"
    yield Decision("checks of stop conditions", ends, why, saves)


def _skipped_columns(plan: Plan) -> str | None:
    sampled, available = len(columns.header(plan.recorded)) - 1, savings.available_columns(plan)
    parts = (
        [f"{available - sampled} of {available} columns in every row"]
        if sampled < available
        else []
    )
    parts += [f"all of them in {plan.every - 1} of {plan.every} steps"] if plan.every > 1 else []
    return " and ".join(parts) or None
