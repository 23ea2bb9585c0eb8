"""PyBullet itself, where it is installed."""

from __future__ import annotations

import sys
from typing import Any

from somo_cli.problems import EngineMissing


def import_pybullet(missing: str = "the engine, PyBullet, is") -> Any:
    """Return the module; raise EngineMissing where there is none, of `missing` missing then."""
    try:
        import pybullet
    except ImportError as error:
        raise EngineMissing(
            f"{missing} not installed for this Python "
            f"({sys.version_info.major}.{sys.version_info.minor}); "
            "build and check work without it"
        ) from error
    return pybullet
