"""The closed forms that a scene may name as its `reference`."""

from __future__ import annotations

import dataclasses

import numpy as np

from somo_cli.analysis.beam_reference import CONTINUUM, beam_and_closed_form_tip
from somo_cli.analysis.joint_reference import SINGLE_JOINT, joint_motion
from somo_cli.analysis.reference import Reference
from somo_cli.analysis.reference_scene import TOLERANCE, ReferenceMismatch
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.units import unit_factors_of


def check_applicable(scene: Scene) -> None:
    """Raise ReferenceMismatch unless the closed form that a scene names describes the scene."""
    if scene.reference in SINGLE_JOINT:
        joint_motion(scene, np.zeros(1))
    elif scene.reference in CONTINUUM:
        beam_and_closed_form_tip(scene)


def with_closed_form(scene: Scene, reference: Reference) -> Reference:
    """Return the reference with angle and tip from the closed form of a single joint.

    The other quantities keep the values to which the runs converge. A scene that names no such
    closed form keeps its reference. Raises ReferenceMismatch if the runs converge elsewhere.
    """
    if scene.reference not in SINGLE_JOINT:
        return reference
    plan = make_plan(scene)
    body = plan.bodies[0]
    chain = ChainDynamics(body.chain)
    rows = reference.rows.copy()
    angles = joint_motion(scene, rows[:, 0])
    length = unit_factors_of(plan).length
    tips = np.array([chain.at([angle], body.start.pose).tip for angle in angles]) / length
    exact = {"joint_angles": angles[:, np.newaxis], "tip_position": tips}
    error = dict(reference.error)
    for group in columns.body_column_groups(plan.recorded):
        values = exact.get(group.quantity)
        if values is None:
            continue
        part = slice(group.first, group.last)
        rows[:, part] = values
        distance = float(np.abs(values - reference.rows[:, part]).max())
        if distance > 100 * reference.error[group.quantity] + 1e-6:
            message = f"the runs converge to values that differ from it by {distance:.2g}"
            raise ReferenceMismatch(message)
        error[group.quantity] = TOLERANCE * float(np.abs(values).max()) * 1e-3
    return dataclasses.replace(reference, rows=rows, error=error, kind=scene.reference)
