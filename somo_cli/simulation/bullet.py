"""The world on headless PyBullet; the only place pybullet is known.

Facts about PyBullet 3.2.7 that the code below depends on stand beside the lines they explain.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

from somo_cli.problems import EngineMissing, EngineRefused
from somo_cli.simulation.bullet_body import BulletBody
from somo_cli.simulation.bullet_thing import BulletThing
from somo_cli.simulation.c_library import captured_output, decimal_points, duplicate, flush_c
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.surface import Ground
from somo_cli.simulation.world import Part

GROUND_REACH = 1000.0  # engine units, from the origin
GROUND_DEPTH = 20.0  # engine units: what falls faster than this in a step passes through


class BulletWorld:
    """A plan loaded into an engine of its own: bodies in the order of the plan."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._bullet: Any = None
        self._client = -1
        self._stdout: int | None = None
        self.bodies: list[BulletBody] = []
        self.things: list[BulletThing] = []
        self._numbers: dict[int, int] = {}
        self.step: Callable[[], object] = self._refuse

    def __enter__(self) -> BulletWorld:
        """Load every body; until `close`, what the engine prints goes to standard error."""
        with captured_output() as said, decimal_points():
            self._bullet = _engine()
            self._client = self._bullet.connect(self._bullet.DIRECT)
            try:
                self._set_up()
            except self._bullet.error as error:
                self.close()
                raise EngineRefused(self._loading(), f"{error} {said()}".strip()) from error
            except BaseException:
                self.close()
                raise
        self._stdout = duplicate(1)
        if self._stdout is not None:
            with suppress(OSError):
                os.dup2(2, 1)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave the engine and give standard output back."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1
        if self._stdout is not None:
            flush_c()
            os.dup2(self._stdout, 1)
            os.close(self._stdout)
            self._stdout = None

    def penetrations(self) -> list[tuple[Part, Part, float]]:
        """Return which parts were how deep in each other in the last step; depths above 0 only."""
        return [
            ((self._numbers[point[1]], point[3] + 1), (self._numbers[point[2]], point[4] + 1), -gap)
            for point in self._bullet.getContactPoints(physicsClientId=self._client)
            if (gap := point[8]) < 0
        ]

    @staticmethod
    def _refuse() -> None:
        raise RuntimeError("the world is entered before it is stepped")

    def _set_up(self) -> None:
        # advances every body by one time step; torques last for one step
        self.step = partial(self._bullet.stepSimulation, self._client)
        # the cache would serve an old file under a known name, even after a reset; the solver would
        # be content with 50 iterations, or with an error of 3e-4 engine units per second, which to
        # the constraints, contacts and dry friction of a small body is as good as any
        self._bullet.setPhysicsEngineParameter(
            enableFileCaching=0,
            fixedTimeStep=self._plan.time_step,
            numSolverIterations=200,
            solverResidualThreshold=1e-30,
            physicsClientId=self._client,
        )
        self._bullet.setGravity(*self._plan.gravity, physicsClientId=self._client)
        with tempfile.TemporaryDirectory(prefix="somo-") as folder:
            for number, body in enumerate(self._plan.bodies):
                path = Path(folder) / f"{number}.urdf"
                path.write_text(body.urdf, encoding="utf-8")
                self.bodies.append(
                    BulletBody(self._bullet, self._client, body, self._plan.gravity, str(path))
                )

            for number, thing in enumerate(self._plan.things):
                path = Path(folder) / f"object_{number}.urdf"
                path.write_text(thing.urdf, encoding="utf-8")
                self.things.append(BulletThing(self._bullet, self._client, thing, str(path)))
        indices = [body.index for body in self.bodies] + [thing.index for thing in self.things]
        if self._plan.ground is not None:
            indices.append(self._lay_ground(self._plan.ground))
        self._numbers = {index: number for number, index in enumerate(indices)}

    def _lay_ground(self, ground: Ground) -> int:
        # seen in 3.2.7: on a plane (GEOM_PLANE) a sliding box stands on one or two points and
        # sinks in by millimetres, on a large box on four
        bullet, client = self._bullet, self._client
        half = [GROUND_REACH, GROUND_REACH, GROUND_DEPTH / 2]
        slab = bullet.createCollisionShape(
            bullet.GEOM_BOX, halfExtents=half, physicsClientId=client
        )
        below = [0, 0, ground.height - GROUND_DEPTH / 2]
        index = bullet.createMultiBody(0, slab, -1, below, physicsClientId=client)
        bullet.changeDynamics(
            index, -1, lateralFriction=ground.surface.friction, physicsClientId=client
        )
        return int(index)

    def _loading(self) -> str:
        names = [body.name for body in self._plan.bodies]
        names += [planned.thing.name for planned in self._plan.things]
        return names[min(len(self.bodies) + len(self.things), len(names) - 1)]


def _engine() -> Any:
    try:
        import pybullet
    except ImportError as error:
        raise EngineMissing(
            "the engine, PyBullet, is not installed for this Python "
            f"({sys.version_info.major}.{sys.version_info.minor}); "
            "build and check work without it"
        ) from error
    return pybullet
