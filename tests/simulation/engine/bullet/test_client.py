"""Engines of one process are separate without a number at every call."""

from __future__ import annotations

import pytest

from somo_cli.simulation.engine.bullet.client import BulletClient


def test_each_client_speaks_to_its_own_engine() -> None:
    one, two = BulletClient(), BulletClient()
    try:
        one.createMultiBody(1.0, one.createCollisionShape(one.GEOM_SPHERE, radius=1))
        assert (one.getNumBodies(), two.getNumBodies()) == (1, 0)
    finally:
        one.close()
        two.close()


def test_a_closed_client_reaches_no_other_engine() -> None:
    one, two = BulletClient(), BulletClient()
    try:
        one.createMultiBody(1.0)
        one.close()
        one.close()
        new = BulletClient()  # may get the number of the one that is closed
        with pytest.raises(one.module.error):
            one.createMultiBody(1.0)
        assert (two.getNumBodies(), new.getNumBodies()) == (0, 0)
        new.close()
    finally:
        two.close()
