"""What a folder holds, and with which permissions."""

from __future__ import annotations

import stat
from pathlib import Path


def mode_of(path: Path) -> int:
    """Return the permissions of a file."""
    return stat.S_IMODE(path.stat().st_mode)


def names_in(folder: Path) -> list[str]:
    """Return the names of all that lies in a folder, sorted."""
    return sorted(path.name for path in folder.iterdir())
