"""Read the shapes and the inertia of an object, in its frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.read import solid_from
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import AnySolid, Inertial, Solid

if TYPE_CHECKING:
    from somo_cli.scene.mesh import MeshProperties
    from somo_cli.scene.urdf_rigid_body import UrdfRigidBody

PLACEHOLDER_MASS = 1.0  # kg, of objects that cannot move and so need no mass
_DEFAULT_MATERIAL = Material("object", (0.8, 0.6, 0.3, 1.0))


def object_link(data: Mapping[str, Any]) -> Link:
    """Return the only link of an object, from a mapping without errors."""
    found = _link(data)
    if "material_color" not in data:
        return found
    red, green, blue, opacity = map(float, data["material_color"])
    material = Material("object", (red, green, blue, opacity))
    return replace(found, shapes=tuple(replace(one, material=material) for one in found.shapes))


def _link(data: Mapping[str, Any]) -> Link:
    if data["shape_type"] == "mesh":
        return _link_of_meshes(data)
    if data["shape_type"] == "urdf":
        return _link_of_urdf(data)
    solid = solid_from_dimensions(data)
    mass = _mass(data, solid.volume)
    inertial = Inertial(mass, geometry.ZERO, solid.inertia(mass))
    return Link("object", inertial, (placed_shape(solid),))


def solid_from_dimensions(data: Mapping[str, Any]) -> Solid | Capsule | RoundedBox:
    """Return the solid of an object whose `shape_type` needs `dimensions` [m]."""
    dimensions = [float(value) for value in data["dimensions"]]
    if data["shape_type"] == "capsule":
        return Capsule(dimensions[0], dimensions[1])
    if data.get("edge_radius", 0) > 0:
        return RoundedBox(geometry.vector(dimensions), float(data["edge_radius"]))
    return solid_from(data["shape_type"], dimensions)


def measured_meshes(data: Mapping[str, Any]) -> list[MeshProperties]:
    """Return hulls and mass properties of each mesh of an object. Raises MeshError."""
    return [measured_mesh(data, one) for one in mesh_files(data["mesh"])]


def measured_mesh(data: Mapping[str, Any], file: Mapping[str, Any]) -> MeshProperties:
    """Return hulls and mass properties of one mesh file of an object. Raises MeshError."""
    from somo_cli.scene.mesh import mesh_properties

    scale, hulls = mesh_axis_factors(data), data.get("hulls")
    return mesh_properties(file["text"], file["source"], scale, hulls, file.get("pieces"))


def mesh_files(value: Any) -> list[Mapping[str, Any]]:
    """Return the files of the key `mesh`, whose value is one file or a list of files."""
    return value if isinstance(value, list) else [value]


def mesh_axis_factors(data: Mapping[str, Any]) -> geometry.Vector:
    """Return the scale factors of a mesh along its axes [-]."""
    scale = data.get("mesh_scale", 1)
    return geometry.vector(scale if isinstance(scale, list) else [scale] * 3)


def object_urdf_body(data: Mapping[str, Any]) -> UrdfRigidBody:
    """Return the rigid body that the URDF of an object describes, with the errors in the URDF."""
    from somo_cli.scene import urdf_rigid_body, urdf_xml
    from somo_cli.scene.mesh import MeshFile

    file = data["urdf"]
    names = urdf_xml.mesh_filenames(file["text"], file["source"])
    read = [
        MeshFile(one["source"], one["text"], one.get("pieces"))
        for one in file.get("meshes", ())
        if isinstance(one, Mapping)
    ]
    # `mesh_filenames` and `meshes` list the same files in the same order
    meshes = dict(zip(names, read, strict=True)) if len(read) == len(names) else {}
    text, source = file["text"], file["source"]
    return urdf_rigid_body.read_rigid_body(text, source, meshes, data.get("hulls"))


def mended_inertias(data: Mapping[str, Any]) -> str:
    """Return which inertias of an object had to be mended; see `object_inertia`."""
    if data["shape_type"] != "urdf":
        return ""
    from somo_cli.scene import object_inertia

    return object_inertia.mended_inertias(object_urdf_body(data), data)


def placed_shape(
    solid: AnySolid,
    position: geometry.Vector = geometry.ZERO,
    rpy: geometry.Vector = geometry.ZERO,
) -> Shape:
    """Return the solid as a shape at this position [m] and rpy [rad] in the object's frame."""
    return Shape(solid, position, rpy, _DEFAULT_MATERIAL, 1.0)


def _link_of_meshes(data: Mapping[str, Any]) -> Link:
    from somo_cli.scene.object_inertia import with_mass

    parts = measured_meshes(data)
    # only a fixed object may have an open mesh, and its mass does not matter
    inertials = [one.mesh_inertial or one.hull_inertial for one in parts]
    whole = solids.lumped(tuple(inertials))
    mass = _mass(data, whole.mass)
    shapes = tuple(placed_shape(hull) for one in parts for hull in one.hulls)
    return Link("object", with_mass(whole, mass), shapes)


def _link_of_urdf(data: Mapping[str, Any]) -> Link:
    from somo_cli.scene.object_inertia import urdf_inertial

    body = object_urdf_body(data)
    shapes = tuple(placed_shape(one.solid, one.position, one.rpy) for one in body.solids)
    inertial = urdf_inertial(body, data)
    if inertial is None:  # only a fixed object may have no mass
        ball = solids.Sphere(1.0).inertia(PLACEHOLDER_MASS)
        inertial = Inertial(PLACEHOLDER_MASS, geometry.ZERO, ball)
    return Link("object", inertial, shapes)


def _mass(data: Mapping[str, Any], volume: float) -> float:
    if "density" in data:
        return float(data["density"]) * volume
    return float(data.get("mass", PLACEHOLDER_MASS))
