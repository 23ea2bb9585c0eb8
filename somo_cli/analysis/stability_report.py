"""The report on the numerics of a scene, as a table and as values for JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator

from somo_cli.analysis.contact_step import contact_step
from somo_cli.analysis.numerics import NumericsReport
from somo_cli.analysis.stability import StabilityForecast
from somo_cli.analysis.text_table import table_lines
from somo_cli.arrays import Array
from somo_cli.scene.model import Integrator

INTEGRATORS: tuple[Integrator, ...] = ("implicit", "euler", "explicit")


def table(report: NumericsReport) -> list[str]:
    """Return the modes of every body, the recommended steps and the verdict, as lines."""
    plan = report.plan
    rows: list[list[str]] = []
    for one in report.forecasts:
        rows += [*_forecast_rows(one), []]
    if plan.bodies:
        rows.append(["recommended step", *INTEGRATORS])
        rows.append(["", *(f"{report.recommended_step_for(name):g} s" for name in INTEGRATORS)])
    verdict = f"{plan.integrator} at {plan.time_step:g} s: {_verdict(report)}"
    contact = [_contact_verdict(report)] if plan.bodies and plan.can_touch else []
    return [*table_lines(rows), verdict, *contact]


def _verdict(report: NumericsReport) -> str:
    plan, limit = report.plan, report.explicit_step
    if not plan.bodies:
        return (
            "not judged, since there are no manipulators, whose springs limit a time step; "
            "run --error measures the error of the objects"
        )
    if math.isnan(report.error):
        return "cannot be judged"
    if plan.integrator == "explicit":
        if plan.time_step > limit:
            return f"unstable, {plan.time_step / limit:.3g} times its limit of {limit:.3g} s"
        stable = f"stable, {plan.time_step / limit:.2g} of its limit of {limit:.3g} s"
    else:
        stable = "stable"
    expected = (
        f"{stable}; a tip error of about {100 * report.error:.2g} % of the length is expected"
    )
    strikes = any(one.code == "limits-met" for one in report.findings)
    return f"{expected}, impacts at joint limits not counted" if strikes else expected


def _contact_verdict(report: NumericsReport) -> str:
    """Return what is known of contact before a run: a rule, and how to know more."""
    step, largest = report.plan.time_step, contact_step(report.plan)
    rule = (
        f"{step:g} s is within the rule of at most {largest:g} s"
        if step <= largest
        else f"{step:g} s is above the rule of at most {largest:g} s"
    )
    return f"contact is not judged, {rule}: run --tolerance or --error measures its error"


def _forecast_rows(one: StabilityForecast) -> Iterator[list[str]]:
    modes = list(one.modes.values())
    yield [f"{one.body.name}: {len(one.body.chain.joints)} joints", *one.modes]
    rows = {
        "lowest natural frequency [rad/s]": [each.frequencies[0] for each in modes],
        "                         [Hz]": [each.frequencies[0] / (2 * math.pi) for each in modes],
        "highest                  [rad/s]": [each.frequencies[-1] for each in modes],
        "damping ratio, lowest mode": [each.damping_ratios[0] for each in modes],
        "               highest mode": [each.damping_ratios[-1] for each in modes],
        "               least damped": [each.least_damping_ratio for each in modes],
        "stiffness ratio": [stiffness_ratio(each.frequencies) for each in modes],
        "largest explicit step [s]": [each.explicit_step for each in modes],
    }
    for name, values in rows.items():
        yield [f"  {name}", *(f"{value:.4g}" for value in values)]


def stiffness_ratio(frequencies: Array) -> float:
    """Return the ratio of the largest to the smallest squared frequency."""
    lowest = float(frequencies[0])
    return float(frequencies[-1]) ** 2 / lowest**2 if lowest > 0 else math.inf


def plain_data(report: NumericsReport) -> dict[str, object]:
    """Return the same as values for JSON; None where a number is not finite."""
    plan = report.plan
    return {
        "integrator": plan.integrator,
        "time_step_s": plan.time_step,
        "verdict": _verdict(report),
        "contact_step_s": _finite(contact_step(plan)),
        "expected_tip_error_relative": _finite(report.error),
        "explicit_step_s": _finite(report.explicit_step),
        "recommended_time_step_s": {
            name: _finite(report.recommended_step_for(name)) for name in INTEGRATORS
        },
        "manipulators": {
            one.body.name: {
                name: {
                    "frequencies_rad_per_s": modes.frequencies.tolist(),
                    "damping_ratios": [_finite(value) for value in modes.damping_ratios.tolist()],
                    "least_damping_ratio": modes.least_damping_ratio,
                    "roots_per_s": [[root.real, root.imag] for root in modes.all_roots.tolist()],
                    "stiffness_ratio": _finite(stiffness_ratio(modes.frequencies)),
                    "explicit_step_s": _finite(modes.explicit_step),
                    "topples": modes.topples,
                }
                for name, modes in one.modes.items()
            }
            for one in report.forecasts
        },
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
