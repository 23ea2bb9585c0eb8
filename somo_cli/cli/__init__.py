"""The front door: commands that read files, call one function per stage, write the product."""

import os

# Before anything loads numpy, whose library would take a thread for each core: with matrices as
# small as ours, threads cost more time than they save, and the last digits of what a chain of 120
# joints does depend on how many there are (seen with OpenBLAS 0.3).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from somo_cli.cli import (
    build,
    calibrate,
    calibrate_damping,
    calibrate_fit,
    calibrate_stiffness,
    calibrate_torque,
    check,
    examples,
    render,
    report,
    run,
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
    "examples",
    "main",
    "render",
    "report",
    "run",
]
