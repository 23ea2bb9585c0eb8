"""What PyBullet makes of the URDF of a chain, without the code of a run."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.urdf import render


@contextmanager
def in_bullet(text: str) -> Iterator[tuple[Any, int, int]]:
    """Load a URDF into a fresh PyBullet, base held; yield the engine, the client and the body."""
    bullet = pytest.importorskip("pybullet")
    client = bullet.connect(bullet.DIRECT)
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "body.urdf"
            path.write_text(text, "utf-8")
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            body = bullet.loadURDF(
                str(path), useFixedBase=True, flags=flags, physicsClientId=client
            )
        yield bullet, client, body
    finally:
        bullet.disconnect(client)


def bullet_mass_matrix(chain: Chain, angles: list[float]) -> np.ndarray:
    """Return the joint-space inertia [kg·m²] that PyBullet computes, the base held."""
    with in_bullet(render(chain)) as (bullet, client, body):
        return np.array(bullet.calculateMassMatrix(body, angles, physicsClientId=client))
