"""Where the result of a fit goes in a scene: values of joint definitions, and gains of torques."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from somo_cli.calibration import joint_pointers
from somo_cli.calibration.fit import FitResult
from somo_cli.calibration.parameters import Parameter, ParameterKind
from somo_cli.document.parse import Document
from somo_cli.problems import Pointer

_KEYS: Mapping[ParameterKind, str] = {
    "stiffness": "spring_stiffness",
    "damping": "spring_damping",
    "gain": "torque_per_pressure",
}


def definition_values(document: Document, found: FitResult) -> Iterator[tuple[Pointer, float]]:
    """Yield the pointers and new values of joint definitions of a valid scene, rounded."""
    at: Pointer = ("manipulators", 0, "definition")
    for parameter, factor in zip(found.parameters, found.factors.tolist(), strict=True):
        if is_torque_gain(document, parameter):
            continue
        key = _KEYS[parameter.kind]
        for place in joint_pointers.pointers(document, at, parameter.actuator, parameter.axis):
            definition = document.at(place)
            assert isinstance(definition, dict)
            if definition.get(key) is not None:
                yield (*place, key), joint_pointers.rounded(float(definition[key]) * factor)


def is_torque_gain(document: Document, parameter: Parameter) -> bool:
    """Return whether a parameter is a gain of torques, which a definition cannot hold."""
    where = parameter.actuator, parameter.axis
    return parameter.kind == "gain" and where not in joint_pointers.under_pressure(document, 0)
