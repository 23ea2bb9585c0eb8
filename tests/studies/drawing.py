"""Figures of the studies: small, and the same bytes for the same numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def new_figure(width: float = 7.0, height: float = 4.0) -> Any:
    """Return an empty figure, its size in inches, that knows of no display."""
    # Figure itself, not pyplot: no state shared with others
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def panel(axes: Any, x: str, y: str) -> None:
    """Give axes their labels and a grid."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(visible=True, linewidth=0.3, color="0.85")


def save(figure: Any, path: Path) -> None:
    """Write a figure to a file, its folder made if there is none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100, metadata={"Software": None})
