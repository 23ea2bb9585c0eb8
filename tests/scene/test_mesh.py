"""Meshes to hulls and mass properties, against closed forms, and what is wrong with them."""

from __future__ import annotations

import numpy as np
import pytest

from somo_cli.manipulator.solids import Box
from somo_cli.scene import mesh
from somo_cli.scene.mesh import mesh_properties
from somo_cli.scene.mesh_parts import MeshError
from tests.builders.meshes import (
    BOX_CENTRE,
    BOX_CORNERS,
    BOX_FACES,
    BOX_SIZE,
    Faces,
    binary_stl,
    corners,
    obj,
)


def text_of(content: bytes) -> str:
    """As files reads what is not UTF-8."""
    return content.decode("utf-8", "surrogateescape")


@pytest.mark.parametrize(
    ("text", "source", "tolerance"),
    [
        (obj(BOX_CORNERS), "a.obj", 1e-9),
        (obj(BOX_CORNERS, [face[::-1] for face in BOX_FACES]), "inside_out.OBJ", 1e-9),
        (obj(BOX_CORNERS, [BOX_FACES[0][::-1], *BOX_FACES[1:]]), "one_face_turned.obj", 1e-9),
        (text_of(binary_stl(BOX_CORNERS)), "a.stl", 1e-5),
    ],
)
def test_a_box_is_the_box_that_it_is(text: str, source: str, tolerance: float) -> None:
    found = mesh_properties(text, source)
    volume = 0.06 * 0.04 * 0.02
    for solid in (found.mesh_inertial, found.hull_inertial):
        assert solid is not None
        assert solid.mass == pytest.approx(volume, rel=tolerance)
        assert solid.centre == pytest.approx(BOX_CENTRE, rel=tolerance)
        six = Box(BOX_SIZE).inertia(volume)
        assert solid.inertia == pytest.approx(six, rel=tolerance, abs=1e-9 * six[0])
    hull = found.hull
    distances = np.linalg.norm(np.array(hull.vertices)[:, None] - BOX_CORNERS, axis=2)
    assert len(hull.vertices) == 8
    assert distances.min(axis=0) == pytest.approx(np.zeros(8), abs=tolerance)
    assert hull.height == pytest.approx(0.02, rel=1e-5)
    points = np.array(hull.vertices)[np.array(hull.faces)]
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    assert (np.sum(normals * (points[:, 0] - BOX_CENTRE), axis=1) > 0).all()


def test_materials_normals_and_textures_make_no_difference() -> None:
    lines = ["mtllib nowhere.mtl", "o part", *obj(BOX_CORNERS, ()).splitlines()]
    lines += ["vt 0 0", "vt 1 1", "vn 0 0 1", "vn 1 0 0"]
    for number, face in enumerate(BOX_FACES):
        lines += [f"usemtl colour_{number % 3}", f"s {number}", f"g group_{number}"]
        lines += ["f " + " ".join(f"{1 + i}/{1 + i % 2}/{1 + number % 2}" for i in face)]
    found, plain = (
        mesh_properties("\n".join(lines), "a.obj"),
        mesh_properties(obj(BOX_CORNERS), "a.obj"),
    )
    assert found.reason == ""
    assert found.mesh_inertial is not None
    assert plain.mesh_inertial is not None
    assert found.mesh_inertial.mass == pytest.approx(plain.mesh_inertial.mass, rel=1e-12)
    assert found.mesh_inertial.inertia == pytest.approx(
        plain.mesh_inertial.inertia, rel=1e-9, abs=1e-18
    )


def test_a_mesh_is_scaled_along_its_axes() -> None:
    found = mesh_properties(obj(BOX_CORNERS), "a.obj", (1.0, 2.0, 0.5))
    assert found.mesh_inertial is not None
    assert found.mesh_inertial.centre == pytest.approx((0.1, 0.4, 0.15))
    assert found.mesh_inertial.inertia == pytest.approx(
        Box((0.06, 0.08, 0.01)).inertia(0.06 * 0.08 * 0.01), abs=1e-15
    )


def test_the_solid_is_that_of_the_faces_not_of_the_hull() -> None:
    # a box with a dent: the middle of its upper face is pushed down to its centre
    quads: Faces = [face for face in BOX_FACES if face != (4, 5, 7, 6)]
    dent: Faces = [(4, 5, 8), (5, 7, 8), (7, 6, 8), (6, 4, 8)]
    vertices = np.vstack([corners((2.0, 2.0, 2.0), (0.0, 0.0, 0.0)), [[0.0, 0.0, 0.0]]])
    found = mesh_properties(obj(vertices, [*quads, *dent]), "dent.obj")
    assert found.mesh_inertial is not None
    assert found.hull_inertial.mass == pytest.approx(8)
    assert found.mesh_inertial.mass == pytest.approx(8 - 4 / 3)  # a pyramid is missing
    # 8 · 0 = 20/3 z + 4/3 · 3/4
    assert found.mesh_inertial.centre == pytest.approx((0, 0, -0.15))
    assert len(found.hull.vertices) == 8


def test_an_open_mesh_has_a_hull_and_no_solid() -> None:
    found = mesh_properties(obj(BOX_CORNERS, BOX_FACES[1:]), "a.obj")
    assert len(found.hull.vertices) == 8
    assert found.mesh_inertial is None
    assert found.reason == "it is open: some edges belong to one face only"


@pytest.mark.parametrize(
    ("text", "source", "message"),
    [
        ("", "a.ply", "this is neither an OBJ nor an STL file"),
        ("", "a.obj", "it has no faces"),
        ("solid\n", "a.stl", "it has no faces"),
        (
            text_of(binary_stl(BOX_CORNERS)[:-20]),
            "a.stl",
            "it has no faces",
        ),
        ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3", "a.obj", "it has no faces"),
        (obj(BOX_CORNERS * np.inf), "a.obj", "one of its vertices is not finite"),
        (obj(BOX_CORNERS * [1, 1, 0]), "a.obj", "it is flat, so its hull encloses no volume"),
        (obj(BOX_CORNERS * [1, 0, 0]), "a.obj", "it is flat, so its hull encloses no volume"),
        (obj(BOX_CORNERS * 1e-6), "a.obj", "it is only 6e-08 m long"),
    ],
)
def test_what_nobody_can_use(text: str, source: str, message: str) -> None:
    with pytest.raises(MeshError) as caught:
        mesh_properties(text, source)
    assert str(caught.value) == message


def test_what_cannot_be_read() -> None:
    for text in (obj(BOX_CORNERS, [(0, 1, 99)]), "v one two three\nf 1 1 1"):
        with pytest.raises(MeshError, match=r"^this cannot be read: "):
            mesh_properties(text, "a.obj")


def test_more_vertices_than_the_engine_is_given() -> None:
    x = np.random.default_rng(0).normal(size=(mesh.MAX_HULL_VERTICES + 10, 3))
    ball = x / np.linalg.norm(x, axis=1)[:, None]
    faces = [(n, n + 1, n + 2) for n in range(len(ball) - 2)]
    with pytest.raises(MeshError, match="its hull has 10010 vertices; at most 10000 are allowed"):
        mesh_properties(obj(ball, faces), "a.obj")


def test_an_obj_has_a_bounded_number_of_parts() -> None:
    text = "v 0 0 0\n" + "".join(f"o part{index}\n g group\n" for index in range(501))
    with pytest.raises(MeshError, match="it has 1002 named parts; at most 1000 are allowed"):
        mesh_properties(text, "a.obj")
    with pytest.raises(MeshError, match="it has no faces"):
        mesh_properties(text.replace(" g group", "vg 1 1 1", 2), "a.obj")
