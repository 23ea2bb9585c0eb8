"""A figure for one column of a paper, and its bytes: the same for the same numbers."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from somo_cli.problems import ExtraMissing

FORMATS = ("png", "svg", "pdf")
WIDTH = 3.35  # in: one column of a paper, 85 mm
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
"""The colours of Okabe and Ito, which the colour-blind tell apart."""

_STYLE = {
    "svg.hashsalt": "somo",
    "font.size": 7.5,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "legend.fontsize": 6.5,
    "legend.framealpha": 0.7,
    "legend.handlelength": 1.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
}
_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}


@contextmanager
def drawing() -> Iterator[None]:
    """Draw in this style, whatever the user's own; raises ExtraMissing without matplotlib."""
    try:
        from matplotlib import style
    except ImportError as error:
        raise ExtraMissing("plots need matplotlib: pip install 'somo-cli[plot]'") from error
    with style.context(["default", _STYLE]):
        yield


def panels(
    count: int, height: float, most_rows: int = 4, across: bool = False
) -> tuple[Any, list[Any]]:
    """Return a figure and axes for panels of a height [in], in columns of at most `most_rows`.

    The axes are in the order of columns, or row by row if `across`.
    """
    # Figure itself, not pyplot: no display, no state shared with others
    from matplotlib.figure import Figure

    columns = -(-count // most_rows)
    rows = -(-count // columns)
    figure = Figure(figsize=(WIDTH * columns, height * rows + 0.3), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    axes = list((grid if across else grid.T).flat)
    for unused in axes[count:]:
        unused.remove()
    for one in axes[:count]:
        one.grid(visible=True, linewidth=0.3, color="0.85")
        one.set_axisbelow(True)
    return figure, axes[:count]


def image(figure: Any, kind: str) -> bytes:
    """Return the bytes of a figure in one of `FORMATS`."""
    stream = io.BytesIO()
    figure.savefig(stream, format=kind, dpi=200, metadata=_METADATA[kind])
    return stream.getvalue()
