"""The type of the fixture `somo`, which runs the command in a process of its own."""

from __future__ import annotations

import subprocess
from collections.abc import Callable

Somo = Callable[..., subprocess.CompletedProcess[str]]
"""`somo("check", path, cwd=..., stdin=..., env=..., timeout=...)`; arguments are str or Path."""
