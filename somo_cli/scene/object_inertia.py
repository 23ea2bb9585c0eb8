"""Compute mass and inertia of an object that a URDF describes: of the file, or of its shapes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.manipulator import solids
from somo_cli.manipulator.solids import Inertial
from somo_cli.scene.possible_inertia import described, nearest_possible
from somo_cli.scene.urdf_rigid_body import UrdfLink, UrdfRigidBody


def takes_solid(data: Mapping[str, Any]) -> bool:
    """Return whether an object has the inertia of its filled shapes, not that of the file."""
    return bool(data.get("inertia") == "solid")


def has_own_mass(data: Mapping[str, Any]) -> bool:
    """Return whether the scene gives the object a mass or density, in place of the file's mass."""
    return "mass" in data or "density" in data


def urdf_inertial(body: UrdfRigidBody, data: Mapping[str, Any]) -> Inertial | None:
    """Return mass [kg], centre of mass [m] and inertia [kg·m²] in the root link's frame.

    With `inertia: solid` the mass of each link fills its shapes evenly. If the scene gives a mass
    or density as well, it fills the shapes of all links evenly. An inertia of the file that no body
    can have is replaced by the nearest possible one. Returns None if no link has a mass.
    """
    if takes_solid(data) and has_own_mass(data):
        parts = [link.filled for link in body.links if link.filled is not None]
        if not parts:
            return None
        whole = solids.lumped(tuple(parts))
        mass = float(data["mass"]) if "mass" in data else float(data["density"]) * whole.mass
        return with_mass(whole, mass)
    found = [_of_link(link, takes_solid(data)) for link in body.links if link.declared is not None]
    return solids.lumped(tuple(found)) if found else None


def mended_inertias(body: UrdfRigidBody, data: Mapping[str, Any]) -> str:
    """Return which inertias of the file had to be mended, and what is used; empty if none had to.

    Those that differ by less than four digits show are left out.
    """
    found: list[str] = []
    for link in body.links:
        if link.declared is None or (takes_solid(data) and (link.filled or has_own_mass(data))):
            continue
        given, used = (
            described(one, 4)
            for one in (link.declared.inertia, nearest_possible(link.declared.inertia))
        )
        if used != given:
            found.append(f"link '{link.name}' has {used} in place of {given}")
    return ", ".join(found)


def with_mass(inertial: Inertial, mass: float) -> Inertial:
    """Return the inertial of the same body with another density, so that it has this mass [kg]."""
    factor = mass / inertial.mass
    xx, xy, xz, yy, yz, zz = (factor * value for value in inertial.inertia)
    return Inertial(mass, inertial.centre, (xx, xy, xz, yy, yz, zz))


def _of_link(link: UrdfLink, is_solid: bool) -> Inertial:
    declared = link.declared
    assert declared is not None, "only links with a mass are passed"
    if is_solid and link.filled is not None:
        return with_mass(link.filled, declared.mass)
    return Inertial(declared.mass, declared.centre, nearest_possible(declared.inertia))
