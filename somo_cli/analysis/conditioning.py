"""What is ill-conditioned for the engine in a body, as findings with suitable values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.definition import MAXIMUM_JOINTS
from somo_cli.problems import Pointer, Problem
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import MIN_JOINT_INERTIA, articulated_inertia
from somo_cli.simulation.plan.model import Body, Plan

MASS_RATIO = 1e3  # of neighbours, above which the lighter one loses three digits to rounding
SMALLEST_CONTACT_SIZE = 0.1  # engine units; Bullet's collision margins are 0.04
LARGEST_INERTIA = 1.0  # engine units, in rotated axes; see BulletDynamics.mass_matrix
MAX_UNNAMED_JOINTS = 100


def findings(plan: Plan, body: Body, document: Document, at: Pointer) -> Iterator[Problem]:
    """Yield findings about a body, whose manipulator is at a pointer of the document."""
    definition: Pointer = (*at, "definition")
    yield from _mass_findings(plan, body, document, definition)
    yield from _inertia_findings(plan, body, document, definition)
    yield from _row_findings(body, document, definition)
    if plan.can_touch:
        yield from _size_findings(plan, body, document, definition)
    count = len(body.chain.joints)
    if count > MAX_UNNAMED_JOINTS:
        yield Problem(
            document.span((*definition, "actuator_definitions"), key=True),
            f"{count} of the {MAXIMUM_JOINTS} joints that a body may have",
            severity="info",
            code="many-joints",
        )


def _mass_findings(plan: Plan, body: Body, document: Document, at: Pointer) -> Iterator[Problem]:
    masses = [link.inertial.mass for link in body.chain.links]
    first = 1 if body.base == "static" else 0  # the mass of a static base has no effect
    for index in range(first, len(masses) - 1):
        light, heavy = sorted((index, index + 1), key=lambda link: masses[link])
        ratio = masses[heavy] / masses[light]
        if ratio > MASS_RATIO:
            names = [body.chain.links[link].name for link in (heavy, light)]
            yield Problem(
                document.span(_pointer_of(body.chain, document, at, light)),
                f"{names[0]} is {ratio:.3g} times as heavy as its neighbour {names[1]}",
                f"a ratio below {MASS_RATIO:g} is accurate: make {names[1]} heavier than "
                f"{masses[heavy] / MASS_RATIO / plan.scale.mass:.3g} kg",
                "warning",
                "mass-ratio",
            )
            return


def _inertia_findings(plan: Plan, body: Body, document: Document, at: Pointer) -> Iterator[Problem]:
    for index, link in enumerate(body.chain.links):
        moments = geometry.principal_moments(link.inertial.inertia)
        _, xy, xz, _, yz, _ = link.inertial.inertia
        is_turned = max(map(abs, (xy, xz, yz))) > 1e-12 * moments[2]
        if is_turned and moments[2] > LARGEST_INERTIA:
            mass = plan.scale.mass * _one_digit_below(LARGEST_INERTIA / moments[2])
            yield Problem(
                document.span(_pointer_of(body.chain, document, at, index)),
                f"the inertia of {link.name} is {moments[2]:.3g} engine units in rotated axes, "
                "which the engine may refuse",
                f"world_scale: {{length: {plan.scale.length:g}, mass: {mass:g}}} changes no result",
                "warning",
                "large-inertia",
            )
            break
    chain = ChainDynamics(body.chain)
    inertia = chain.at(body.start.angles).joint_inertia(body.base == "free")
    try:
        effective_inertia = articulated_inertia(inertia)
    except np.linalg.LinAlgError:
        yield Problem(
            document.span(at),
            f"the inertia of '{body.name}' is singular: its masses differ too much",
            "make the lightest links heavier, or the chain shorter",
            code="no-inertia",
        )
        return
    least = int(np.argmin(effective_inertia))
    if effective_inertia[least] < MIN_JOINT_INERTIA:
        needed = _one_digit_above(MIN_JOINT_INERTIA / effective_inertia[least]) * 10
        yield Problem(
            document.span(at),
            f"joint '{body.chain.joints[least].name}' moves {effective_inertia[least]:.2g} engine "
            f"units of inertia; the engine locks joints that move less than {MIN_JOINT_INERTIA:g}",
            f"world_scale: {{length: {plan.scale.length:g}, mass: {plan.scale.mass * needed:g}}} "
            "changes no result",
            code="frozen-joint",
        )


def _row_findings(body: Body, document: Document, at: Pointer) -> Iterator[Problem]:
    joints = body.chain.joints
    with_friction = sum(joint.friction > 0 for joint in joints)
    if with_friction:
        yield Problem(
            document.span((*at, "actuator_definitions"), key=True),
            f"dry friction costs the engine {with_friction} constraint rows in every step",
            "leave joint_control_limit_force out if the damping of the joints is enough",
            "info",
            "friction-rows",
        )
    loose = [joint.name for joint in joints if joint.stiffness == 0]
    if loose:
        yield Problem(
            document.span((*at, "actuator_definitions"), key=True),
            f"{len(loose)} of {len(joints)} joints have no spring, first '{loose[0]}'",
            severity="info",
            code="no-spring",
        )


def limits_reached(body: Body, swings: Array, document: Document, at: Pointer) -> Iterator[Problem]:
    """Yield a finding if a joint may reach its limits; `swings` [rad] are expected excursions."""
    reached = [
        joint.name
        for joint, angle, swing in zip(body.chain.joints, body.start.angles, swings, strict=True)
        if joint.is_limited and not joint.lower < angle - swing <= angle + swing < joint.upper
    ]
    if reached:
        yield Problem(
            document.span((*at, "definition", "actuator_definitions"), key=True),
            f"{len(reached)} joints may reach their limits, first '{reached[0]}': each then costs "
            "a constraint row, and stops without a rebound",
            severity="info",
            code="limits-met",
        )


def _size_findings(plan: Plan, body: Body, document: Document, at: Pointer) -> Iterator[Problem]:
    sizes = [
        (shape.solid.smallest_extent, index)
        for index, link in enumerate(body.chain.links)
        for shape in link.shapes
    ]
    size, index = min(sizes, default=(SMALLEST_CONTACT_SIZE, 0))
    if size < SMALLEST_CONTACT_SIZE:
        length = _one_digit_above(plan.scale.length * SMALLEST_CONTACT_SIZE / size)
        yield Problem(
            document.span(_pointer_of(body.chain, document, at, index)),
            f"the smallest extent of {body.chain.links[index].name} is {size:.3g} engine units, "
            f"and contact needs {SMALLEST_CONTACT_SIZE:g}",
            f"world_scale: {length:g}",
            "warning",
            "small-for-contact",
        )


def _pointer_of(chain: Chain, document: Document, at: Pointer, link: int) -> Pointer:
    """Return the pointer to the description of a link of the chain."""
    keys = _mapping(document.at(at))
    if link == 0 and chain.limbs:
        return (*at, "body_definition")
    if link == 0 and "base_definition" in keys:
        return (*at, "base_definition")
    joint = chain.joints[max(0, link - 1)]
    limb = chain.backbone_of(joint)
    if chain.limbs:
        at = (*at, "limbs", chain.limbs.index(limb), "definition")
        keys = _mapping(document.at(at))
    if link == limb.last_link:
        for key in ("tip_definition", "tip_definitions"):
            if keys.get(key):
                return (*at, key)
    actuator = joint.actuator - limb.first_actuator
    return (*at, "actuator_definitions", actuator, "link_definition")


def _mapping(data: object) -> Mapping[str, Any]:
    return data if isinstance(data, dict) else {}


def _one_digit_below(value: float) -> float:
    """Return the largest power of ten that is not larger."""
    return float(f"1e{int(np.floor(np.log10(value)))}")


def _one_digit_above(value: float) -> float:
    """Return the smallest number of one digit that is not smaller."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(f"{np.ceil(value / power - 1e-9) * power:.6g}")
