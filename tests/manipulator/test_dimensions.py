from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import pytest

from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Acceleration,
    Angle,
    Damping,
    Dimension,
    InertiaTensor,
    Length,
    Mass,
    Number,
    Position,
    Scale,
    Stiffness,
    Time,
    Torque,
    scaled,
)
from tests.builders.definitions import EVERYTHING, chain_of

SCALES = [Scale(20), Scale(0.5, 3), Scale(1, 1000)]


@pytest.fixture(scope="module")
def chain() -> Chain:
    return chain_of(EVERYTHING)


@dataclass(frozen=True)
class RigidObject:
    name: str
    count: int
    angle: Angle
    length: Length
    mass: Mass
    stiffness: Stiffness
    damping: Damping
    time: Time
    pull: Acceleration
    place: Position
    path: tuple[Length, ...]
    choice: Length | None
    tensor: InertiaTensor | None
    part: Part | None


@dataclass(frozen=True)
class Part:
    torque: Torque
    factor: Number


def test_every_quantity_scales_by_its_dimension() -> None:
    value = RigidObject(
        "a", 2, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, (1.0, 2.0, 3.0), (1.0, 2.0), 1.0, None,
        Part(1.0, 7.0),
    )  # fmt: skip
    assert scaled(value, Scale(length=20, mass=3)) == RigidObject(
        "a", 2, 3.0, 20.0, 3.0, 1200.0, 1200.0, 1.0, 20.0, (20.0, 40.0, 60.0), (20.0, 40.0), 20.0,
        None, Part(1200.0, 7.0),
    )  # fmt: skip
    other = dataclasses.replace(value, choice=None, tensor=(1.0,) * 6, part=None)
    found = scaled(other, Scale(10))
    assert (found.choice, found.tensor, found.part) == (None, (100.0,) * 6, None)


@pytest.mark.parametrize(
    ("dimension", "factor"),
    [
        (Dimension(), 1.0),
        (Dimension(length=1), 20.0),
        (Dimension(mass=1), 3.0),
        (Dimension(time=1), 1.0),
        (Dimension(mass=1, length=1, time=-2), 60.0),
        (Dimension(mass=1, length=2, time=-2), 1200.0),
        (Dimension(length=-1), 0.05),
    ],
)
def test_the_factor_of_a_dimension(dimension: Dimension, factor: float) -> None:
    assert Scale(20, 3).factor(dimension) == pytest.approx(factor, rel=1e-15)


def test_scaling_by_one_is_the_identity(chain: Chain) -> None:
    assert scaled(chain, Scale()) == chain


@pytest.mark.parametrize("first", SCALES)
@pytest.mark.parametrize("second", SCALES)
def test_scales_compose(chain: Chain, first: Scale, second: Scale) -> None:
    both = Scale(first.length * second.length, first.mass * second.mass)
    in_turn = numbers(scaled(scaled(chain, first), second))
    assert in_turn == pytest.approx(numbers(scaled(chain, both)), rel=1e-14)


@pytest.mark.parametrize("scale", SCALES)
def test_dimensionless_groups_stay(chain: Chain, scale: Scale) -> None:
    assert groups(scaled(chain, scale), scale) == pytest.approx(groups(chain, Scale()), rel=1e-13)


@pytest.mark.parametrize("scale", SCALES)
def test_angles_rates_axes_and_names_stay(chain: Chain, scale: Scale) -> None:
    for before, after in zip(chain.joints, scaled(chain, scale).joints, strict=True):
        for name in ("name", "axis", "lower", "upper", "velocity", "neutral_position", "channel"):
            assert getattr(after, name) == getattr(before, name)


@dataclass(frozen=True)
class Bare:
    length: float


@dataclass(frozen=True)
class Nested:
    parts: tuple[Bare, ...]


@pytest.mark.parametrize("value", [Bare(1.0), Nested((Bare(1.0),)), Nested(())])
def test_a_bare_float_is_refused(value: object) -> None:
    with pytest.raises(TypeError, match="carries no dimension"):
        scaled(value, Scale(2))


def numbers(value: object) -> list[float]:
    """Return every float in a value, in a fixed order."""
    if isinstance(value, float):
        return [value]
    if isinstance(value, tuple):
        return [number for item in value for number in numbers(item)]
    if dataclasses.is_dataclass(value):
        fields = dataclasses.fields(value)
        return [number for field in fields for number in numbers(getattr(value, field.name))]
    return []


def groups(chain: Chain, scale: Scale) -> list[float]:
    """Return numbers that decide how the chain moves, whatever its size and weight."""
    mass = sum(link.inertial.mass for link in chain.links)
    gravity = 9.81 * scale.length  # per second squared; time is not scaled
    weight = mass * gravity * chain.length
    found = []
    for link, joint in zip(chain.links[1:], chain.joints, strict=True):
        found.append(joint.stiffness / weight)
        found.append(joint.friction / weight)
        found.append(joint.effort / weight)
        found.append(joint.damping**2 / (joint.stiffness * link.inertial.inertia[0]))
        found.append(joint.span / chain.length)
        found.append(link.inertial.inertia[3] / (link.inertial.mass * chain.length**2))
        found.append(link.inertial.mass / mass)
    return found
