"""The joint torques of loads on a chain whose base is held or led, as fast as a step needs them.

A load is a wrench on a link. Those that keep their direction are turned outwards, joint by joint,
into the axes of their links; then all are carried inwards, as in the recursive Newton-Euler
algorithm (Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 5.3), and every joint takes
its axis' part of the moment.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain, Joint
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.simulation.dynamics.straight_code import ZERO_NAMES, Names, StraightCode

_FEW = 2
"""Loads on a limb up to which each is turned by itself."""


@dataclass(frozen=True, slots=True)
class CarriedLoad:
    """A wrench on a point of a link, the point in the link's frame.

    `has_force` and `has_moment` say which parts can differ from zero: x, y and z of the force, in
    the axes of the base, or of the link if the load turns with it; then of the moment.
    """

    link: int
    point: Vector
    turns_with_link: bool
    parts: tuple[bool, bool, bool, bool, bool, bool]


LoadTorques = Callable[[Sequence[float], Sequence[float]], tuple[float, ...]]
"""Returns the torque of every joint from the joint angles and the parts of all loads, 6 each."""


def load_torques(chain: Chain, loads: Sequence[CarriedLoad]) -> LoadTorques:
    """Return the function of joint angles [rad] and loads that gives the joint torques.

    The loads are six numbers each, in their order: force and moment, in the axes of the base or of
    the link. Units are those of the chain.
    """
    code = StraightCode()
    names = [f"w{number}" for number in range(6 * len(loads))]
    code.add(f"{', '.join(f'q{number}' for number in range(len(chain.joints)))}, = q")
    code.add(f"{', '.join(names)}, = w")
    torques = [""] * len(chain.joints)
    for limb in chain.backbones:
        own = [
            (load, _parts(names, number, load))
            for number, load in enumerate(loads)
            if limb.first < load.link <= limb.last
        ]
        if own:
            _add_limb(code, chain, limb.first, own, torques)
    return code.function("q, w", torques)


def _parts(names: Sequence[str], number: int, load: CarriedLoad) -> tuple[Names, Names]:
    own = [names[6 * number + i] if load.parts[i] else "" for i in range(6)]
    return (own[0], own[1], own[2]), (own[3], own[4], own[5])


def _add_limb(
    code: StraightCode,
    chain: Chain,
    first: int,
    loads: Sequence[tuple[CarriedLoad, tuple[Names, Names]]],
    torques: list[str],
) -> None:
    way = range(first, max(load.link for load, _ in loads))
    turns = {number: _Turn(code, chain.joints[number], number) for number in way}
    outwards: dict[int, tuple[Names, Names]] = {}
    if len(loads) > _FEW:
        turned = _turned_together(code, turns, loads)
    else:
        turned = _turned_apart(turns, first, loads, outwards)
    # the force of a lone load that keeps its direction is known in the axes of every link
    is_known = len(loads) == 1 and bool(outwards)
    force, moment = ZERO_NAMES, ZERO_NAMES
    for number in reversed(way):
        joint = chain.joints[number]
        force, moment = _with_loads(code, force, moment, number + 1, turned)
        torques[number] = code.dot(joint.axis, moment)
        if joint.parent != 0:
            force = outwards[number][0] if is_known else turns[number].inwards(force)
            moment = code.with_cross(turns[number].inwards(moment), joint.origin, force)


def _with_loads(
    code: StraightCode,
    force: Names,
    moment: Names,
    link: int,
    loads: Sequence[tuple[CarriedLoad, tuple[Names, Names]]],
) -> tuple[Names, Names]:
    """Return a wrench about the origin of a link with those of all loads on it added."""
    for load, (own_force, own_moment) in loads:
        if load.link == link:
            moment = code.plus(moment, code.with_cross(own_moment, load.point, own_force))
            force = code.plus(force, own_force)
    return force, moment


def _outwards(
    turns: dict[int, _Turn], first: int, link: int, wrench: tuple[Names, Names]
) -> dict[int, tuple[Names, Names]]:
    """Return a wrench in the axes of each link of a limb up to its own, by number of the link."""
    found = {}
    for number in range(first, link):
        force, moment = wrench
        wrench = turns[number].outwards(force), turns[number].outwards(moment)
        found[number + 1] = wrench
    return found


def _turned_apart(
    turns: dict[int, _Turn],
    first: int,
    loads: Sequence[tuple[CarriedLoad, tuple[Names, Names]]],
    outwards: dict[int, tuple[Names, Names]],
) -> list[tuple[CarriedLoad, tuple[Names, Names]]]:
    """Return each load with its wrench in the axes of its link; `outwards` gets those on the way.

    With several loads they are those of the last one.
    """
    found = []
    for load, wrench in loads:
        if not load.turns_with_link:
            outwards |= _outwards(turns, first, load.link, wrench)
            wrench = outwards[load.link]
        found.append((load, wrench))
    return found


def _turned_together(
    code: StraightCode,
    turns: dict[int, _Turn],
    loads: Sequence[tuple[CarriedLoad, tuple[Names, Names]]],
) -> list[tuple[CarriedLoad, tuple[Names, Names]]]:
    """Return each load with its wrench in the axes of its link.

    The axes of the base are turned outwards instead of each wrench: the code of many loads grows
    with their number, not with that times the number of joints.
    """
    axes: list[Names] = [("1.0", "", ""), ("", "1.0", ""), ("", "", "1.0")]
    by_link = {}
    for number in turns:
        axes = [turns[number].outwards(axis) for axis in axes]
        by_link[number + 1] = axes
    found = []
    for load, wrench in loads:
        if not load.turns_with_link:
            force, moment = (_in_axes(code, by_link[load.link], part) for part in wrench)
            wrench = force, moment
        found.append((load, wrench))
    return found


def _in_axes(code: StraightCode, axes: Sequence[Names], vector: Names) -> Names:
    x, y, z = (
        code.total((1, (part, axis[i])) for part, axis in zip(vector, axes, strict=True))
        for i in range(3)
    )
    return (x, y, z)


class _Turn:
    """Turns vectors between the axes of the parent and of the child of a joint."""

    def __init__(self, code: StraightCode, joint: Joint, number: int) -> None:
        self._code = code
        code.add(f"s{number} = sin(q{number}); c{number} = cos(q{number})")
        self._about = (joint.axis, f"c{number}", f"s{number}")
        self._mount: Matrix | None = None
        if joint.rpy != geometry.ZERO:
            self._mount = geometry.rotation_from_rpy(joint.rpy)

    def outwards(self, vector: Names) -> Names:
        """Return a vector of the parent's axes in the child's."""
        if self._mount is not None:
            vector = self._code.rotated(geometry.transposed(self._mount), vector)
        return self._code.turned(vector, *self._about, -1)

    def inwards(self, vector: Names) -> Names:
        """Return a vector of the child's axes in the parent's."""
        vector = self._code.turned(vector, *self._about, 1)
        return vector if self._mount is None else self._code.rotated(self._mount, vector)
