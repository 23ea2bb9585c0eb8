"""The result of a fit, as tables and as values for JSON."""

from __future__ import annotations

from somo_cli.analysis.text_table import table_lines
from somo_cli.calibration.fit import FitResult
from somo_cli.calibration.measurement import Measurement
from somo_cli.calibration.parameters import UNITS


def lines(found: FitResult, measured: Measurement) -> list[str]:
    """Return the table of the parameters, and that of the residuals before and after the fit."""
    parameters = [["parameter", "guess", "fitted", "± (95 %)", "", "unit"]]
    for number, one in enumerate(found.parameters):
        value, error = found.values[number], found.errors[number]
        cells = [f"{one.guess:.6g}", f"{value:.6g}", f"{error:.2g}"]
        parameters.append([one.name, *cells, f"{100 * error / abs(value):.2g} %", UNITS[one.kind]])
    residuals = [["residual, root mean square", "guess", "fitted"]]
    residuals += [
        [name, f"{before:.3g}", f"{after:.3g}"]
        for name, before, after in zip(
            measured.names, found.first_residual_rms, found.residual_rms, strict=True
        )
    ]
    count = f"{len(measured.times)} rows, {found.runs} runs of the scene"
    return [*table_lines(parameters), "", *table_lines(residuals), count]


def plain_data(found: FitResult, measured: Measurement) -> dict[str, object]:
    """Return the parameters and how well they fit, as values for JSON."""
    return {
        "parameters": [
            {
                "what": one.kind,
                "actuator": one.actuator,
                "axis": one.axis,
                "guess": one.guess,
                "value": float(found.values[number]),
                "error": float(found.errors[number]),
            }
            for number, one in enumerate(found.parameters)
        ],
        "correlation": found.correlation.tolist(),
        "silent": [one.name for one in found.insensitive],
        "columns": list(measured.names),
        "residual_rms": found.residual_rms.tolist(),
        "persistence": found.autocorrelation,
        "runs": found.runs,
    }
