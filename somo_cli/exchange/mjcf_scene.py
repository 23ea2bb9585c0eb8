"""Write a whole scene as MJCF: manipulators, objects, ground, contact pairs, motors, sensors."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

from somo_cli.exchange.contact_pairs import (
    PairFriction,
    Touchable,
    near_links,
    touching_pairs,
)
from somo_cli.exchange.mjcf import finished, new_model
from somo_cli.exchange.mjcf_actuators import add_loads, add_motors
from somo_cli.exchange.mjcf_bodies import ChainBodies, add_chain, add_inertial, add_locks
from somo_cli.exchange.mjcf_geoms import add_geoms
from somo_cli.exchange.mjcf_sensors import add_sensors
from somo_cli.exchange.start_state import StartState
from somo_cli.exchange.unwritten import recorded_of
from somo_cli.exchange.xml_text import numbers, pose_attributes
from somo_cli.manipulator.urdf import number
from somo_cli.scene.contact_surface import GROUND_NAME, Ground
from somo_cli.scene.model import Manipulator, Scene
from somo_cli.scene.placement import with_heights
from somo_cli.scene.rigid_object import RigidObject


def render_scene(scene: Scene, name: str, time_step: float) -> str:
    """Return the MJCF of a scene; `unwritten.parts_not_in_mjcf` says what it has not.

    Names are those of columns: `MANIPULATOR.LINK`, `MANIPULATOR.JOINT`, `OBJECT`. The key `start`
    has the state at time zero and the controls of that moment. A prescribed base is free and welded
    to a mocap body `MANIPULATOR.motion`, a prescribed object is a mocap body.
    """
    writer = _Writer(*new_model(name, time_step, scene.gravity, ("0", "0")), time_step)
    if scene.ground is not None:
        writer.add_ground(scene.ground)
    for manipulator in scene.manipulators:
        writer.add_manipulator(manipulator)
    for one in with_heights(scene.objects, scene.ground):
        writer.add_object(one)
    writer.add_contact()
    add_sensors(writer.root, recorded_of(scene))
    writer.state.add_key(writer.root)
    comment = "SI units; the control of a motor is N m in every joint of its axis"
    return finished(writer.root, f"{name}: {comment}, that of a load its factor")


@dataclass(slots=True)
class _Writer:
    """Collects the model, what can touch in it, and its state at the start."""

    root: ET.Element
    world: ET.Element
    assets: ET.Element
    time_step: float
    parts: list[Touchable] = field(default_factory=list)
    state: StartState = field(default_factory=StartState)

    def add_ground(self, ground: Ground) -> None:
        """Add the ground, an endless plane."""
        ET.SubElement(
            self.world,
            "geom",
            name=GROUND_NAME,
            type="plane",
            size="0 0 1",
            pos=numbers((0.0, 0.0, ground.height)),
            rgba="0.8 0.8 0.8 1",
        )
        self.parts.append(Touchable(GROUND_NAME, 0, (GROUND_NAME,), ground.surface, is_held=True))

    def add_manipulator(self, one: Manipulator) -> None:
        """Add the bodies of a manipulator, its motors and its loads."""
        chain, prefix = one.compiled.chain, f"{one.name}."
        is_free = one.base == "free" or one.motion is not None
        bodies = add_chain(
            self.world, self.assets, chain, prefix, one.pose, time_step=self.time_step
        )
        if is_free:
            joint = ET.Element("freejoint", name=f"{prefix}base_joint")
            bodies.bodies[0].insert(0, joint)
        if one.motion is not None:
            self._add_motion(one, bodies.bodies[0].attrib["name"])
        add_locks(self.root, chain, self.time_step, prefix)
        add_motors(self.root, chain, prefix)
        add_loads(self.root, self.world, bodies.bodies, one.loads, prefix)
        self.state.add_manipulator(one, is_free)
        self._add_touchable(one, bodies)

    def _add_motion(self, one: Manipulator, base: str) -> None:
        """Weld a free base to a body that the user moves."""
        name = f"{one.name}.motion"
        attributes = pose_attributes(one.pose.position, one.pose.rotation)
        ET.SubElement(self.world, "body", name=name, mocap="true", attrib=attributes)
        equality = self.root.find("equality")
        equality = ET.SubElement(self.root, "equality") if equality is None else equality
        ET.SubElement(equality, "weld", name=name, body1=name, body2=base)

    def _add_touchable(self, one: Manipulator, bodies: ChainBodies) -> None:
        chain = one.compiled.chain
        everything = frozenset(range(len(chain.links)))
        near = near_links(chain) if one.has_self_collision else [everything] * len(chain.links)
        for link, geoms in enumerate(bodies.geoms):
            is_held = link == 0 and one.base != "free"
            surface = one.surfaces.of_link(link, chain)
            self.parts.append(Touchable(one.name, link, geoms, surface, is_held, near[link]))

    def add_object(self, one: RigidObject) -> None:
        """Add an object: a body that is fixed, free, or moved by the user as a mocap body."""
        (link,) = one.chain.links
        body = ET.SubElement(self.world, "body", name=one.name)
        body.attrib.update(pose_attributes(one.pose.position, one.pose.rotation))
        if one.motion is not None:
            body.set("mocap", "true")
        elif not one.is_fixed:
            ET.SubElement(body, "freejoint", name=f"{one.name}.joint")
            self.state.add_object(one)
        add_inertial(body, link.inertial)
        geoms = add_geoms(body, self.assets, link, one.name)
        if one.collides:
            self.parts.append(Touchable(one.name, 0, geoms, one.surface, one.has_prescribed_pose))

    def add_contact(self) -> None:
        """Add a pair for each two geoms that a run lets touch, with the product of frictions."""
        section = ET.SubElement(self.root, "contact")
        for a, b in touching_pairs(self.parts):
            friction = _friction_attributes(PairFriction.of(a.surface, b.surface))
            for geom in a.geoms:
                for other in b.geoms:
                    ET.SubElement(section, "pair", geom1=geom, geom2=other, attrib=friction)


def _friction_attributes(friction: PairFriction) -> dict[str, str]:
    """Return `condim` and `friction` of a pair: two sliding, one spinning, two rolling."""
    if friction.sliding == 0 and friction.spinning == friction.rolling == 0:
        return {"condim": "1"}
    condim = "6" if friction.rolling else "4" if friction.spinning else "3"
    slide, spin, roll = map(number, (friction.sliding, friction.spinning, friction.rolling))
    return {"condim": condim, "friction": f"{slide} {slide} {spin} {roll} {roll}"}
