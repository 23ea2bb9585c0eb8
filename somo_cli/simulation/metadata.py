"""The provenance and settings of a run, as plain values for the `.meta.json` beside the CSV."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version

from somo_cli import __version__
from somo_cli.simulation import plan_report
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.run import RunSummary

_ENGINES = ("pybullet", "pybullet-arm64")


def metadata(
    plan: Plan,
    summary: RunSummary,
    inputs: Mapping[str, str],
    overrides: Sequence[str],
    columns: Sequence[str],
    is_time_step_automatic: bool = False,
    expected_tip_error: float | None = None,
) -> dict[str, object]:
    """Return versions, input hashes, step, integrator, scale and run time of a finished run.

    `inputs` maps each file that was read to its text. The plan does not say whether `auto` chose
    the time step, or for which tip error relative to the length. The same input gives the
    same values, except for versions, platform and run time.
    """
    simulated = summary.steps * plan.time_step
    return {
        **provenance(inputs, overrides),
        "integrator": plan.integrator,
        "time_step_s": plan.time_step,
        "time_step_chosen": is_time_step_automatic,
        "expected_tip_error_relative": expected_tip_error,
        "steps": summary.steps,
        "stopped_by": _stopped_by(summary),
        "findings": [one.plain_data() for one in summary.findings],
        "contact_prediction": _contact_prediction(summary),
        "record_every": plan.every,
        "rows": summary.rows,
        "plan": plan_report.plain_data(plan),
        "columns": list(columns),
        "world_scale": {"length": plan.scale.length, "mass": plan.scale.mass},
        "manipulators": {
            body.name: {"base": body.base, "joints": len(body.chain.joints)} for body in plan.bodies
        },
        "simulated_time_s": simulated,
        "run_time_s": summary.wall_time,
        "steps_per_second": summary.steps / summary.wall_time if summary.wall_time > 0 else None,
        "real_time_factor": simulated / summary.wall_time if summary.wall_time > 0 else None,
    }


def _stopped_by(summary: RunSummary) -> dict[str, object] | None:
    if summary.stopped is None:
        return None
    return {"stop": summary.stopped.condition, "reason": summary.stopped.reason}


def _contact_prediction(summary: RunSummary) -> dict[str, int]:
    count = summary.prediction
    return {
        "steps_with_contact": count.felt,
        "most_points": count.most_points,
        "steps_with_too_many_points": count.crowded,
        "steps_without_solution": count.unsolved,
    }


def provenance(inputs: Mapping[str, str], overrides: Sequence[str]) -> dict[str, object]:
    """Return the provenance of a result: versions, platform, files read, and overrides.

    Overrides from the command line are not listed as files, although the inputs have their texts.
    """
    return {
        "somo": __version__,
        "engine": _engine(),
        "numpy": version("numpy"),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "inputs": {
            source: {"sha256": hashlib.sha256(_bytes(text)).hexdigest()}
            for source, text in inputs.items()
            if not source.startswith("--set")
        },
        "overrides": list(overrides),
    }


def _bytes(text: str) -> bytes:
    # what was not UTF-8 in a binary file stands as surrogates in its text
    return text.encode("utf-8", "surrogateescape")


def _engine() -> str:
    for name in _ENGINES:
        try:
            return f"{name} {version(name)}"
        except PackageNotFoundError:
            continue
    return "pybullet"
