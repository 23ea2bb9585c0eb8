"""The bodies of the bench and the tests."""

from __future__ import annotations

from tests.free_bodies.bodies import Spinning

PENCIL = Spinning("pencil", (7.5e-4, 7.5e-4, 5e-6), (3.0, 0.0, 30.0))
DISC = Spinning("disc", (1e-3, 1e-3, 1.95e-3), (4.0, 0.0, 12.0))
BOX = Spinning("box, middle axis", (1e-3, 2e-3, 2.5e-3), (0.5, 15.0, 0.3))
PLATE = Spinning("plate, stable axis", (1e-3, 2e-3, 2.9e-3), (6.0, 0.0, 10.0))
BODIES = (PENCIL, DISC, BOX, PLATE)
BALL = Spinning("uneven ball, rolling", (2.2e-3, 3.6e-3, 4.6e-3), (6.0, 3.0, 8.0), rolls=True)
