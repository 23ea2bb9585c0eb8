"""What a plan leaves out of a run and what it keeps, and why: told before any engine starts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from somo_cli.simulation import columns
from somo_cli.simulation.plan import Plan

_FORCES = frozenset({"contact_force", "contact_pairs", "link_contact_forces"})
_VELOCITIES = frozenset({"joint_rates", "energy", "velocity"})


@dataclass(frozen=True, slots=True)
class Decision:
    """One thing that a run could do: whether it does, and why or why not."""

    what: str
    is_kept: bool
    why: str

    def __str__(self) -> str:
        return f"{'kept' if self.is_kept else 'left out':8}  {self.what}: {self.why}"


def explain(plan: Plan) -> tuple[Decision, ...]:
    """Return every decision of a plan."""
    return (*_of_shapes(plan), *_of_contact(plan), *_of_joints(plan), *_of_state(plan))


def plain(plan: Plan) -> list[dict[str, object]]:
    """Return the decisions as plain data."""
    return [{"what": one.what, "kept": one.is_kept, "why": one.why} for one in explain(plan)]


def _of_shapes(plan: Plan) -> Iterator[Decision]:
    what = "collision shapes"
    if plan.can_touch:
        parts = [_count(len(plan.bodies), "manipulator")]
        parts += [_count(len(plan.things), "object")] if plan.things else []
        parts += ["the ground"] if plan.ground is not None else []
        yield Decision(what, True, f"{', '.join(parts)} can touch")
    else:
        why = "one manipulator, no ground, no objects, self_collision off: nothing can touch"
        why = f"asked for, though {why}" if plan.keeps_everything else why
        yield Decision(what, plan.keeps_everything, why)
    why = "asked for" if plan.keeps_everything else "nothing is rendered"
    yield Decision("visual shapes", plan.keeps_everything, why)


def _of_contact(plan: Plan) -> Iterator[Decision]:
    if not plan.can_touch:
        yield Decision("looks at how deep bodies are in each other", False, "nothing can touch")
        return
    yield Decision("looks at how deep bodies are in each other", True, "at most 8 ms apart")
    able = [body.name for body in plan.bodies if body.collides_with_itself]
    why = f"of {', '.join(able)}" if able else "self_collision is off"
    yield Decision("collisions within a manipulator", bool(able), why)
    rebounds = any(surface.restitution > 0 for surface in plan.surfaces)
    why = "a restitution is above 0" if rebounds else "no restitution is above 0"
    yield Decision("engine parameters for rebounds", rebounds, why)
    is_directed = any(surface.anisotropy is not None for surface in plan.surfaces)
    why = "a surface has anisotropic_friction" if is_directed else "no anisotropic_friction"
    yield Decision("friction by direction, between the engine's steps", is_directed, why)


def _of_joints(plan: Plan) -> Iterator[Decision]:
    joints = [joint for body in plan.bodies for joint in body.chain.joints]
    rubbing = sum(joint.friction > 0 for joint in joints)
    why = (
        f"dry friction of {_count(rubbing, 'joint')}, one row each"
        if rubbing
        else "no dry friction"
    )
    yield Decision("motor rows of joints", rubbing > 0, why)
    limited = sum(joint.is_limited for joint in joints)
    why = (
        f"{_count(limited, 'joint')} of {len(joints)} have them" if limited else "no joint has any"
    )
    yield Decision("joint limits", limited > 0, why)
    yield Decision("dampers, springs and sleeping of the engine", False, "in nobody's model")
    paths = [*(body.path for body in plan.bodies), *(one.path for one in plan.things)]
    moved = any(path is not None for path in paths)
    yield Decision("prescribed motion", moved, "motion is given" if moved else "no motion is given")
    is_loaded = any(body.loads for body in plan.bodies)
    yield Decision("external loads", is_loaded, "loads are given" if is_loaded else "no loads")


def _of_state(plan: Plan) -> Iterator[Decision]:
    kinds = {group.quantity for group in columns.groups(plan)}
    of_things = {group.reading for group in columns.thing_groups(plan)}
    recorded = ", ".join(sorted({*kinds, *of_things})) or "nothing but the time"
    every = "every step" if plan.every == 1 else f"every {plan.every} steps"
    yield Decision("recorded state", True, f"{recorded}, {every}")
    both = {*kinds, *of_things}
    has_forces = not _FORCES.isdisjoint(both)
    why = "columns need them" if has_forces else "no column needs them"
    yield Decision("contact points of recorded steps", has_forces, why)
    # with the implicit law velocities live at half steps, so a row needs the step after it
    halves = plan.integrator == "implicit" and not _VELOCITIES.isdisjoint(both)
    why = "columns need velocities" if halves else "no column needs velocities between steps"
    yield Decision("the step after a recorded one, by itself", halves, why)
    ends = bool(plan.stops)
    why = f"{_count(len(plan.stops), 'condition')} of stop" if ends else "no stop is given"
    yield Decision("looks at what ends the run", ends, why)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
