"""Import a model: find its definition, and refuse one that is not the model."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from somo_cli.exchange.definition_text import definition_text
from somo_cli.exchange.flat_model import FlatModel, flat_chain, rescaled
from somo_cli.exchange.found_definition import found_definition
from somo_cli.exchange.found_parts import Data
from somo_cli.exchange.read_mjcf import read_mjcf
from somo_cli.exchange.read_sdf import read_sdf
from somo_cli.exchange.read_urdf import read_urdf, scale_in
from somo_cli.exchange.split_limb import NotADefinitionError
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import Scale
from somo_cli.problems import InvalidFile, Problem
from somo_cli.scene.urdf_xml import XmlElement, parse_xml

_DEPTH = 400
"""Elements of MJCF are nested as deeply as a chain has links."""
_TOLERANCE = 1e-9

ModelFormat = Literal["mjcf", "sdf", "urdf"]
_ROOTS: dict[str, ModelFormat] = {"mujoco": "mjcf", "sdf": "sdf", "robot": "urdf"}


@dataclass(frozen=True, slots=True)
class Imported:
    """A model of a file and its definition as data, both in the units of the file."""

    format: ModelFormat
    flat: FlatModel
    data: Data
    scale: Scale

    def text(self, source: str) -> str:
        """Return the definition as YAML."""
        first, *rest = self.data.items()
        data = {first[0]: first[1], "world_scale": self.scale.length, **dict(rest)}
        if self.scale.mass != 1:
            data["world_scale"] = {"length": self.scale.length, "mass": self.scale.mass}
        lost = "torque per pressure"
        if self.format == "mjcf":
            lost += ", and effort and velocity of limits"
        comment = f"Imported from {source}; its format does not have {lost}."
        return definition_text(data, comment)


def import_model(text: str, source: str, body: str | None = None) -> Imported:
    """Return the definition of the model in a URDF, an SDF or an MJCF, by its root element.

    `body` names the body of an MJCF. Raises InvalidFile, with all that cannot be read or with the
    first reason why no definition describes the model.
    """
    root = parse_xml(text, source, _DEPTH)
    kind = _ROOTS.get(root.tag)
    problems: list[Problem] = []
    flat: FlatModel | None = None
    if kind == "mjcf":
        flat = read_mjcf(problems, root, body)
    elif kind == "sdf":
        flat = read_sdf(problems, root)
    elif kind == "urdf":
        flat = read_urdf(problems, root)
    else:
        hint = "the root of a model is <mujoco>, <sdf> or <robot>"
        problems.append(Problem(root.span, f"<{root.tag}> is no model", hint))
    if problems or flat is None or kind is None:
        raise InvalidFile(problems, {source: text})
    scale = scale_in(text) if kind == "urdf" else Scale()
    flat = _in_si(flat, scale)
    try:
        data = found_definition(flat)
    except NotADefinitionError as error:
        raise _refused(root, f"no definition describes this model: {error}", source, text) from None
    return Imported(kind, flat, data, scale)


def require_same(found: Imported, chain: Chain, source: str, text: str) -> None:
    """Raise InvalidFile unless a chain is the model that was read, to 1e-9."""
    differences = list(_differences(found.flat, flat_chain(chain), found.format))
    if differences:
        root = parse_xml(text, source, _DEPTH)
        message = "no definition that somo can find describes this model: " + differences[0]
        raise _refused(root, message, source, text)


def _refused(root: XmlElement, message: str, source: str, text: str) -> InvalidFile:
    hint = "a definition is segments of one shape in line, with joints between them"
    return InvalidFile([Problem(root.span, message, hint)], {source: text})


def _in_si(flat: FlatModel, scale: Scale) -> FlatModel:
    return flat if scale == Scale() else rescaled(flat, Scale(1 / scale.length, 1 / scale.mass))


def _differences(model: FlatModel, ours: FlatModel, kind: ModelFormat) -> Iterator[str]:
    """Yield a line for each quantity of the model that a compiled definition has not."""
    size = model.size
    if len(model.joints) != len(ours.joints):
        yield f"{len(ours.joints)} joints instead of {len(model.joints)}"
        return
    for link, other in zip(model.links, ours.links, strict=True):
        one, two = link.inertial, other.inertial
        inertia = max(map(abs, one.inertia))
        yield from _unequal(f"mass of '{link.name}'", [one.mass], [two.mass], one.mass)
        yield from _unequal(f"centre of mass of '{link.name}'", one.centre, two.centre, size)
        yield from _unequal(f"inertia of '{link.name}'", one.inertia, two.inertia, inertia)
    for joint, mine in zip(model.joints, ours.joints, strict=True):
        what = f"of '{joint.name}'"
        yield from _unequal(f"position {what}", joint.hinge, mine.hinge, size)
        yield from _unequal(f"axis {what}", joint.axis, mine.axis, 1.0)
        for name in ("stiffness", "damping", "friction"):
            value = getattr(joint, name)
            yield from _unequal(f"{name} {what}", [value], [getattr(mine, name)], value)
        if kind == "mjcf":  # which has no velocity limit, and clamps by an effort
            mine = replace(mine, effort=joint.effort, velocity=joint.velocity)
        five = (joint.lower, joint.upper, joint.neutral_position)
        yield from _unequal(f"limits {what}", five, (mine.lower, mine.upper, mine.neutral_position))


def _unequal(
    what: str, theirs: Sequence[float], ours: Sequence[float], size: float = 1.0
) -> Iterator[str]:
    pairs = zip(theirs, ours, strict=True)
    if not all(math.isclose(a, b, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE * size) for a, b in pairs):
        yield f"{what} is {_shown(theirs)}, and the nearest definition has {_shown(ours)}"


def _shown(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)
