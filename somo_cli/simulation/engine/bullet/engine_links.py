"""Links in PyBullet between two steps: read how they move, and apply forces for the next step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.last_contacts import EngineLinkId


class LinkState(NamedTuple):
    """Centre of mass, principal axes, velocity and angular velocity of a link, in the world."""

    centre: Vector
    quaternion: tuple[float, float, float, float]
    velocity: Vector
    spin: Vector

    @property
    def axes(self) -> Matrix:
        """The principal axes, as columns."""
        return geometry.rotation_from_quaternion(self.quaternion)


class EngineLinks:
    """Every link of an engine; its readers are bound once, because they are called often."""

    def __init__(self, engine: BulletClient) -> None:
        self.engine = engine
        self._readers: dict[tuple[EngineLinkId, bool], Callable[[], LinkState]] = {}

    def state(self, place: EngineLinkId) -> LinkState:
        """Return the present motion of a link."""
        return self._read(place, True)

    def state_at_contact(self, place: EngineLinkId, time_step: float) -> LinkState:
        """Return where a link was when the contact points of the last step were found.

        Its velocities are those of the end of the step. The axes of a base are those of the end as
        well; see `axes_at_contact`.
        """
        # without new kinematics the pose of a link is the one at the start of the step
        centre, turn, velocity, spin = found = self._read(place, False)
        if place[1] >= 0:
            return found
        (x, y, z), (vx, vy, vz) = centre, velocity
        before = (x - time_step * vx, y - time_step * vy, z - time_step * vz)
        return LinkState(before, turn, velocity, spin)

    def apply_force(
        self, place: EngineLinkId, force: Sequence[float], point: Sequence[float]
    ) -> None:
        """Apply a force at a point during the next step, both in the world."""
        engine, module = self.engine, self.engine.module
        module.applyExternalForce(*place, force, point, module.WORLD_FRAME, engine.number)

    def apply_torque(self, place: EngineLinkId, torque: Sequence[float]) -> None:
        """Apply a torque during the next step, in the world."""
        engine, module = self.engine, self.engine.module
        module.applyExternalTorque(*place, torque, module.WORLD_FRAME, engine.number)

    def mass_and_moments(self, place: EngineLinkId) -> tuple[float, Vector]:
        """Return the mass and the principal moments of inertia of a link; 0 if it cannot move."""
        reported = self.engine.getDynamicsInfo(*place)
        return reported[0], reported[2]

    def _read(self, place: EngineLinkId, is_fresh: bool) -> LinkState:
        read = self._readers.get((place, is_fresh))
        if read is None:
            read = self._readers[place, is_fresh] = self._reader(place, is_fresh)
        return read()

    def _reader(self, place: EngineLinkId, is_fresh: bool) -> Callable[[], LinkState]:
        """Return the function that reads one link; `is_fresh` after kinematics of the present."""
        module, number, (body, link) = self.engine.module, self.engine.number, place
        if link < 0:
            pose = partial(module.getBasePositionAndOrientation, body, number)
            velocities = partial(module.getBaseVelocity, body, number)
            return lambda: LinkState(*pose(), *velocities())
        state = partial(module.getLinkState, body, link, 1, int(is_fresh), number)

        def read() -> LinkState:
            found = state()
            return LinkState(found[0], found[1], found[6], found[7])

        return read


def axes_at_contact(place: EngineLinkId, state: LinkState, time_step: float) -> Matrix:
    """Return the axes that a link had when the contact points of the last step were found."""
    rate = geometry.norm(state.spin)
    if place[1] >= 0 or rate == 0:
        return state.axes
    turned_back = geometry.rotation_about(geometry.unit(state.spin), -time_step * rate)
    return geometry.multiply(turned_back, state.axes)
