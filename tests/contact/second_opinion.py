"""The same scenes in MuJoCo, whose contact is a stiff spring-damper: a second opinion.

Its friction is the larger of two, ours the product; so the geoms are given the product, and where a
scene has several, the object that slides with the least takes precedence.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import mujoco
import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.solids import Box, Solid, Sphere
from somo_cli.manipulator.urdf import render
from somo_cli.scene.actuation import Actuation
from somo_cli.scene.model import Manipulator, Scene
from somo_cli.scene.rigid_object import RigidObject
from somo_cli.scene.signals import Signal
from tests.contact.cases import Case

STEP = 2e-5  # s
STIFF = (1e-4, 1.0)  # s, damping ratio: how fast a penetration recovers
HARD = (0.99, 0.999, 1e-4, 0.5, 2.0)  # impedance at no penetration and at 0.1 mm
MANIPULATOR, OBJECT = 1, 2  # bits of collision: manipulators touch objects only
FLOATING = (
    '<link name="world"/><joint name="floating" type="floating">'
    '<parent link="world"/><child link="base"/></joint>'
)


def figure(case: Case, step: float = STEP) -> float:
    """Return the figure of a case."""
    scene = case.scene(step)
    model = model_of(scene, step)
    return case.figure(_columns(case, scene, model))


def model_of(scene: Scene, step: float) -> mujoco.MjModel:
    """Return a scene as a model."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    for one in scene.manipulators:
        frame = spec.worldbody.add_frame(
            pos=one.position,
            quat=_wxyz(geometry.rotation_from_rpy(one.rpy)),
        )
        spec.attach(mujoco.MjSpec.from_string(_urdf(one)), prefix=f"{one.name}/", frame=frame)
    if scene.ground is not None:
        low = [0, 0, scene.ground.height - 0.5]
        spec.worldbody.add_geom(
            name="ground", type=mujoco.mjtGeom.mjGEOM_BOX, size=[50, 50, 0.5], pos=low
        )
    for one_object in scene.objects:
        _add(spec, one_object)
    model = spec.compile()
    model.opt.timestep = step
    model.opt.gravity[:] = scene.gravity
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 100
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    for one in scene.manipulators:
        _set_springs(model, one)
    _set_contact(model, scene)
    return model


def _urdf(one: Manipulator) -> str:
    chain = one.compiled.chain
    extra = FLOATING * (one.base == "free")
    text = render(chain).replace(
        f'<robot name="{chain.name}">',
        f'<robot name="{chain.name}"><mujoco><compiler fusestatic="true" '
        f'discardvisual="true" balanceinertia="false"/></mujoco>{extra}',
    )
    # names of materials would clash between manipulators
    return re.sub(r"<material[^>]*/>|<material.*?</material>", "", text, flags=re.DOTALL)


def _wxyz(rotation: geometry.Matrix) -> list[float]:
    x, y, z, w = geometry.quaternion_from_rotation(rotation)
    return [w, x, y, z]


def _add(spec: mujoco.MjSpec, one_object: RigidObject) -> None:
    (shape,) = one_object.chain.links[0].shapes
    body = spec.worldbody.add_body(
        name=one_object.name,
        pos=one_object.position,
        quat=_wxyz(geometry.rotation_from_rpy(one_object.rpy)),
    )
    if not one_object.is_fixed:
        body.add_freejoint()
    mass = one_object.chain.links[0].inertial.mass
    kind, size = _geom(shape.solid)
    body.add_geom(name=one_object.name, type=kind, size=size, mass=mass)


def _geom(solid: Solid) -> tuple[mujoco.mjtGeom, list[float]]:
    """Return the type and size of a box or ball: the bench has no other objects."""
    if isinstance(solid, Sphere):
        return mujoco.mjtGeom.mjGEOM_SPHERE, [solid.radius, 0, 0]
    assert isinstance(solid, Box)
    return mujoco.mjtGeom.mjGEOM_BOX, [side / 2 for side in solid.size]


