"""The result of `somo calibrate damping`, as text and as values for JSON."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from somo_cli.analysis.text_table import table_lines
from somo_cli.calibration.damping import Mode
from somo_cli.calibration.report import with_error
from somo_cli.calibration.ring_down import RingDown

MAX_FREQUENCY_ERROR = 0.05  # of the model, relative, above which there is a warning


def lines(
    mode: Mode, swing: RingDown | None, ratio: float, stiffness: Sequence[float]
) -> Iterator[str]:
    """Yield model and measurement, and the damping of joints that gives this damping ratio."""
    rows = [
        ["lowest mode of the axis", "frequency", "damping ratio"],
        ["model as it is", f"{mode.frequency:.6g} rad/s", f"{mode.ratio:.4g}"],
    ]
    if swing is not None:
        frequency = with_error(swing.frequency, swing.frequency_error, "rad/s")
        rows.append(["measured", frequency, with_error(swing.ratio, swing.ratio_error, "").strip()])
    yield from table_lines(rows)
    if swing is not None:
        yield (
            f"ring-down: {swing.periods:.3g} periods, decay {swing.decay:.4g} 1/s, "
            f"residual {swing.residual:.2g}, {100 * swing.explained:.4g} % of the motion explained"
        )
    if mode.is_alone:
        yield "there are other actuators: their joints, and the other axes, are taken as locked"
    elif mode.share < 0.99:
        yield f"{100 * mode.share:.3g} % of the elastic energy of the mode is in this axis"
    seconds = ratio * mode.per_ratio
    values = ", ".join(f"{seconds * value:.6g}" for value in stiffness)
    yield (
        f"for a damping ratio of {ratio:.4g}: spring_damping {values} N·m·s/rad, "
        f"{seconds:.4g} s times spring_stiffness"
    )


def frequency_warning(mode: Mode, swing: RingDown) -> tuple[str, str] | None:
    """Return a message and a hint if model and measurement differ in frequency, else None."""
    if abs(mode.frequency / swing.frequency - 1) <= MAX_FREQUENCY_ERROR:
        return None
    message = (
        f"the model swings at {mode.frequency:.4g} rad/s, the measured motion at "
        f"{swing.frequency:.4g} rad/s"
    )
    hint = (
        "stiffness over inertia should be "
        f"{(swing.frequency / mode.frequency) ** 2:.3g} times as large: check mass, stiffness, "
        "gravity, and the pose of the scene"
    )
    return message, hint


def plain_data(
    mode: Mode, swing: RingDown | None, ratio: float, stiffness: Sequence[float]
) -> dict[str, object]:
    """Return the same as values for JSON, in SI."""
    seconds = ratio * mode.per_ratio
    data: dict[str, object] = {
        "frequency_model": mode.frequency,
        "ratio_model": mode.ratio,
        "ratio": ratio,
        "damping_over_stiffness": seconds,
    }
    if swing is not None:
        data["ring_down"] = dataclasses.asdict(swing)
    data["spring_damping"] = [seconds * value for value in stiffness]
    return data
