"""The whole of `somo check --numerics`: what is expected of a scene, and what to say of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from somo_cli.analysis import conditioning
from somo_cli.analysis.modes import NotAnInertia
from somo_cli.analysis.stability import (
    SAFETY,
    TARGET,
    Outlook,
    outlook_of,
    predicted_error,
    rounded_down,
)
from somo_cli.arrays import Array
from somo_cli.document.parse import Document
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Pointer, Problem
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.scene import Integrator

FAST = 1.0  # rad in a step; Coriolis forces are followed to second order in it


@dataclass(frozen=True, slots=True)
class Numerics:
    """What is expected of a plan: the outlook of each body that could be judged, and findings."""

    plan: Plan
    outlooks: tuple[Outlook, ...]
    findings: tuple[Problem, ...]

    @property
    def error(self) -> float:
        """The tip error to expect at the plan's own step, relative to the length."""
        if not self.outlooks:
            return math.nan
        return predicted_error(self.outlooks, self.plan.integrator, self.plan.time_step)

    def recommended(self, integrator: Integrator) -> float:
        """Return the step [s] to recommend for all bodies together."""
        return min((one.recommended(integrator) for one in self.outlooks), default=math.nan)

    @property
    def explicit_step(self) -> float:
        """The largest stable step of the explicit law [s]."""
        return min((one.explicit_step for one in self.outlooks), default=math.nan)


def judge(
    plan: Plan, document: Document, met: Mapping[str, Sequence[tuple[Pose, Array]]]
) -> Numerics:
    """Judge a plan made from a document; `met` holds poses of a trajectory by body name."""
    outlooks: list[Outlook] = []
    findings: list[Problem] = []
    for index, body in enumerate(plan.bodies):
        at: Pointer = ("manipulators", index)
        findings.extend(conditioning.findings(plan, body, document, at))
        try:
            outlook = outlook_of(plan, body, met.get(body.name, ()))
        except NotAnInertia:
            continue  # the conditioning has said so
        outlooks.append(outlook)
        findings.extend(_of_body(body, outlook, document, at))
        swings = outlook.motion.swings
        findings.extend(conditioning.limits_met(body, swings, document, at))
    if outlooks:
        findings.extend(_of_step(Numerics(plan, tuple(outlooks), ()), document))
    return Numerics(plan, tuple(outlooks), tuple(findings))


def _of_body(body: Body, outlook: Outlook, document: Document, at: Pointer) -> Iterator[Problem]:
    if outlook.modes["start"].topples:
        yield Problem(
            document.span(at),
            f"'{body.name}' topples: gravity is stronger than its springs where it starts, so "
            "the least disturbance decides where it falls, and no step makes that predictable",
            "start it bent, lighten it, or stiffen its springs",
            "warning",
            "topples",
        )
    if outlook.motion.is_assumed:
        yield Problem(
            document.span(at),
            f"nothing moves '{body.name}' from where it starts, so what is expected is said of one "
            "that is let go in 9.81 m/s² sideways",
            "give it actuation, loads, initial_angles or initial_rates",
            "info",
            "nothing-moves",
        )


def _of_step(known: Numerics, document: Document) -> Iterator[Problem]:
    plan = known.plan
    step, integrator = plan.time_step, plan.integrator
    place = document.span(("time_step",))
    limit = known.explicit_step
    if integrator == "explicit" and step > SAFETY * limit:
        is_over = step > limit
        yield Problem(
            place,
            f"a step of {step:g} s is {'beyond' if is_over else 'near'} the limit of the explicit "
            f"integrator, {limit:.3g} s",
            f"time_step: {known.recommended('explicit'):g}, or integrator: implicit with "
            f"time_step: {known.recommended('implicit'):g}",
            "error" if is_over else "warning",
            "explicit-step-too-long" if is_over else "explicit-step-near-limit",
        )
        if is_over:
            return
    if known.error > TARGET:
        better = [
            f"time_step: {known.recommended(integrator):g}",
            f"integrator: implicit with time_step: {known.recommended('implicit'):g}",
        ]
        yield Problem(
            place,
            f"the tip is expected to be off by {100 * known.error:.2g} % of the length, with "
            f"{integrator} at {step:g} s",
            ", or ".join(better if integrator != "implicit" else better[:1]),
            "warning",
            "inaccurate-step",
        )
    turn = max(one.motion.turn_in(step) for one in known.outlooks)
    if turn > FAST:
        yield Problem(
            place,
            f"a joint may turn by {turn:.2g} rad in one step of {step:g} s, which no integrator "
            "follows",
            f"time_step: {rounded_down(step * FAST / turn):g}",
            "warning",
            "fast-joints",
        )
    fastest = max(one.modes["start"].frequencies[-1] for one in known.outlooks)
    if integrator != "explicit" and step * fastest > math.pi:
        count = sum(
            int((step * one.modes["start"].frequencies > math.pi).sum()) for one in known.outlooks
        )
        modes = "1 mode is" if count == 1 else f"{count} modes are"
        yield Problem(
            place,
            f"{modes} too fast for a step of {step:g} s, and followed as if at rest",
            f"below {math.pi / fastest:.1g} s every mode is followed",
            "info",
            "unresolved-modes",
        )
