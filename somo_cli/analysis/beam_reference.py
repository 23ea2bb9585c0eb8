"""A cantilever in closed form, and how far the tip of a chain is from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from somo_cli.analysis.reference import Reference
from somo_cli.analysis.reference_scene import TOLERANCE, ReferenceMismatch, single_manipulator
from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.scene import columns
from somo_cli.scene.model import ExternalLoad, Manipulator, Scene
from somo_cli.simulation.plan.build import make_plan

if TYPE_CHECKING:
    from somo_cli.analysis import closed_forms

CONTINUUM = ("cantilever_tip_load", "elastica", "end_moment", "own_weight")


@dataclass(frozen=True, slots=True)
class BeamTip:
    """The distance of the tip at the end from that of the beam [m], and the error of it [m]."""

    distance: float
    error: float


@dataclass(frozen=True, slots=True)
class _Beam:
    """A cantilever: its clamp [m], unit vectors along and across it in the world, and its EI."""

    clamp: Array
    along: Array
    across: Array
    length: float  # m
    rigidity: float  # N·m²

    def tip_position(self, tip: closed_forms.Tip) -> Array:
        position: Array = self.clamp + self.length * (tip[0] * self.along + tip[1] * self.across)
        return position


def beam_tip(scene: Scene, reference: Reference) -> BeamTip:
    """Return the distance of the chain's tip at the end of the run from that of the named beam [m].

    Its error is the sum of those of the closed form and of the reference, and of how far the tip
    still moved in the last tenth of the time.
    """
    beam, tip, own_error = beam_and_closed_form_tip(scene)
    (group,) = (
        one
        for one in columns.body_column_groups(make_plan(scene).recorded)
        if one.quantity == "tip_position"
    )
    tips = reference.rows[:, group.first : group.last]
    last = tips[-max(2, len(tips) // 10) :]
    moved = float(np.linalg.norm(last - last[-1], axis=1).max())
    distance = float(np.linalg.norm(tips[-1] - beam.tip_position(tip)))
    return BeamTip(distance, own_error + moved + reference.final_error["tip_position"])


def beam_and_closed_form_tip(scene: Scene) -> tuple[_Beam, closed_forms.Tip, float]:
    """Return the beam, its closed-form tip in lengths, and the error of the closed form [m].

    Raises ReferenceMismatch for a scene that the closed form does not describe.
    """
    from somo_cli.analysis import closed_forms  # needs scipy, which is slow to import

    one = single_manipulator(scene)
    beam = _beam(one)
    unit = beam.rigidity / beam.length**2  # N
    if scene.reference == "own_weight":
        if one.loads or one.actuation:
            raise ReferenceMismatch("it is about a beam under its own weight alone")
        return beam, closed_forms.own_weight(_weight(scene, one, beam) / unit), 0.0
    if any(scene.gravity):
        raise ReferenceMismatch("it is about a beam without weight: set gravity: [0, 0, 0]")
    if scene.reference == "end_moment":
        moment = _moment(one, beam)
        return beam, closed_forms.end_moment(moment / (unit * beam.length)), 0.0
    load = _tip_force(one, beam) / unit
    tip = closed_forms.tip_load(load)
    if scene.reference == "elastica":
        return beam, tip, 0.0
    small = closed_forms.small_tip_load(load)
    return beam, small, beam.length * math.dist(small, tip)


def _beam(one: Manipulator) -> _Beam:
    chain = one.compiled.chain
    joints = chain.joints
    first = joints[0]
    rigidities = [joint.stiffness * joint.span for joint in joints]
    if not np.allclose([joint.axis for joint in joints], first.axis, atol=TOLERANCE):
        raise ReferenceMismatch("it is about joints with one and the same axis")
    if not np.allclose(rigidities, rigidities[0], rtol=TOLERANCE, atol=0):
        raise ReferenceMismatch("it is about joints of one and the same stiffness per length")
    if any(joint.neutral_position for joint in joints):
        raise ReferenceMismatch("it is about a beam that is straight at rest")
    if rigidities[0] <= 0:
        raise ReferenceMismatch("it is about joints with springs")
    length = sum(joint.span for joint in joints)
    rotation = np.array(geometry.rotation_from_rpy(one.rpy))
    clamp = np.array(one.position) + rotation @ (0.0, 0.0, chain.length - length)
    along = rotation @ (0.0, 0.0, 1.0)
    across = np.cross(rotation @ first.axis, along)
    if abs(first.axis[2]) > TOLERANCE:
        raise ReferenceMismatch("it is about joints that bend, not twist")
    return _Beam(clamp, along, across, length, rigidities[0])


def _weight(scene: Scene, one: Manipulator, beam: _Beam) -> float:
    """Return the weight of the beam, w L, along its transverse axis [N]."""
    definition = one.compiled.definition
    if definition.tips:
        raise ReferenceMismatch("it is about a beam without a tip body")
    gravity = np.array(scene.gravity)
    sideways = float(gravity @ beam.across)
    if np.linalg.norm(gravity - sideways * beam.across) > TOLERANCE * np.linalg.norm(gravity):
        raise ReferenceMismatch("it is about gravity across the beam, in its plane of bending")
    if any(actuator.taper != 1 for actuator in definition.actuators):
        raise ReferenceMismatch("it is about a beam without a taper")
    densities = [actuator.link.mass / actuator.link.height for actuator in definition.actuators]
    if not np.allclose(densities, densities[0], rtol=TOLERANCE):
        raise ReferenceMismatch("it is about a beam of one mass per length")
    return densities[0] * beam.length * sideways


def _tip_force(one: Manipulator, beam: _Beam) -> float:
    """Return the only load, a force on the tip, along the beam's transverse axis [N]."""
    if one.actuation:
        raise ReferenceMismatch("it is about a load on the tip alone, without actuation")
    load = _single_load(one)
    at_tip = math.dist(load.point, one.compiled.chain.tip) <= TOLERANCE * beam.length
    if load.link != len(one.compiled.chain.joints) or not at_tip:
        raise ReferenceMismatch("it is about a force on the tip")
    if any(load.moment) or load.frame != "world":
        raise ReferenceMismatch("it is about a force that keeps its direction, without a moment")
    force = load.waypoints[-1][1] * np.array(load.force)
    return _component(force, beam.across, "a force across the beam, in its plane of bending")


