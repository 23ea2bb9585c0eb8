"""The decisions of a plan about motion: what a run does for joints, bases and objects."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.simulation.decision import Decision, count_of
from somo_cli.simulation.integrator.object_rotation import ACCELERATION_ERROR, ENERGY_GROWTH
from somo_cli.simulation.integrator.refresh_policy import (
    FAST_REFRESH,
    MONITORING_INTERVAL,
    SLOW_REFRESH,
)
from somo_cli.simulation.integrator.spinning_base import ENERGY_GROWTH as SPIN_ENERGY_GROWTH
from somo_cli.simulation.integrator.spinning_base import spin_to_follow
from somo_cli.simulation.plan.build import needs_engine_limits
from somo_cli.simulation.plan.model import Plan


def joint_decisions(plan: Plan) -> Iterator[Decision]:
    """Yield what is done about joints, loads and prescribed motion."""
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
    saves = (
        f"inertia and inverse, {of_sizes}, of {count_of(len(plan.bodies), 'body')} in all others"
    )
    return Decision("inertia of the joints in every step", False, why, saves)


def rotation_decisions(plan: Plan) -> Iterator[Decision]:
    """Yield what is done about bases and objects that rotate freely."""
    yield from _base_decisions(plan)
    free = [one for one in plan.objects if not one.rigid_object.has_prescribed_pose]
    if not free:
        return
    what = "gyroscopic torque of objects, to second order"
    turning = [one.rigid_object.name for one in free if one.has_gyroscopic_torque]
    if not turning:
        why = "the moments of inertia of each are equal"
        yield Decision(what, False, why, f"{count_of(len(free), 'torque')} in every step")
        return
    why = (
        f"of {', '.join(turning)}, while the engine alone would be off by "
        f"{ACCELERATION_ERROR:g} rad/s² or add {ENERGY_GROWTH:g} of the energy in a second, "
        f"checked every {MONITORING_INTERVAL} steps"
    )
    equal = len(free) - len(turning)
    saves = f"{count_of(equal, 'object')} with equal moments" if equal else None
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
        f"dry friction of {count_of(rubbing, 'joint')}, one row each"
        if rubbing
        else "no dry friction"
    )
    if idle and any(body.has_zero_torque_motors for body in plan.bodies):
        more = f"{why}, asked for of {idle} more" if rubbing else f"asked for, though {why}"
        return Decision(what, True, more)
    # every joint has a motor by default, whose row asks the solver for all of its iterations
    return Decision(
        what, rubbing > 0, why, f"{count_of(idle, 'row')} in every step" if idle else None
    )


def _limit_decision(plan: Plan) -> Decision:
    what = "joint limits in the engine"
    limited = sum(joint.is_limited for body in plan.bodies for joint in body.chain.joints)
    if not limited:
        return Decision(what, False, "no joint has any")
    have = f"{count_of(limited, 'joint')} with limits"
    if any(body.has_engine_limits for body in plan.bodies):
        needs = (
            needs_engine_limits(plan.can_touch, plan.integrator, body.base) for body in plan.bodies
        )
        asked = "" if any(needs) else ", asked for, though the law stops them"
        # seen in 3.2.7: a limit has a row only while its joint is beyond it
        return Decision(what, True, f"{have}, a row only beyond one{asked}")
    # the engine reserves two rows for each, and sorts and visits them in every step
    return Decision(
        what, False, f"{have}, at which the law stops them", f"{limited} constraints in every step"
    )
