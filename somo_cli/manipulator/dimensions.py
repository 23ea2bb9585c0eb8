"""Quantities with their dimensions, the world scale, and scaling of dataclasses.

A quantity is a float whose annotation has its dimension. `scaled` reads the annotations of a frozen
dataclass and of the dataclasses in it. It refuses a plain `float`, so that no field can be
forgotten; numbers that do not scale are `Angle` and `Number`.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, TypeVar


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of mass, length and time."""

    mass: int = 0
    length: int = 0
    time: int = 0


Number = Annotated[float, Dimension()]  # 1
Angle = Annotated[float, Dimension()]  # rad
Time = Annotated[float, Dimension(time=1)]  # s
AngularRate = Annotated[float, Dimension(time=-1)]  # rad/s
Length = Annotated[float, Dimension(length=1)]  # m
Velocity = Annotated[float, Dimension(length=1, time=-1)]  # m/s
Acceleration = Annotated[float, Dimension(length=1, time=-2)]  # m/s²
Mass = Annotated[float, Dimension(mass=1)]  # kg
Inertia = Annotated[float, Dimension(mass=1, length=2)]  # kg·m²
Force = Annotated[float, Dimension(mass=1, length=1, time=-2)]  # N
Torque = Annotated[float, Dimension(mass=1, length=2, time=-2)]  # N·m
TorquePerPressure = Annotated[float, Dimension(length=3)]  # N·m/Pa
Stiffness = Annotated[float, Dimension(mass=1, length=2, time=-2)]  # N·m/rad
ContactStiffness = Annotated[float, Dimension(mass=1, time=-2)]  # N/m
ContactDamping = Annotated[float, Dimension(mass=1, time=-1)]  # N·s/m
Damping = Annotated[float, Dimension(mass=1, length=2, time=-1)]  # N·m·s/rad

Position = tuple[Length, Length, Length]
Direction = tuple[Number, Number, Number]
RollPitchYaw = tuple[Angle, Angle, Angle]
InertiaTensor = tuple[Inertia, Inertia, Inertia, Inertia, Inertia, Inertia]
"""ixx, ixy, ixz, iyy, iyz, izz"""


@dataclass(frozen=True, slots=True)
class Scale:
    """The world scale: one metre is `length` engine units, one kilogram is `mass` of them.

    Time is not scaled. Forces scale with length * mass; torques, stiffness, damping and inertia
    with length² * mass; angles do not scale.
    """

    length: float = 1.0
    mass: float = 1.0

    def factor(self, dimension: Dimension) -> float:
        """Return engine units per SI unit of a quantity of this dimension."""
        return float(self.length**dimension.length * self.mass**dimension.mass)

    def described(self) -> str:
        """Return the factors as text; the mass factor only if it is not 1."""
        of_mass = f" (mass {self.mass:g})" if self.mass != 1 else ""
        return f"{self.length:g}{of_mass}"


Quantities = TypeVar("Quantities")
_Scaler = Callable[[Any, Scale], Any]


def scaled(quantities: Quantities, scale: Scale) -> Quantities:
    """Return a dataclass of quantities in SI, converted to the units of a scale.

    Raises TypeError for a field whose annotation has no dimension.
    """
    kind: Any = type(quantities)
    return typing.cast(Quantities, _scaler(kind)(quantities, scale))


@cache
def _scaler(hint: Any) -> _Scaler:
    origin = typing.get_origin(hint)
    if origin is Annotated:
        return _quantity_scaler(hint)
    if origin is tuple:
        return _tuple_scaler(typing.get_args(hint))
    if origin in (typing.Union, types.UnionType):
        return _union_scaler(typing.get_args(hint))
    if dataclasses.is_dataclass(hint):
        return _dataclass_scaler(typing.cast(type, hint))
    if hint in (int, str, bool, type(None)) or origin is typing.Literal:
        return _unchanged
    raise TypeError(f"{hint!r} carries no dimension")


def _unchanged(value: Any, scale: Scale) -> Any:
    return value


def _quantity_scaler(hint: Any) -> _Scaler:
    dimension = next(item for item in hint.__metadata__ if isinstance(item, Dimension))
    if dimension.length == 0 and dimension.mass == 0:
        return _unchanged
    return lambda value, scale: value * scale.factor(dimension)


def _tuple_scaler(items: tuple[Any, ...]) -> _Scaler:
    if len(items) == 2 and items[1] is Ellipsis:
        each = _scaler(items[0])
        if each is _unchanged:
            return _unchanged
        return lambda value, scale: tuple([each(item, scale) for item in value])
    scalers = tuple(_scaler(item) for item in items)
    if all(one is _unchanged for one in scalers):
        return _unchanged
    return lambda value, scale: tuple(
        one(item, scale) for one, item in zip(scalers, value, strict=True)
    )


def _union_scaler(options: tuple[Any, ...]) -> _Scaler:
    quantities = [option for option in options if typing.get_origin(option) is Annotated]
    by_type = {option: _scaler(option) for option in options if isinstance(option, type)}

    def scale_union(value: Any, scale: Scale) -> Any:
        if isinstance(value, float) and quantities:
            return _scaler(quantities[0])(value, scale)
        if type(value) in by_type:
            return by_type[type(value)](value, scale)
        others = [option for option in options if typing.get_origin(option) is tuple]
        return _scaler(others[0])(value, scale)

    return scale_union


def _dataclass_scaler(kind: type) -> _Scaler:
    hints = typing.get_type_hints(kind, include_extras=True)
    fields = {field.name: _scaler(hints[field.name]) for field in dataclasses.fields(kind)}

    def scale_dataclass(value: Any, scale: Scale) -> Any:
        return kind(**{name: one(getattr(value, name), scale) for name, one in fields.items()})

    return scale_dataclass