def _moment(one: Manipulator, beam: _Beam) -> float:
    """Return the moment in every joint [N·m], from a load on the tip or from the actuation."""
    axis = np.cross(beam.along, beam.across)
    if one.loads:
        load = _single_load(one)
        if one.actuation or any(load.force) or load.link != len(one.compiled.chain.joints):
            raise ReferenceMismatch("it is about one moment, on the last link")
        moment = load.waypoints[-1][1] * np.array(load.moment)
        return _component(moment, axis, "a moment about the axis of the joints")
    torques = {entry.actuator: entry.profile.final_value for entry in one.actuation}
    moments = {torques.get(joint.actuator, 0.0) for joint in one.compiled.chain.joints}
    if len(moments) != 1 or None in moments:
        raise ReferenceMismatch("it is about one torque in all joints, held at the end")
    return moments.pop() or 0.0


def _single_load(one: Manipulator) -> ExternalLoad:
    if len(one.loads) != 1 or one.loads[0].repeat:
        raise ReferenceMismatch(
            f"it is about one load that is held at the end, not {len(one.loads)}"
        )
    return one.loads[0]


def _component(vector: Array, axis: Array, what: str) -> float:
    value = float(vector @ axis)
    if np.linalg.norm(vector - value * axis) > TOLERANCE * np.linalg.norm(vector):
        raise ReferenceMismatch(f"it is about {what}")
    return value
