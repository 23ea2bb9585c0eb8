"""An assembly of three limbs on a body, each limb unlike the others in shape or place."""

from __future__ import annotations

from typing import Any

from tests.builders.definitions import (
    BOX,
    CAPSULE,
    CYLINDER,
    SPHERE,
    STADIUM,
    X,
    Y,
    Z,
    actuator,
    manipulator,
)

BEND = manipulator(actuator(4, X, Y), base_definition=BOX, tip_definition=SPHERE)
TWIST = manipulator(
    actuator(2, Z, link=CAPSULE),
    actuator(3, Y, link=STADIUM, joint_placement="gauss"),
    tip_definition={**CYLINDER, "origin_offset": [0.001, 0.002, 0, 0.3, 0.2, 0.1]},
)
PLACES = {
    "left": ((0.05, 0.01, 0.02), (0.3, -0.7, 1.1)),
    "right": ((-0.05, 0.0, 0.03), (-0.2, 0.4, 2.5)),
    "mid_1": ((0.0, -0.04, -0.01), (0.0, 0.0, 0.0)),
}
BODY = {
    **BOX,
    "dimensions": [0.1, 0.06, 0.03],
    "mass": 0.2,
    "origin_offset": [0.01, 0, -0.004, 0, 0, 0.2],
}
ALONE = {"left": BEND, "right": TWIST, "mid_1": BEND}


def assembly_of(**changes: Any) -> dict[str, Any]:
    """Return the data of the assembly, with changes at its top level."""
    limbs = [
        {"name": name, "definition": ALONE[name], "position": list(at), "rpy": list(rpy)}
        for name, (at, rpy) in PLACES.items()
    ]
    return {"assembly_name": "body", "body_definition": BODY, "limbs": limbs} | changes
