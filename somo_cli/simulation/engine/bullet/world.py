"""The world on headless PyBullet: loads a plan, steps it, and reports its contacts.

Facts about PyBullet 3.2.7 that the code below depends on stand beside the lines they explain.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import TracebackType

from somo_cli.problems import EngineRefused
from somo_cli.scene.contact_surface import Ground
from somo_cli.simulation.engine.bullet import collision_filter, contact_parameters
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.c_stdio import captured_output, decimal_points
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.contact_reader import BulletContactReader
from somo_cli.simulation.engine.bullet.contact_report import ContactReport
from somo_cli.simulation.engine.bullet.kinematic import KinematicObject, PrescribedBody
from somo_cli.simulation.engine.bullet.last_contacts import EngineLinkId, LastContacts
from somo_cli.simulation.engine.bullet.rigid_object import BulletObject
from somo_cli.simulation.engine.bullet.step_corrections import StepCorrections
from somo_cli.simulation.engine.contacts import BodyPair, ContactPoint, LinkIndex
from somo_cli.simulation.plan.model import Plan

GROUND_HALF_WIDTH = 1000.0  # engine units, from the origin
GROUND_THICKNESS = 20.0  # engine units: what falls faster than this in a step passes through


class BulletWorld:
    """A plan loaded into an engine of its own: bodies in the order of the plan."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._contact_gap = contact_parameters.contact_parameters(plan)["contactBreakingThreshold"]
        self._client: BulletClient | None = None
        self.contacts: LastContacts
        self._start = -1  # the engine's number of the state after loading
        self.bodies: list[BulletBody] = []
        self.objects: list[BulletObject] = []
        self.step: Callable[[], object] = self._raise_not_entered
        self._report: ContactReport
        self._ground_indices: list[int] = []
        self._iterations = collision_filter.MAX_ITERATIONS

    def __enter__(self) -> BulletWorld:
        """Load every body; if the engine refuses one, the error has what the engine printed."""
        with captured_output() as printed, decimal_points():
            self._client = BulletClient()
            self.contacts = LastContacts(self._client, self._plan.can_touch)
            try:
                self._load_plan()
            except self.engine.error as error:
                self.close()
                raise EngineRefused(
                    self._body_being_loaded(), f"{error} {printed()}".strip()
                ) from error
            except BaseException:
                self.close()
                raise
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Free the engine; the world cannot be stepped any more."""
        if self._client is not None:
            self._client.close()

    @property
    def engine(self) -> BulletClient:
        """The engine, once the world was entered."""
        assert self._client is not None, "the world is entered first"
        return self._client

    def contact_points(self) -> list[ContactPoint]:
        """Return the contact points of the last step: the engine's, then our friction."""
        return self._report.contact_points()

    def penetrations(self) -> list[tuple[LinkIndex, LinkIndex, float]]:
        """Return each pair of links that overlapped in the last step, and its depth, above 0."""
        return self._report.penetrations()

    def normal_forces(self) -> dict[BodyPair, float]:
        """Return the sum of normal forces of each pair of bodies that pressed in the last step."""
        return self._report.normal_forces()

    def contact_reader(self) -> BulletContactReader:
        """Return the reader of the contact points that press."""
        return BulletContactReader(self.engine, self.contacts, self._plan, self._report.places)

    def adapt_solver_iterations(self) -> None:
        """Choose the solver's iterations for the contacts that `penetrations` saw last."""
        iterations = collision_filter.iteration_limit(self._report.count)
        if iterations != self._iterations:
            self._iterations = iterations
            self.engine.setPhysicsEngineParameter(numSolverIterations=iterations)

    def depths(self) -> dict[tuple[int, int], float]:
        """Return the depths [engine units] of overlaps of the scene's parts at their present poses.

        Parts are numbered: bodies, objects, ground. Do not step the world afterwards.
        """
        order = [body.index for body in self.bodies]
        order += [rigid_object.index for rigid_object in self.objects]
        with captured_output():  # nothing is stepped yet, as while loading
            return collision_filter.depths(self.engine, order + self._ground_indices)

    def claim_engine(self) -> None:
        """Set the parameters that all engines of a process share, in case another changed them.

        Seen in 3.2.7: they share contactBreakingThreshold. Without contact it has no effect.
        """
        if not (self._plan.can_touch or self._plan.keeps_unused):
            return
        self.engine.setPhysicsEngineParameter(contactBreakingThreshold=self._contact_gap)

    def save_start(self) -> None:
        """Keep the present state, right after loading, for `restore_start`."""
        self._start = self.engine.saveState()

    def restore_start(self) -> None:
        """Restore the state that `save_start` saved.

        Seen in 3.2.7: the state lacks the history of contacts, so use this only for worlds in which
        nothing can touch.
        """
        self.engine.restoreState(self._start)

    @staticmethod
    def _raise_not_entered() -> None:
        raise RuntimeError("the world is entered before it is stepped")

    def _load_plan(self) -> None:
        # advances every body by one time step; torques last for one step
        self.step = partial(self.engine.module.stepSimulation, self.engine.number)
        # The file cache would return an old file under a known name, even after a reset. By default
        # the solver stops after 50 iterations, or at a residual of 3e-4 engine units per second,
        # which is too coarse for the constraints, contacts and dry friction of a small body. So it
        # iterates for as long as the contacts of a step need.
        self.engine.setPhysicsEngineParameter(
            enableFileCaching=0,
            fixedTimeStep=self._plan.time_step,
            numSolverIterations=self._iterations,
            solverResidualThreshold=collision_filter.squared_residual_speed(self._plan),
        )
        self.engine.setPhysicsEngineParameter(**contact_parameters.contact_parameters(self._plan))
        self.engine.setGravity(*self._plan.gravity)
        with tempfile.TemporaryDirectory(prefix="somo-") as folder:
            for number, body in enumerate(self._plan.bodies):
                path = Path(folder) / f"{number}.urdf"
                path.write_text(body.urdf, encoding="utf-8")
                kind = BulletBody if body.path is None else PrescribedBody
                self.bodies.append(kind(self.engine, body, self._plan.gravity, str(path)))

            for number, rigid_object in enumerate(self._plan.objects):
                path = Path(folder) / f"object_{number}.urdf"
                if rigid_object.urdf:
                    path.write_text(rigid_object.urdf, encoding="utf-8")
                of_object = BulletObject if rigid_object.path is None else KinematicObject
                self.objects.append(of_object(self.engine, rigid_object, str(path)))
        ground = None if self._plan.ground is None else self._add_ground(self._plan.ground)
        self._ground_indices = [] if ground is None else [ground]
        self._disable_fixed_collisions()
        corrections = StepCorrections(
            self.engine, self.contacts, self._plan, self.bodies, self.objects, ground
        )
        self.step = corrections.before(self.step)
        self._report = ContactReport(self.contacts, corrections, dict(self._places()))

    def _places(self) -> Iterator[tuple[EngineLinkId, LinkIndex]]:
        """Yield the number of every link in the engine, and that in the plan."""
        for number, body in enumerate(self.bodies):
            for place, link in enumerate(body.links):
                yield (body.index, link), (number, place)
        others = [rigid_object.index for rigid_object in self.objects] + self._ground_indices
        for number, index in enumerate(others, start=len(self.bodies)):
            for link in range(-1, self.engine.getNumJoints(index)):
                yield (index, link), (number, 0)

    def _disable_fixed_collisions(self) -> None:
        bases: dict[str, list[int]] = {"constrained": [], "static": [], "free": []}
        for body, planned in zip(self.bodies, self._plan.bodies, strict=True):
            bases[planned.base].append(body.index)
        held = self._ground_indices + bases["constrained"] + bases["static"]
        for rigid_object, of_object in zip(self.objects, self._plan.objects, strict=True):
            if of_object.rigid_object.has_prescribed_pose:
                held.append(rigid_object.index)
        collision_filter.disable_fixed_collisions(self.engine, bases["constrained"], held)
        if not (self._plan.can_touch or self._plan.keeps_unused):
            for body in self.bodies:
                collision_filter.disable_collisions(self.engine, body.index, body.links)

    def _add_ground(self, ground: Ground) -> int:
        # seen in 3.2.7: on a plane (GEOM_PLANE) a sliding box stands on one or two points and
        # sinks in by millimetres, on a large box on four
        engine = self.engine
        half = [GROUND_HALF_WIDTH, GROUND_HALF_WIDTH, GROUND_THICKNESS / 2]
        slab = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half)
        below = [0, 0, ground.height - GROUND_THICKNESS / 2]
        index: int = engine.createMultiBody(0, slab, -1, below)
        engine.changeDynamics(index, -1, **contact_parameters.surface_settings(ground.surface))
        return index

    def _body_being_loaded(self) -> str:
        names = [body.name for body in self._plan.bodies]
        names += [planned.rigid_object.name for planned in self._plan.objects]
        return names[min(len(self.bodies) + len(self.objects), len(names) - 1)]
