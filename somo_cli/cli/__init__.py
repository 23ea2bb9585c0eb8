"""The front door: commands that read files, call one function per stage, write the product."""

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
from somo_cli.cli.door import main

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
