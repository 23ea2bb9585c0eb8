"""Format the summary and the warnings at the end of `somo run`."""

from typing import TYPE_CHECKING

from somo_cli.cli.run_outputs import Targets

if TYPE_CHECKING:
    from somo_cli.api.runs import PreparedRun
    from somo_cli.simulation.run import RunSummary


def summary_lines(
    prepared: "PreparedRun", summary: "RunSummary", targets: Targets, events: int | None
) -> list[str]:
    """Return the reason of an early end, the files written, and the run time, as lines."""
    output, of_events = targets
    plan, simulated = prepared.plan, summary.steps * prepared.plan.time_step
    lines = []
    if summary.stopped is not None:
        number, reason = summary.stopped.condition, summary.stopped.reason
        lines.append(f"stopped at {simulated:.9g} s by stop[{number}]: {reason}")
    chosen = f", time step {plan.time_step:g} s" if prepared.scene.is_time_step_automatic else ""
    speed = summary.steps / summary.wall_time if summary.wall_time > 0 else 0
    lines.append(
        f"{_place(output)}: {summary.rows} rows of {len(prepared.names)} columns; "
        f"{simulated:g} s in {summary.wall_time:.3g} s{chosen}, {speed:.0f} steps per second"
    )
    if of_events is not None:
        lines.append(f"{_place(of_events)}: {events} events")
    return lines


def finding_lines(summary: "RunSummary") -> list[str]:
    """Return a warning and a hint for each finding of a run, as lines."""
    lines = []
    for one in summary.findings:
        lines += [f"somo: warning: {one.message} [{one.code}]", f"  hint: {one.hint}"]
    return lines


def _place(output: str) -> str:
    return "standard output" if output == "-" else output
