"""Decompose a mesh into convex pieces, by PyBullet's V-HACD (Mamou, github.com/kmammou/v-hacd)."""

from __future__ import annotations

import tempfile
from functools import lru_cache
from pathlib import Path

import numpy as np

from somo_cli.problems import EngineMissing
from somo_cli.simulation.engine.bullet.c_stdio import captured_output, decimal_points
from somo_cli.simulation.engine.bullet.client import import_pybullet


@lru_cache(maxsize=16)
def convex_pieces(triangles: str) -> str | None:
    """Return an OBJ text of convex parts for an OBJ text of triangles; None without an engine.

    The same triangles give the same text. Lengths are those of the triangles.
    """
    try:
        with captured_output():  # it prints when it was built
            bullet = import_pybullet()
    except EngineMissing:
        return None
    lines = triangles.splitlines()
    points = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], dtype=float)
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    extent = float(np.ptp(points, axis=0).max())
    # seen in 3.2.7: it writes six decimals, so it is given a mesh of unit size
    unit = [_vertex(row) for row in (points - middle) / extent]
    unit += [line for line in lines if not line.startswith("v ")]
    with tempfile.TemporaryDirectory(prefix="somo-") as folder:
        given, found, log = (str(Path(folder) / name) for name in ("in.obj", "out.obj", "log.txt"))
        Path(given).write_text("\n".join(unit) + "\n", encoding="utf-8")
        with captured_output(), decimal_points():
            bullet.vhacd(given, found, log)
        text = Path(found).read_text(encoding="utf-8")
    pieces = [
        _vertex(np.array(line.split()[1:4], dtype=float) * extent + middle)
        if line.startswith("v ")
        else line
        for line in text.splitlines()
    ]
    return "\n".join(pieces) + "\n"


def _vertex(row: np.typing.NDArray[np.float64]) -> str:
    return "v " + " ".join(map(repr, row.tolist()))
