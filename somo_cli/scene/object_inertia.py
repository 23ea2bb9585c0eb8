"""Mass and inertia of an object that a URDF describes: the file's, or those of its shapes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.manipulator import solids
from somo_cli.manipulator.solids import Inertial
from somo_cli.scene.possible_inertia import nearest_possible
from somo_cli.scene.urdf_rigid_body import UrdfLink, UrdfRigidBody


def takes_solid(data: Mapping[str, Any]) -> bool:
    """Whether an object takes the inertia of its shapes in place of the file's."""
    return bool(data.get("inertia") == "solid")


def needs_no_mass(data: Mapping[str, Any]) -> bool:
    """Whether the object says its mass itself, so that no mass of the file counts."""
    return "mass" in data or "density" in data


def urdf_inertial(body: UrdfRigidBody, data: Mapping[str, Any]) -> Inertial | None:
    """Return the inertial of the whole in the frame of the root link; None without any mass.

    With `inertia: solid` the mass of each link fills its shapes evenly; with a mass or a density
    of the object, that fills the shapes of all. Inertias of the file are the nearest possible.
    """
    if takes_solid(data) and needs_no_mass(data):
        parts = [link.filled for link in body.links if link.filled is not None]
        if not parts:
            return None
        whole = solids.lumped(tuple(parts))
        mass = float(data["mass"]) if "mass" in data else float(data["density"]) * whole.mass
        return with_mass(whole, mass)
    found = [_of_link(link, takes_solid(data)) for link in body.links if link.declared is not None]
    return solids.lumped(tuple(found)) if found else None


def with_mass(inertial: Inertial, mass: float) -> Inertial:
    """Return the same body of another density, with this mass [kg]."""
    factor = mass / inertial.mass
    xx, xy, xz, yy, yz, zz = (factor * value for value in inertial.inertia)
    return Inertial(mass, inertial.centre, (xx, xy, xz, yy, yz, zz))


def _of_link(link: UrdfLink, is_solid: bool) -> Inertial:
    declared = link.declared
    assert declared is not None, "only links with a mass are asked"
    if is_solid and link.filled is not None:
        return with_mass(link.filled, declared.mass)
    return Inertial(declared.mass, declared.centre, nearest_possible(declared.inertia))
