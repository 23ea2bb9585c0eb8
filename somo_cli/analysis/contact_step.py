"""The largest time step that is recommended where bodies can touch.

Springs do not say how a contact comes about, so this is a rule with a margin and no forecast: what
a run then does is monitored, and `--tolerance` finds its error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from somo_cli.analysis.round_steps import round_down_step
from somo_cli.simulation.plan.model import Plan

LARGEST_CONTACT_STEP = 1e-3
"""s; at 1 ms grasps hold over masses, damping and shapes, at 2 ms not all (`make grasp`)."""
LARGEST_SWING = 0.3
"""Of a step times the root of contact stiffness over mass; a cube that falls on such ground gains
1.2 % of its energy, and 5 % at 0.5 (`make sliding`)."""


def contact_step(plan: Plan) -> float:
    """Return the largest step that is recommended for a plan [s]; infinite if nothing can touch."""
    if not plan.can_touch:
        return math.inf
    swings = list(_swings(plan))
    fastest = max(swings, default=0.0)
    if fastest * LARGEST_CONTACT_STEP <= LARGEST_SWING:
        return LARGEST_CONTACT_STEP
    return round_down_step(LARGEST_SWING / fastest)


def _swings(plan: Plan) -> Iterator[float]:
    """Yield how fast what can move swings on the softest of the surfaces that it may touch [1/s].

    Two soft surfaces are springs in series, so the softer one bounds the stiffness. A link of a
    manipulator is taken to have its share of the mass.
    """
    ground = None if plan.ground is None else plan.ground.surface.compliance
    others = [] if ground is None else [ground.stiffness]
    for body in plan.bodies:
        links = body.chain.links
        mass = sum(link.inertial.mass for link in links) / len(links)
        own = [one.compliance.stiffness for one in body.surfaces.all if one.compliance]
        yield from (math.sqrt(stiffness / mass) for stiffness in own + others)
    for planned in plan.objects:
        if planned.rigid_object.has_prescribed_pose:
            continue
        mass = planned.rigid_object.chain.links[0].inertial.mass
        compliance = planned.rigid_object.surface.compliance
        own = [compliance.stiffness] if compliance else []
        yield from (math.sqrt(stiffness / mass) for stiffness in own + others)
