"""Definitions to test with, as plain data, and what the compiler makes of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from somo_cli.document.parse import Document, parse
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled, compile_definition

Data = dict[str, Any]

BOX: Data = {"shape_type": "box", "dimensions": [0.023, 0.017, 0.02], "mass": 0.003}
STADIUM: Data = {**BOX, "shape_type": "stadium"}
CYLINDER: Data = {"shape_type": "cylinder", "dimensions": [0.02, 0.01], "mass": 0.004}
CAPSULE: Data = {**CYLINDER, "shape_type": "capsule"}
SPHERE: Data = {"shape_type": "sphere", "dimensions": [0.01], "mass": 0.005}


def hinge(*axis: float, **changes: Any) -> Data:
    """Return a revolute joint of 0.2 N·m/rad about an axis, with changes."""
    joint = {
        "joint_type": "revolute",
        "axis": list(axis),
        "limits": [-3, 3, 10, 20],
        "spring_stiffness": 0.2,
        "spring_damping": 0.001,
    }
    return joint | changes


X, Y, Z = hinge(1, 0, 0), hinge(0, 1, 0), hinge(0, 0, 1)


def actuator(n_segments: int, *joints: Data, link: Data = BOX, **changes: Any) -> Data:
    """Return an actuator of so many segments whose joints take turns."""
    return {
        "n_segments": n_segments,
        "link_definition": link,
        "joint_definitions": list(joints),
        **changes,
    }


def manipulator(*actuators: Data, **changes: Any) -> Data:
    """Return the definition of a manipulator called `body`."""
    return {"manipulator_name": "body", "actuator_definitions": list(actuators), **changes}


def document_of(data: Mapping[str, Any]) -> Document:
    """Return a definition as it is parsed from a file."""
    return parse(json.dumps(data, indent=2), "body.json")


def compiled(data: Mapping[str, Any]) -> Compiled:
    """Compile, and fail on any warning."""
    result = compile_definition(document_of(data))
    assert result.warnings == ()
    return result


def chain_of(data: Mapping[str, Any]) -> Chain:
    """Return the chain of a definition, which must compile without a warning."""
    return compiled(data).chain


# A base, every kind of joint, a seam, offsets and a tip: as much as one body can hold.
EVERYTHING = manipulator(
    actuator(
        4,
        hinge(1, 0, 0, neutral_axis_offset=[0.001, 0.006, -0.002, 0, 0, 0]),
        hinge(0.7, 0.7, 0),
        Z,
        link={**STADIUM, "origin_offset": [0.001, 0, 0, 0.1, 0.2, 0.3]},
    ),
    actuator(3, hinge(0, -1, 0, joint_type="continuous", limits=None), link=CAPSULE),
    actuator(2, X, {"joint_type": "fixed"}, link={**SPHERE, "mass": 0.002}),
    base_definition={**CYLINDER, "dimensions": [0.03, 0.02], "mass": 0.1},
    tip_definitions=[
        {**SPHERE, "origin_offset": [0.002, 0.003, -0.004, 0, 0, 0]},
        {**BOX, "origin_offset": [0, 0.01, 0, 0.4, -0.5, 0.6]},
    ],
)


def bent(chain: Chain) -> list[float]:
    """Return joint angles [rad] at which nothing is symmetric."""
    return [0.1 * (1 + place % 3) * (-1) ** (place // 2) for place in range(len(chain.joints))]
