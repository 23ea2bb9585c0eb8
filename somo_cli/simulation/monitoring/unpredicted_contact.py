"""The finding that contact forces were not predicted, in so many steps that a grasp may shake."""

from __future__ import annotations

from somo_cli.simulation.integrator.contact_prediction import MOST_POINTS, PredictionCount
from somo_cli.simulation.monitoring.findings import Finding, half_step_hint
from somo_cli.simulation.plan.model import Plan

MOST_UNPREDICTED = 0.01  # of the steps in which a law felt contact: fewer are not worth a finding


def unpredicted_contact(plan: Plan, count: PredictionCount) -> Finding | None:
    """Return a finding if contact forces were not predicted in more than a few steps, else None."""
    unpredicted = count.crowded + count.unsolved
    if count.first is None or unpredicted <= MOST_UNPREDICTED * count.felt:
        return None
    reasons = []
    if count.crowded:
        reasons.append(
            f"in {count.crowded} of them up to {count.most_points} points pressed, and at most "
            f"{MOST_POINTS} with friction are predicted"
        )
    if count.unsolved:
        reasons.append(f"in {count.unsolved} of them no forces were found that obey friction")
    step, parts = count.first
    return Finding(
        "contact-unpredicted",
        step * plan.time_step,
        tuple(plan.recorded.names[part] for part in parts),
        f"contact forces were not predicted in {unpredicted} of the {count.felt} steps with "
        f"contact: {'; '.join(reasons)}; forces may shake",
        f"{half_step_hint(plan.time_step)}, or model fewer points of contact",
        (("steps_with_contact", count.felt), ("steps_unpredicted", unpredicted)),
    )
