"""The closed forms that a scene may name as its `reference`, and whether it is such a scene."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from somo_cli.analysis.reference import Reference
from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.scene import columns
from somo_cli.scene.model import ExternalLoad, Manipulator, Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.plan.model import make_plan
from somo_cli.simulation.plan.units import unit_factors_of

if TYPE_CHECKING:
    from somo_cli.analysis import closed_forms

SINGLE_JOINT = ("pendulum", "damped_oscillator")
CONTINUUM = ("cantilever_tip_load", "elastica", "end_moment", "own_weight")

_TOLERANCE = 1e-9  # relative: what counts as equal, parallel or zero in a scene


class ReferenceMismatch(ValueError):
    """The scene is not what the closed form that it names is about."""


@dataclass(frozen=True, slots=True)
class BeamTip:
    """How far the tip at the end is from that of a beam [m], and how well that is known [m]."""

    distance: float
    error: float


@dataclass(frozen=True, slots=True)
class _Beam:
    """A cantilever: where it is clamped, its axes along and across in the world, and its EI."""

    clamp: Array
    along: Array
    across: Array
    length: float  # m
    rigidity: float  # N·m²

    def tip_position(self, tip: closed_forms.Tip) -> Array:
        position: Array = self.clamp + self.length * (tip[0] * self.along + tip[1] * self.across)
        return position


def check_applicable(scene: Scene) -> None:
    """Raise ReferenceMismatch, saying why, for a scene that its `reference` is not about."""
    if scene.reference in SINGLE_JOINT:
        _joint_motion(scene, np.zeros(1))
    elif scene.reference in CONTINUUM:
        _beam_and_tip(scene)


def with_closed_form(scene: Scene, reference: Reference) -> Reference:
    """Return the reference with the closed form of a single joint in it, if the scene names one.

    Angle and tip then are exact; what else is recorded stays what the steps converge to.
    """
    if scene.reference not in SINGLE_JOINT:
        return reference
    plan = make_plan(scene)
    body = plan.bodies[0]
    chain = ChainDynamics(body.chain)
    rows = reference.rows.copy()
    angles = _joint_motion(scene, rows[:, 0])
    length = unit_factors_of(plan).length
    tips = np.array([chain.at([angle], body.start.pose).tip for angle in angles]) / length
    closed_form_values = {"joint_angles": angles[:, np.newaxis], "tip_position": tips}
    for group in columns.body_column_groups(plan.recorded):
        if group.quantity in closed_form_values:
            rows[:, group.first : group.last] = closed_form_values[group.quantity]
    distance = np.abs(rows - reference.rows).max(axis=0)
    error = dict(reference.error)
    for group in columns.body_column_groups(plan.recorded):
        if group.quantity in closed_form_values:
            part = slice(group.first, group.last)
            error[group.quantity] = _TOLERANCE * float(np.abs(rows[:, part]).max()) * 1e-3
            if distance[part].max() > 100 * reference.error[group.quantity] + 1e-6:
                raise ReferenceMismatch(
                    f"the scene converges to something {distance[part].max():.2g} away from it"
                )
    return dataclasses.replace(reference, rows=rows, error=error, kind=scene.reference)


def beam_tip(scene: Scene, reference: Reference) -> BeamTip:
    """Return how far the chain at the end of the run is from the beam that the scene names.

    What is known is no better than the reference, and no better than the tip is at rest: it
    counts how far the tip moved in the last tenth of the time.
    """
    beam, tip, own_error = _beam_and_tip(scene)
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


def _single_manipulator(scene: Scene) -> Manipulator:
    if len(scene.manipulators) != 1:
        raise ReferenceMismatch(f"it is about one manipulator, not {len(scene.manipulators)}")
    one = scene.manipulators[0]
    if one.compiled.chain.limbs:
        raise ReferenceMismatch("it is about a manipulator by itself, not an assembly")
    if one.base != "static":
        raise ReferenceMismatch(f"it is about a static base, not a {one.base} one")
    return one


def _joint_motion(scene: Scene, times: Array) -> Array:
    """Return the angle of the only joint at times [s]."""
    from somo_cli.analysis import closed_forms  # needs scipy, which is slow to import

    one = _single_manipulator(scene)
    chain = ChainDynamics(one.compiled.chain)
    if chain.count != 1:
        raise ReferenceMismatch(f"it is about a single joint, not {chain.count}")
    if one.loads:
        raise ReferenceMismatch("it is about a joint without external loads")
    if one.compiled.chain.joints[0].friction:
        raise ReferenceMismatch("it is about a joint without dry friction")
    joint = one.compiled.chain.joints[0]
    base = one.pose
    angle, rate = one.initial_angles[0], one.initial_rates[0]
    inertia = float(chain.at([angle], base).joint_inertia()[0, 0])

    def weight(at: float) -> float:
        return float(chain.at([at], base).gravity_force(scene.gravity)[6])

    # a weight's torque on a hinge is a sine of the angle
    most = math.hypot(weight(0.0), weight(math.pi / 2))
    if scene.reference == "damped_oscillator":
        if most > _TOLERANCE * max(1e-12, joint.stiffness):
            raise ReferenceMismatch("it is about a joint that gravity does not turn")
        constants = [entry.profile.constant_value for entry in one.actuation]
        if None in constants:
            raise ReferenceMismatch("it is about a constant torque")
        torque = sum(constant or 0.0 for constant in constants)
        if joint.stiffness == 0:
            raise ReferenceMismatch("it is about a joint with a spring")
        rest = joint.neutral_position + torque / joint.stiffness
        moving = closed_forms.oscillator(
            times, inertia, joint.damping, joint.stiffness, (angle - rest, rate)
        )
        return rest + moving
    if joint.stiffness or joint.damping or one.actuation:
        raise ReferenceMismatch("it is about a joint without spring, damper and actuation")
    if most == 0:
        raise ReferenceMismatch("it is about a joint that gravity turns")
    # weight(q) = -most sin(q - lowest)
    lowest = math.atan2(weight(0.0), -weight(math.pi / 2))
    swing = math.remainder(angle - lowest, 2 * math.pi)
    frequency = math.sqrt(most / inertia)
    try:
        return angle - swing + closed_forms.pendulum(times, frequency, swing, rate)
    except ValueError as error:
        raise ReferenceMismatch(str(error)) from error


def _beam_and_tip(scene: Scene) -> tuple[_Beam, closed_forms.Tip, float]:
    """Return the beam, its closed-form tip, and how well the form describes it [m]."""
    from somo_cli.analysis import closed_forms  # needs scipy, which is slow to import

    one = _single_manipulator(scene)
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
    if not np.allclose([joint.axis for joint in joints], first.axis, atol=_TOLERANCE):
        raise ReferenceMismatch("it is about joints with one and the same axis")
    if not np.allclose(rigidities, rigidities[0], rtol=_TOLERANCE, atol=0):
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
    if abs(first.axis[2]) > _TOLERANCE:
        raise ReferenceMismatch("it is about joints that bend, not twist")
    return _Beam(clamp, along, across, length, rigidities[0])


def _weight(scene: Scene, one: Manipulator, beam: _Beam) -> float:
    """Return the weight of the beam, w L, along its transverse axis [N]."""
    definition = one.compiled.definition
    if definition.tips:
        raise ReferenceMismatch("it is about a beam without a tip body")
    gravity = np.array(scene.gravity)
    sideways = float(gravity @ beam.across)
    if np.linalg.norm(gravity - sideways * beam.across) > _TOLERANCE * np.linalg.norm(gravity):
        raise ReferenceMismatch("it is about gravity across the beam, in its plane of bending")
    densities = [actuator.link.mass / actuator.link.height for actuator in definition.actuators]
    if not np.allclose(densities, densities[0], rtol=_TOLERANCE):
        raise ReferenceMismatch("it is about a beam of one mass per length")
    return densities[0] * beam.length * sideways


def _tip_force(one: Manipulator, beam: _Beam) -> float:
    """Return the only load, a force on the tip, along the beam's transverse axis [N]."""
    if one.actuation:
        raise ReferenceMismatch("it is about a load on the tip alone, without actuation")
    load = _single_load(one)
    at_tip = math.dist(load.point, one.compiled.chain.tip) <= _TOLERANCE * beam.length
    if load.link != len(one.compiled.chain.joints) or not at_tip:
        raise ReferenceMismatch("it is about a force on the tip")
    if any(load.moment) or load.frame != "world":
        raise ReferenceMismatch("it is about a force that keeps its direction, without a moment")
    force = load.waypoints[-1][1] * np.array(load.force)
    return _component(force, beam.across, "a force across the beam, in its plane of bending")


def _moment(one: Manipulator, beam: _Beam) -> float:
    """Return the moment that every joint bears: of a load on the tip, or of the actuation [N·m]."""
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
    if np.linalg.norm(vector - value * axis) > _TOLERANCE * np.linalg.norm(vector):
        raise ReferenceMismatch(f"it is about {what}")
    return value
