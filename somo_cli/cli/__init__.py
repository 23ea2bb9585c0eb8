"""The commands: each reads files, calls the Python API, and writes the result."""

import os

# Set before numpy is loaded, whose OpenBLAS would start a thread for each core. For small matrices
# threads cost more time than they save, and the last digits of a chain of 120 joints depend on
# their number (seen with OpenBLAS 0.3).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from somo_cli.cli import (
    build,
    calibrate,
    calibrate_damping,
    calibrate_fit,
    calibrate_stiffness,
    calibrate_torque,
    check,
    columns,
    examples,
    help,
    import_model,
    new,
    plot,
    render,
    report,
    run,
    schema,
    show,
    sweep,
)
from somo_cli.cli.application import main

__all__ = [
    "build",
    "calibrate",
    "calibrate_damping",
    "calibrate_fit",
    "calibrate_stiffness",
    "calibrate_torque",
    "check",
    "columns",
    "examples",
    "help",
    "import_model",
    "main",
    "new",
    "plot",
    "render",
    "report",
    "run",
    "schema",
    "show",
    "sweep",
]
