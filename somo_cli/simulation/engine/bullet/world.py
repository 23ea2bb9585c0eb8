"""The world on headless PyBullet; with `bullet_*` beside it, all of the simulation that knows it.

Facts about PyBullet 3.2.7 that the code below depends on stand beside the lines they explain.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

from somo_cli.manipulator.geometry import Matrix
from somo_cli.problems import EngineRefused
from somo_cli.scene.contact_surface import ContactSurface, Ground
from somo_cli.simulation.engine.bullet import collision_filter, contact_parameters
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.c_stdio import (
    captured_output,
    decimal_points,
    duplicate,
    flush_c,
)
from somo_cli.simulation.engine.bullet.client import engine
from somo_cli.simulation.engine.bullet.friction_adapter import BulletGrip, Skin
from somo_cli.simulation.engine.bullet.kinematic import MovedBody, MovedThing
from somo_cli.simulation.engine.bullet.rigid_object import BulletThing
from somo_cli.simulation.engine.contacts import Place, Touch, rub
from somo_cli.simulation.plan.model import Plan

GROUND_REACH = 1000.0  # engine units, from the origin
GROUND_DEPTH = 20.0  # engine units: what falls faster than this in a step passes through


class BulletWorld:
    """A plan loaded into an engine of its own: bodies in the order of the plan."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._bullet: Any = None
        self._client = -1
        self._start = -1  # the engine's number of the state after loading
        self._stdout: int | None = None
        self.bodies: list[BulletBody] = []
        self.objects: list[BulletThing] = []
        self._numbers: dict[int, int] = {}
        self.step: Callable[[], object] = self._refuse
        self._places: dict[tuple[int, int], Place] = {}  # of the engine's bodies and links
        self._grounds: list[int] = []
        self._points = 0  # of contact, when last looked at
        self._iterations = collision_filter.ITERATIONS
        self._grip: BulletGrip | None = None  # where friction depends on the direction

    def __enter__(self) -> BulletWorld:
        """Load every body; until `close`, what the engine prints goes to standard error."""
        with captured_output() as said, decimal_points():
            self._bullet = engine()
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

    def touches(self) -> list[Touch]:
        """Return every contact point of the last step, in the engine's order, then what is ours."""
        # seen in 3.2.7: asked for one body, the engine turns the normals of those contacts in which
        # that body is the second one, and not the forces of friction; asked for all it turns none
        told = self._bullet.getContactPoints(physicsClientId=self._client)
        places = self._places
        found = [
            Touch(
                places[one[1], one[3]],
                places[one[2], one[4]],
                one[5],
                one[7],
                one[9],
                ((one[11], one[10]), (one[13], one[12])),
            )
            for one in told
        ]
        if self._grip is not None:
            for key, point, force in self._grip.rubs:
                found.append(rub(places[key[:2]], places[key[2:]], point, force))
        return found

    def penetrations(self) -> list[tuple[Place, Place, float]]:
        """Return which parts were how deep in each other in the last step; depths above 0 only."""
        places = self._places
        told = self._bullet.getContactPoints(physicsClientId=self._client)
        self._points = len(told)
        return [
            (places[one[1], one[3]], places[one[2], one[4]], -gap)
            for one in told
            if (gap := one[8]) < 0
        ]

    def heed_contacts(self) -> None:
        """Let the solver take as many iterations as pay with what `penetrations` saw last."""
        iterations = collision_filter.iterations(self._points)
        if iterations != self._iterations:
            self._iterations = iterations
            self._bullet.setPhysicsEngineParameter(
                numSolverIterations=iterations, physicsClientId=self._client
            )

    def depths(self) -> dict[tuple[int, int], float]:
        """Return how deep parts of the scene are in each other [engine units], where they are.

        Parts are counted: bodies, objects, ground. A world that was asked is not to be run.
        """
        order = [body.index for body in self.bodies]
        order += [thing.index for thing in self.objects]
        return collision_filter.depths(self._bullet, self._client, order + self._grounds)

    def save_start(self) -> None:
        """Keep the present state, right after loading, for `restore_start`."""
        self._start = self._bullet.saveState(self._client)

    def restore_start(self) -> None:
        """Go back to the state that was kept.

        Seen in 3.2.7: what depends on contacts of the past is not part of it, so this is for
        worlds in which nothing can touch.
        """
        self._bullet.restoreState(self._start, physicsClientId=self._client)

    @staticmethod
    def _refuse() -> None:
        raise RuntimeError("the world is entered before it is stepped")

    def _set_up(self) -> None:
        # advances every body by one time step; torques last for one step
        self.step = partial(self._bullet.stepSimulation, self._client)
        # the cache would serve an old file under a known name, even after a reset; the solver would
        # be content with 50 iterations, or with an error of 3e-4 engine units per second, which to
        # the constraints, contacts and dry friction of a small body is as good as any; so it goes
        # on for as many as a step's contacts need
        self._bullet.setPhysicsEngineParameter(
            enableFileCaching=0,
            fixedTimeStep=self._plan.time_step,
            numSolverIterations=self._iterations,
            solverResidualThreshold=collision_filter.residual(self._plan),
            physicsClientId=self._client,
        )
        self._bullet.setPhysicsEngineParameter(
            **contact_parameters.contact_parameters(self._plan), physicsClientId=self._client
        )
        self._bullet.setGravity(*self._plan.gravity, physicsClientId=self._client)
        with tempfile.TemporaryDirectory(prefix="somo-") as folder:
            for number, body in enumerate(self._plan.bodies):
                path = Path(folder) / f"{number}.urdf"
                path.write_text(body.urdf, encoding="utf-8")
                kind = BulletBody if body.path is None else MovedBody
                self.bodies.append(
                    kind(self._bullet, self._client, body, self._plan.gravity, str(path))
                )

            for number, thing in enumerate(self._plan.objects):
                path = Path(folder) / f"object_{number}.urdf"
                if thing.urdf:
                    path.write_text(thing.urdf, encoding="utf-8")
                of_thing = BulletThing if thing.path is None else MovedThing
                self.objects.append(of_thing(self._bullet, self._client, thing, str(path)))
        ground = None if self._plan.ground is None else self._lay_ground(self._plan.ground)
        self._grounds = [] if ground is None else [ground]
        self._spare_held()
        self._number_places()
        if any(surface.friction_anisotropy is not None for surface in self._plan.surfaces):
            self.step = self._gripping(self.step, ground)

    def _number_places(self) -> None:
        for number, body in enumerate(self.bodies):
            for place, link in enumerate(body.links):
                self._places[body.index, link] = (number, place)
        others = [thing.index for thing in self.objects] + self._grounds
        for number, index in enumerate(others, start=len(self.bodies)):
            for link in range(-1, self._bullet.getNumJoints(index, self._client)):
                self._places[index, link] = (number, 0)

    def _spare_held(self) -> None:
        bases: dict[str, list[int]] = {"constrained": [], "static": [], "free": []}
        for body, planned in zip(self.bodies, self._plan.bodies, strict=True):
            bases[planned.base].append(body.index)
        held = self._grounds + bases["constrained"] + bases["static"]
        for thing, of_plan in zip(self.objects, self._plan.objects, strict=True):
            if of_plan.thing.has_prescribed_pose:
                held.append(thing.index)
        collision_filter.spare_held(self._bullet, self._client, bases["constrained"], held)
        if not (self._plan.can_touch or self._plan.keeps_everything):
            for body in self.bodies:
                collision_filter.spare_all(self._bullet, self._client, body.index, body.links)

    def _gripping(self, step: Callable[[], object], ground: int | None) -> Callable[[], object]:
        """Return a step before which friction that depends on the direction is applied."""
        found: list[tuple[int, int, ContactSurface, Matrix | None]] = []
        for body, planned in zip(self.bodies, self._plan.bodies, strict=True):
            found += [
                (body.index, link, planned.surfaces.of_link(number, planned.chain), None)
                for number, link in enumerate(body.links)
            ]
        for thing, of_thing in zip(self.objects, self._plan.objects, strict=True):
            found.append((thing.index, -1, of_thing.thing.surface, thing.axes))
        if ground is not None and self._plan.ground is not None:
            found.append((ground, -1, self._plan.ground.surface, None))
        skins = [Skin.of(self._bullet, self._client, *one) for one in found]
        self._grip = BulletGrip(self._bullet, self._client, self._plan.time_step, skins)
        act = self._grip.act

        def step_with_grip() -> None:
            act()
            step()

        return step_with_grip

    def _lay_ground(self, ground: Ground) -> int:
        # seen in 3.2.7: on a plane (GEOM_PLANE) a sliding box stands on one or two points and
        # sinks in by millimetres, on a large box on four
        bullet, client = self._bullet, self._client
        half = [GROUND_REACH, GROUND_REACH, GROUND_DEPTH / 2]
        slab = bullet.createCollisionShape(
            bullet.GEOM_BOX, halfExtents=half, physicsClientId=client
        )
        below = [0, 0, ground.height - GROUND_DEPTH / 2]
        index: int = bullet.createMultiBody(0, slab, -1, below, physicsClientId=client)
        bullet.changeDynamics(
            index, -1, **contact_parameters.settings(ground.surface), physicsClientId=client
        )
        return index

    def _loading(self) -> str:
        names = [body.name for body in self._plan.bodies]
        names += [planned.thing.name for planned in self._plan.objects]
        return names[min(len(self.bodies) + len(self.objects), len(names) - 1)]
