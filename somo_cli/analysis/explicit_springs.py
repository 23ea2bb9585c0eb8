"""The time step at which springs that are explicit in position are stable, as MuJoCo's are."""

from __future__ import annotations

from somo_cli.analysis.modes import SingularInertia
from somo_cli.analysis.round_steps import round_down_step
from somo_cli.analysis.stability import forecast_of
from somo_cli.scene.model import Scene
from somo_cli.simulation.plan.build import make_plan

SINGULAR_STEP = 1e-5  # s, where masses differ so much that no frequency can be computed


def stable_step(scene: Scene) -> float:
    """Return the time step of a scene [s], or one so short that MuJoCo's springs are stable.

    They are explicit in position and implicit in velocity: stable up to 2 over the highest natural
    frequency; half of that is taken, at the start and where all springs are relaxed.
    """
    plan = make_plan(scene)
    try:
        fastest = [
            float(modes.frequencies.max())
            for body in plan.bodies
            if body.chain.joints
            for modes in forecast_of(plan, body).modes.values()
        ]
    except SingularInertia:
        return min(scene.time_step, SINGULAR_STEP)
    if not fastest or max(fastest) == 0:
        return scene.time_step
    return min(scene.time_step, round_down_step(1 / max(fastest)))