def _set_springs(model: mujoco.MjModel, one: Manipulator) -> None:
    for joint in one.compiled.chain.joints:
        index = model.joint(f"{one.name}/{joint.name}").id
        # a row of one or of three numbers, by MuJoCo's version
        model.jnt_stiffness.reshape(model.njnt, -1)[index, 0] = joint.stiffness
        model.qpos_spring[model.jnt_qposadr[index]] = joint.neutral_position
        dof = model.jnt_dofadr[index]
        model.dof_damping.reshape(model.nv, -1)[dof, 0] = joint.damping
        model.dof_frictionloss[dof] = 0


def _set_contact(model: mujoco.MjModel, scene: Scene) -> None:
    own = scene.manipulators[0].surfaces.links.friction
    surfaces = {one_object.name: one_object.surface.friction for one_object in scene.objects}
    if scene.ground is not None:
        surfaces["ground"] = scene.ground.surface.friction
    order = sorted(set(surfaces.values()), reverse=True)
    for index in range(model.ngeom):
        name = model.geom(index).name
        is_object = name in surfaces
        friction = own * surfaces[name] if is_object else 0.0
        model.geom_friction[index] = (max(friction, 1e-5), 0, 0)
        model.geom_priority[index] = 1 + order.index(surfaces[name]) if is_object else 0
        model.geom_solref[index] = STIFF
        model.geom_solimp[index] = HARD
        model.geom_condim[index] = 3
        model.geom_contype[index] = OBJECT if is_object else MANIPULATOR
        model.geom_conaffinity[index] = (OBJECT | MANIPULATOR) if is_object else 0


def _columns(case: Case, scene: Scene, model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """Run, and return what columns of ours the figures need."""
    state = mujoco.MjData(model)
    for one_object in scene.objects:
        if not one_object.is_fixed:
            at = model.jnt_dofadr[model.body(one_object.name).jntadr[0]]
            state.qvel[at : at + 3] = one_object.linear_velocity
    drives = drives_of(model, scene)
    table: dict[str, list[float]] = {"time_s": []}
    first = scene.manipulators[0].name
    monitored = {one_object.name for one_object in scene.objects if not one_object.is_fixed}
    steps = round(case.seconds / model.opt.timestep)
    for number in range(steps + 1):
        for signal, dofs in drives:
            state.qfrc_applied[dofs] = signal.at((number + 0.5) * model.opt.timestep)
        table["time_s"].append(number * model.opt.timestep)
        for name in monitored:
            for axis, value in zip("xyz", state.body(name).xpos, strict=True):
                table.setdefault(f"{name}.pose.{axis}_m", []).append(float(value))
        mujoco.mj_step(model, state)
        pressed = _normal_force(model, state, first)
        table.setdefault(f"{first}.contact.normal_n", []).append(pressed)
    return {name: np.array(values) for name, values in table.items()}


def drives_of(model: mujoco.MjModel, scene: Scene) -> list[tuple[Signal, list[int]]]:
    """Return the torque of each actuation over time, and the coordinates that it acts on."""
    return [
        (entry.profile.signal(), _dofs(model, one, entry))
        for one in scene.manipulators
        for entry in one.actuation
    ]


def _dofs(model: mujoco.MjModel, one: Manipulator, entry: Actuation) -> list[int]:
    return [
        int(model.joint(f"{one.name}/{joint.name}").dofadr[0])
        for joint in one.compiled.chain.joints
        if (joint.actuator, joint.channel) == (entry.actuator, entry.axis)
    ]


def _normal_force(model: mujoco.MjModel, state: mujoco.MjData, name: str) -> float:
    """Return the sum of the normal forces on a manipulator in the last step."""
    total = 0.0
    force = np.zeros(6)
    for index in range(state.ncon):
        bodies = model.geom_bodyid[state.contact.geom[index]]
        if any(model.body(int(body)).name.startswith(f"{name}/") for body in bodies):
            mujoco.mj_contactForce(model, state, index, force)
            total += force[0]
    return total


def apart(case: Case, ours: float, steps: Sequence[float] = (2 * STEP, STEP)) -> tuple[float, ...]:
    """Return how far MuJoCo's figure is from ours, relative, at each step."""
    return tuple(abs(figure(case, step) / ours - 1) for step in steps)
