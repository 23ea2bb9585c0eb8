from __future__ import annotations

import math
import random

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Matrix, Tensor, Vector

POLES = [(0.3, math.pi / 2, 0.4), (-1.0, -math.pi / 2, 2.0), (0.0, math.pi / 2, 0.0)]


def vectors(count: int, size: float = 1.0) -> list[Vector]:
    dice = random.Random(1)
    return [tuple(dice.uniform(-size, size) for _ in range(3)) for _ in range(count)]


def full(tensor: Tensor) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@pytest.fixture(params=[*vectors(20, 3.0), *POLES, (0.0, 0.0, 0.0), (math.pi, 0.0, math.pi)])
def rpy(request: pytest.FixtureRequest) -> Vector:
    return request.param


@pytest.fixture
def rotation(rpy: Vector) -> Matrix:
    return geometry.rotation_from_rpy(rpy)


def test_vectors() -> None:
    a, b = (1.0, 2.0, 3.0), (0.5, -1.0, 4.0)
    assert geometry.add(a, b) == (1.5, 1.0, 7.0)
    assert geometry.subtract(a, b) == (0.5, 3.0, -1.0)
    assert geometry.norm((2.0, 3.0, 6.0)) == 7.0
    assert geometry.unit((0.0, -4.0, 0.0)) == (0.0, -1.0, 0.0)


def test_roll_pitch_yaw_is_that_of_urdf(rpy: Vector, rotation: Matrix) -> None:
    assert np.allclose(rotation, Rotation.from_euler("xyz", rpy).as_matrix(), atol=1e-15)


def test_roll_pitch_yaw_returns(rotation: Matrix) -> None:
    again = geometry.rotation_from_rpy(geometry.rpy_from_rotation(rotation))
    assert np.allclose(again, rotation, atol=1e-15)


@pytest.mark.parametrize("closeness", [0.0, 1e-12, 1e-9, 1e-8, 1e-6])
def test_roll_pitch_yaw_returns_near_its_poles(closeness: float) -> None:
    rotation = geometry.rotation_from_rpy((0.7, math.pi / 2 - closeness, -0.2))
    again = geometry.rotation_from_rpy(geometry.rpy_from_rotation(rotation))
    assert np.allclose(again, rotation, atol=2e-8)


def test_quaternions_are_unit_have_a_scalar_that_is_not_negative_and_return(
    rotation: Matrix,
) -> None:
    quaternion = geometry.quaternion_from_rotation(rotation)
    assert math.hypot(*quaternion) == pytest.approx(1, abs=1e-15)
    assert quaternion[3] >= 0
    expected = Rotation.from_matrix(rotation).as_quat()
    assert abs(np.dot(quaternion, expected)) == pytest.approx(1, abs=1e-14)
    assert np.allclose(geometry.rotation_from_quaternion(quaternion), rotation, atol=1e-14)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])
def test_quaternions_of_half_turns(axis: Vector) -> None:
    turn = geometry.rotation_about(axis, math.pi)
    quaternion = geometry.quaternion_from_rotation(turn)
    assert np.allclose(np.abs(quaternion), [*axis, 0.0], atol=1e-15)


@pytest.mark.parametrize("vector", vectors(20, 2.0))
def test_rotation_about_an_axis(vector: Vector) -> None:
    angle = geometry.norm(vector)
    found = geometry.rotation_about(geometry.unit(vector), angle)
    assert np.allclose(found, Rotation.from_rotvec(vector).as_matrix(), atol=1e-15)


def test_products(rotation: Matrix) -> None:
    other = geometry.rotation_from_rpy((0.1, 0.2, 0.3))
    vector = (0.4, -0.5, 0.6)
    assert np.allclose(geometry.multiply(rotation, other), np.array(rotation) @ other, atol=1e-15)
    assert np.allclose(geometry.rotate(rotation, vector), np.array(rotation) @ vector, atol=1e-15)


def test_a_tensor_turns_with_its_body(rotation: Matrix) -> None:
    tensor = (1.0, 0.1, -0.2, 2.0, 0.3, 2.5)
    turned = np.array(rotation) @ full(tensor) @ np.transpose(rotation)
    assert np.allclose(full(geometry.rotated_tensor(tensor, rotation)), turned, atol=1e-14)


@pytest.mark.parametrize("at", vectors(5))
def test_the_inertia_of_a_point(at: Vector) -> None:
    expected = 0.7 * (np.dot(at, at) * np.eye(3) - np.outer(at, at))
    assert np.allclose(full(geometry.point_mass_inertia(0.7, at)), expected, atol=1e-15)


@pytest.mark.parametrize(
    "tensor",
    [
        (1.0, 0.1, -0.2, 2.0, 0.3, 2.5),
        (1e-9, 2e-10, 0.0, 3e-9, -1e-10, 2e-9),
        (2.0, 0.0, 0.0, 2.0, 0.0, 2.0),
        (2.0, 0.0, 0.0, 2.0, 0.0, 5.0),
        (5.0, 0.0, 0.0, 2.0, 0.0, 2.0),
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        (1.0, 5.0, 0.0, 1.0, 0.0, 1.0),
    ],
)
def test_principal_moments(tensor: Tensor) -> None:
    expected = np.linalg.eigvalsh(full(tensor))
    found = geometry.principal_moments(tensor)
    assert np.allclose(found, expected, rtol=1e-12, atol=1e-14 * np.abs(expected).max())
