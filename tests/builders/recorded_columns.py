"""Every quantity that a body records, and the names of its columns for a small manipulator."""

from __future__ import annotations

import json
from typing import Any, get_args

from somo_cli.scene.model import Quantity
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.scenes import scene_from_text

QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)


def plan_that_records(definition: object, *quantities: Quantity, **more: Any) -> Plan:
    """Return a plan of one manipulator `a` that records these; `one` goes into the manipulator."""
    one = {"name": "a", "definition": definition, **more.pop("one", {})}
    record = {"columns": quantities}
    return make_plan(scene_from_text(json.dumps({"manipulators": [one], "record": record, **more})))


COLUMN_NAMES: dict[Quantity, list[str]] = {
    "joint_angles": [
        "actuator_0_joint_01.angle_rad",
        "actuator_0_joint_02.angle_rad",
        "actuator_1_joint_01.angle_rad",
    ],
    "joint_rates": [
        "actuator_0_joint_01.rate_rad_per_s",
        "actuator_0_joint_02.rate_rad_per_s",
        "actuator_1_joint_01.rate_rad_per_s",
    ],
    "spring_torques": [
        "actuator_0_joint_01.spring_torque_nm",
        "actuator_0_joint_02.spring_torque_nm",
        "actuator_1_joint_01.spring_torque_nm",
    ],
    "curvatures": [
        "actuator_0_joint_01.curvature_per_m",
        "actuator_0_joint_02.curvature_per_m",
        "actuator_1_joint_01.curvature_per_m",
    ],
    "actuation": [
        "actuator_0_axis_0.torque_nm",
        "actuator_0_axis_1.torque_nm",
        "actuator_1_axis_0.torque_nm",
    ],
    "link_positions": [
        f"{link}.{coordinate}_m"
        for link in (
            "base",
            "actuator_0_segment_01",
            "actuator_0_segment_02",
            "actuator_1_segment_01",
        )
        for coordinate in "xyz"
    ],
    "link_orientations": [
        f"{link}.{component}"
        for link in (
            "base",
            "actuator_0_segment_01",
            "actuator_0_segment_02",
            "actuator_1_segment_01",
        )
        for component in ("qx", "qy", "qz", "qw")
    ],
    "base_pose": [f"base_pose.{name}" for name in ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")],
    "tip_position": ["tip.x_m", "tip.y_m", "tip.z_m"],
    "tip_velocity": [f"tip_velocity.{axis}_m_per_s" for axis in "xyz"],
    "tip_orientation": [f"tip_orientation.{name}" for name in ("qx", "qy", "qz", "qw")],
    "bending_angles": [
        "actuator_0_axis_0.bend_rad",
        "actuator_0_axis_1.bend_rad",
        "actuator_1_axis_0.bend_rad",
    ],
    "energy": ["energy.kinetic_j", "energy.elastic_j", "energy.gravity_j"],
    "contact_force": ["contact.fx_n", "contact.fy_n", "contact.fz_n", "contact.normal_n"],
    "contact_pairs": [],  # it is alone
    "link_contact_forces": [
        f"{link}.contact.{one}_n"
        for link in (
            "base",
            "actuator_0_segment_01",
            "actuator_0_segment_02",
            "actuator_1_segment_01",
        )
        for one in (
            "fx",
            "fy",
            "fz",
            "normal",
            "friction",
            "friction_x",
            "friction_y",
            "friction_z",
        )
    ],
}
