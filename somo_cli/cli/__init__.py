"""The front door: commands that read files, call one function per stage, write the product."""

from somo_cli.cli import build, check, examples, report, run
from somo_cli.cli.door import main

__all__ = ["build", "check", "examples", "main", "report", "run"]
