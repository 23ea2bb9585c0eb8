"""The grasp of a ball in MuJoCo, at the same steps, with contact as stiff as its step allows."""

from __future__ import annotations

import mujoco
import numpy as np

from tests.contact.second_opinion import STIFF, drives_of, model_of
from tests.grasp.cases import END, RADIUS, Grasp
from tests.grasp.trial import QUIET, Held


def held_in_mujoco(grasp: Grasp, step: float) -> Held:
    """Return how an object is held in the end by fingers whose bases do not move."""
    scene = grasp.scene(step)
    model = model_of(scene, step)
    # a contact that recovers faster than in two steps is not stable
    model.geom_solref[:, 0] = max(STIFF[0], 2 * step)
    state = mujoco.MjData(model)
    drives = drives_of(model, scene)
    thing = model.body("object").id
    # on the ground, where the plan puts it
    state.qpos[model.jnt_qposadr[model.body_jntadr[thing]] + 2] = RADIUS
    forces: list[float] = []
    steps = round(END / step)
    for number in range(steps):
        for signal, dofs in drives:
            state.qfrc_applied[dofs] = signal.at((number + 0.5) * step)
        mujoco.mj_step(model, state)
        if number * step > END - QUIET:
            forces.append(_normal_force(model, state, thing))
    return Held(float(np.mean(forces)), float(np.std(forces)), state.xpos[thing].copy(), 0.0)


def _normal_force(model: mujoco.MjModel, state: mujoco.MjData, body: int) -> float:
    """Return the sum of the normal forces on a body in the last step."""
    total, force = 0.0, np.zeros(6)
    for index in range(state.ncon):
        if body in model.geom_bodyid[state.contact.geom[index]]:
            mujoco.mj_contactForce(model, state, index, force)
            total += float(force[0])
    return total
