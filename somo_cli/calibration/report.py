"""The result of `somo calibrate stiffness`, in words, as tables and as values for JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from somo_cli.analysis.text_table import table_lines
from somo_cli.calibration.beam_comparison import BeamComparison
from somo_cli.calibration.moment_arms import MomentArms

_MOST_PLACES = 8


def described(moment_arms: MomentArms) -> str:
    """Return a sentence that says where the joints of an axis are [mm]."""
    places = [f"{1000 * place:.4g}" for place in moment_arms.places]
    if len(places) > _MOST_PLACES:
        places = [*places[:3], "...", places[-1]]
    verb = "bends" if moment_arms.kind == "bending" else "twists"
    axis = ", ".join(f"{value:g}" for value in moment_arms.direction)
    where = (
        ""
        if moment_arms.at == moment_arms.length
        else f", measured at {1000 * moment_arms.at:.4g} mm"
    )
    count = "1 joint" if moment_arms.count == 1 else f"{moment_arms.count} joints"
    return (
        f"{verb} about [{axis}], {count} at {', '.join(places)} mm "
        f"of {1000 * moment_arms.length:.4g} mm{where}"
    )


def stiffness_lines(moment_arms: MomentArms, wanted: float, own: float | None) -> Iterator[str]:
    """Yield a table of the joint stiffness by each rule, and the tip stiffness that it gives.

    `wanted` is the required tip stiffness [N/m, N·m/rad], `own` the joint stiffness in the
    definition [N·m/rad], if there is one.
    """
    unit = "N·m/rad" if moment_arms.kind == "torsion" else "N/m"
    rules = {"exact": moment_arms.stiffness(wanted)}
    if moment_arms.kind == "bending":
        rules["SoMo's formula"] = moment_arms.somo_stiffness(wanted)
    if own:
        rules["in the file"] = own
    rows = []
    for name, stiffness in rules.items():
        tip = moment_arms.tip_stiffness(stiffness)
        off = round(100 * (tip / wanted - 1), 9)
        rows.append([name, f"{stiffness:.6g}", f"{tip:.6g}", f"{off:+.4g} %"])
    header = ["rule", "spring_stiffness [N·m/rad]", f"tip [{unit}]", "off by"]
    yield from table_lines([header, *rows])
    if moment_arms.count > 1 and moment_arms.profile.min() < moment_arms.profile.max():
        yield "spring_stiffness is that of the first joint; the others keep their ratios to it"


def comparison_lines(
    found: Sequence[BeamComparison], wanted: float, own: BeamComparison | None
) -> Iterator[str]:
    """Yield a table of the errors of chains against a uniform beam of the same tip stiffness [%].

    `wanted` is the tip stiffness, `own` the chain to calibrate, if there is one.
    """
    is_bending = found[0].moment_arms.kind == "bending"
    header = ["joints", "placement", "spring_stiffness", "along", "first mode", "highest/first"]
    if is_bending:
        header[4:4] = ["end moment", "own weight", "PL²/EI=1"]
        header.append("SoMo's formula")
    rows = []
    for one in [*found, *([own] if own else [])]:
        moment_arms = one.moment_arms
        row = [f"{moment_arms.count}", one.placement, f"{moment_arms.stiffness(wanted):.6g}"]
        errors = [one.along]
        if is_bending:
            errors += [one.moment, one.weight, one.large]
        row += [_percent(value) for value in (*errors, one.frequency)]
        row.append(f"{one.top:.4g}")
        if is_bending:
            somo = moment_arms.tip_stiffness(moment_arms.somo_stiffness(wanted)) / wanted - 1
            row.append(f"{100 * somo:+.1f} %" if one.placement == "uniform" else "")
        rows.append(row + (["<- this one"] if one is own else []))
    yield from table_lines([header, *rows])


def plain_data(
    moment_arms: MomentArms, wanted: float, found: float, chains: Sequence[BeamComparison]
) -> dict[str, object]:
    """Return the tip stiffness, the joint stiffness found, and the chains, as values for JSON."""
    return {
        "kind": moment_arms.kind,
        "places_m": moment_arms.places.tolist(),
        "at_m": moment_arms.at,
        "tip_stiffness": wanted,
        "rigidity": moment_arms.rigidity(wanted),
        "spring_stiffness": found,
        "tip_stiffness_made": moment_arms.tip_stiffness(found),
        "profile": moment_arms.profile.tolist(),
        "chains": [_plain_chain(one, wanted) for one in chains],
    }


def _plain_chain(one: BeamComparison, wanted: float) -> dict[str, object]:
    errors = {
        "moment": one.moment,
        "weight": one.weight,
        "large": one.large,
        "frequency": one.frequency,
        "top": one.top,
    }
    return {
        "joints": one.moment_arms.count,
        "placement": one.placement,
        "spring_stiffness": one.moment_arms.stiffness(wanted),
        "along": one.along,
        "errors_at_tenths": one.profile.tolist(),
        **{key: None if math.isnan(value) else value for key, value in errors.items()},
    }


def _percent(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{100 * value:.2g} %" if abs(value) > 1e-12 else "exact"


def with_error(value: float, error: float, unit: str) -> str:
    """Return a value with unit and the half width of its confidence interval, if that is known."""
    return f"{value:.6g}" + (f" ± {error:.2g}" if math.isfinite(error) else "") + f" {unit}"
