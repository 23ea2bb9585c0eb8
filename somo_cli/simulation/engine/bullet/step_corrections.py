"""Corrections of contact that are applied before each step, beside the torques of the law."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.contact_surface import ContactSurface
from somo_cli.scene.round_body import RoundBody, round_body_of
from somo_cli.simulation.engine.bullet import contact_parameters
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.engine_links import EngineLinks
from somo_cli.simulation.engine.bullet.friction_adapter import FrictionAdapter, FrictionLink
from somo_cli.simulation.engine.bullet.last_contacts import ContactKey, EngineContact, LastContacts
from somo_cli.simulation.engine.bullet.rigid_object import BulletObject
from somo_cli.simulation.engine.bullet.rolling_adapter import RollingAdapter
from somo_cli.simulation.engine.bullet.sliding_adapter import SlidingAdapter
from somo_cli.simulation.plan.model import Plan

SurfaceOfLink = tuple[int, int, ContactSurface, Matrix | None]
"""Body and link of the engine, its surface, and its axes if the engine does not know them."""

AppliedFriction = tuple[ContactKey, Sequence[float], Sequence[float]]
"""The two links, the point, and the force on the first."""


class StepCorrections:
    """The corrections that a loaded plan needs; None for those that it does not.

    `anisotropic` applies friction that depends on the direction, `sliding` corrects the direction
    of all other friction, `rolling` the point where round bodies stand on soft ground.
    """

    def __init__(
        self,
        engine: BulletClient,
        contacts: LastContacts,
        plan: Plan,
        bodies: Sequence[BulletBody],
        objects: Sequence[BulletObject],
        ground: int | None,
    ) -> None:
        self._engine, self._plan = engine, plan
        self._bodies, self._objects, self._ground = bodies, objects, ground
        self._contacts, links = contacts, EngineLinks(engine)
        surfaces = list(self._surfaces())
        self.anisotropic: FrictionAdapter | None = None
        self.sliding: SlidingAdapter | None = None
        self.rolling: RollingAdapter | None = None
        if any(surface.friction_anisotropy is not None for _, _, surface, _ in surfaces):
            of_surfaces = [FrictionLink.of(engine, *one) for one in surfaces]
            self.anisotropic = FrictionAdapter(links, plan.time_step, of_surfaces)
        if plan.can_touch:
            frictions = {
                (body, link): contact_parameters.surface_settings(surface)["lateralFriction"]
                for body, link, surface, _ in surfaces
            }
            self.sliding = SlidingAdapter(links, contacts, plan.time_step, frictions)
        if ground is not None and contact_parameters.has_soft_ground(plan):
            rounds = dict(self._rounds())
            self.rolling = RollingAdapter(links, contacts, plan.time_step, ground, rounds)

    def before(self, step: Callable[[], object]) -> Callable[[], object]:
        """Return a function that applies the corrections and then steps the engine.

        The contacts that they read are those of the step before.
        """
        contacts = self._contacts
        corrections = (self.rolling, self.sliding, self.anisotropic)
        applies = [one.apply for one in corrections if one is not None]

        def step_corrected() -> None:
            for apply in applies:
                apply()
            contacts.clear()
            step()

        return step_corrected if applies else step

    @property
    def applied(self) -> Sequence[AppliedFriction]:
        """The friction forces that were applied for the last step."""
        return [
            force
            for one in (self.anisotropic, self.sliding)
            if one is not None
            for force in one.applied
        ]

    def check(self, reported: Sequence[EngineContact]) -> None:
        """Check the contacts of the last step for sliding."""
        if self.sliding is not None:
            self.sliding.check(reported)

    def _surfaces(self) -> Iterator[SurfaceOfLink]:
        for body, planned in zip(self._bodies, self._plan.bodies, strict=True):
            for number, link in enumerate(body.links):
                yield body.index, link, planned.surfaces.of_link(number, planned.chain), None
        for rigid_object, of_object in zip(self._objects, self._plan.objects, strict=True):
            yield rigid_object.index, -1, of_object.rigid_object.surface, rigid_object.axes
        if self._ground is not None and self._plan.ground is not None:
            yield self._ground, -1, self._plan.ground.surface, None

    def _rounds(self) -> Iterator[tuple[tuple[int, int], RoundBody]]:
        """Yield the round links by body and link of the engine, in their inertial frames."""
        for body, planned in zip(self._bodies, self._plan.bodies, strict=True):
            for number, link in zip(body.links, planned.chain.links, strict=True):
                found = round_body_of(link)
                if found is not None:
                    reported = self._engine.getDynamicsInfo(body.index, number)
                    axes = geometry.rotation_from_quaternion(reported[4])
                    yield (body.index, number), found.seen_from(reported[3], axes)
        for rigid_object, of_object in zip(self._objects, self._plan.objects, strict=True):
            found = round_body_of(of_object.rigid_object.chain.links[0])
            if found is not None:
                frame = rigid_object.to_engine(Pose())
                yield (rigid_object.index, -1), found.seen_from(frame.position, frame.rotation)
