"""The report of `somo check --numerics`: forecasts of a scene, and findings from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from somo_cli.analysis import conditioning
from somo_cli.analysis.contact_step import contact_step
from somo_cli.analysis.modes import SingularInertia
from somo_cli.analysis.round_steps import round_down_step
from somo_cli.analysis.stability import (
    EXPLICIT_SAFETY,
    TARGET_TIP_ERROR,
    StabilityForecast,
    forecast_of,
    predicted_error,
)
from somo_cli.arrays import Array
from somo_cli.document.parse import Document
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.model import Integrator
from somo_cli.simulation.plan.model import Body, Plan

FAST_TURN = 1.0  # rad in a step; the error of Coriolis forces grows with its square


@dataclass(frozen=True, slots=True)
class NumericsReport:
    """The forecast of each body of a plan that can be judged, and all findings."""

    plan: Plan
    forecasts: tuple[StabilityForecast, ...]
    findings: tuple[Problem, ...]

    @property
    def error(self) -> float:
        """Expected tip error with the plan's time step, relative to the length; nan if unknown."""
        if not self.forecasts:
            return math.nan
        return predicted_error(self.forecasts, self.plan.integrator, self.plan.time_step)

    def recommended_step_for(self, integrator: Integrator) -> float:
        """Return the recommended step for all bodies together [s]; nan if unknown."""
        if not self.forecasts:
            return math.nan
        steps = (one.recommended_step_for(integrator) for one in self.forecasts)
        return min(contact_step(self.plan), *steps)

    @property
    def explicit_step(self) -> float:
        """The largest stable step of the explicit integrator [s]; nan if unknown."""
        return min((one.explicit_step for one in self.forecasts), default=math.nan)


def assess(
    plan: Plan, document: Document, visited: Mapping[str, Sequence[tuple[Pose, Array]]]
) -> NumericsReport:
    """Return the report on the plan of a document; `visited` holds recorded poses by body name."""
    forecasts: list[StabilityForecast] = []
    findings: list[Problem] = []
    for index, body in enumerate(plan.bodies):
        at: Pointer = ("manipulators", index)
        findings.extend(conditioning.findings(plan, body, document, at))
        try:
            forecast = forecast_of(plan, body, visited.get(body.name, ()))
        except SingularInertia:
            continue  # reported by the findings on conditioning
        forecasts.append(forecast)
        findings.extend(_body_findings(body, forecast, document, at))
        swings = forecast.motion.joint_excursions
        findings.extend(conditioning.limits_reached(body, swings, document, at))
    if forecasts:
        findings.extend(_step_findings(NumericsReport(plan, tuple(forecasts), ()), document))
    return NumericsReport(plan, tuple(forecasts), tuple(findings))


def _body_findings(
    body: Body, forecast: StabilityForecast, document: Document, at: Pointer
) -> Iterator[Problem]:
    if forecast.modes["start"].topples:
        yield Problem(
            document.span(at),
            f"'{body.name}' topples: gravity is stronger than its springs at the start, so the "
            "smallest disturbance decides where it falls, with any time step",
            "start it bent, or make it lighter or its springs stiffer",
            "warning",
            "topples",
        )
    if forecast.motion.is_assumed:
        yield Problem(
            document.span(at),
            f"nothing moves '{body.name}' from its start, so the forecast is for a release in "
            "gravity of 9.81 m/s² sideways",
            "give it actuation, loads, initial_angles or initial_rates",
            "info",
            "nothing-moves",
        )


def _step_findings(report: NumericsReport, document: Document) -> Iterator[Problem]:
    plan = report.plan
    step, integrator = plan.time_step, plan.integrator
    place = document.span(("time_step",))
    limit = report.explicit_step
    if integrator == "explicit" and step > EXPLICIT_SAFETY * limit:
        is_over = step > limit
        yield Problem(
            place,
            f"a step of {step:g} s is {'above' if is_over else 'near'} the limit of the explicit "
            f"integrator, {limit:.3g} s",
            f"time_step: {report.recommended_step_for('explicit'):g}, or integrator: implicit with "
            f"time_step: {report.recommended_step_for('implicit'):g}",
            "error" if is_over else "warning",
            "explicit-step-too-long" if is_over else "explicit-step-near-limit",
        )
        if is_over:
            return
    if report.error > TARGET_TIP_ERROR:
        better = [
            f"time_step: {report.recommended_step_for(integrator):g}",
            f"integrator: implicit with time_step: {report.recommended_step_for('implicit'):g}",
        ]
        yield Problem(
            place,
            f"a tip error of {100 * report.error:.2g} % of the length is expected with "
            f"{integrator} at {step:g} s",
            ", or ".join(better if integrator != "implicit" else better[:1]),
            "warning",
            "inaccurate-step",
        )
    turn = max(one.motion.largest_turn(step) for one in report.forecasts)
    if turn > FAST_TURN:
        yield Problem(
            place,
            f"a joint may turn by {turn:.2g} rad in one step of {step:g} s, which no integrator "
            "follows",
            f"time_step: {round_down_step(step * FAST_TURN / turn):g}",
            "warning",
            "fast-joints",
        )
    fastest = max(one.modes["start"].frequencies[-1] for one in report.forecasts)
    if integrator != "explicit" and step * fastest > math.pi:
        count = sum(
            int((step * one.modes["start"].frequencies > math.pi).sum()) for one in report.forecasts
        )
        modes = "1 mode is" if count == 1 else f"{count} modes are"
        yield Problem(
            place,
            f"{modes} too fast for a step of {step:g} s, and treated as static",
            f"below {math.pi / fastest:.1g} s every mode is resolved",
            "info",
            "unresolved-modes",
        )
