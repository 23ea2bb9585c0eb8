"""Bodies and objects that touch, as one: what forces at the points of contact do to them."""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Mapping, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.pressing import ContactReader, Pair, PressingForces, PressingPoints
from somo_cli.simulation.integrator.contact_change import (
    SLIDING,
    STICKING,
    ContactProblem,
    Surfaces,
)
from somo_cli.simulation.integrator.contact_coordinates import Part

TURNED = 0.01  # by which normals may turn [rad] until the geometry of contact is renewed, and by
# which joints may have turned
LENIENT = 1 + 4e-5  # times the limit of friction, squared: what counts as within it
MOVED = 0.02  # likewise points among themselves, over their distances


class CoupledContact:
    """The points that press, and the parts there; the geometry is that of when it was made."""

    def __init__(
        self,
        keys: Sequence[Hashable],
        points: PressingPoints,
        kept: Sequence[int],
        parts: Sequence[tuple[int, Part]],
        reader: ContactReader,
        step: float,
    ) -> None:
        """Take points, which of them are `kept`, and the parts that they touch, by number."""
        self.keys = keys
        self._points = points
        self._kept = list(kept)
        self.is_void = not kept
        """Whether no body with joints is pressed, nor what it presses."""
        self._takes_all = len(kept) == len(keys)
        self._parts = [part for _, part in parts]
        self._step = step
        self._normals = points.normals[self._kept]
        self._lay_down([part.size for part in self._parts], len(kept))
        self._angles = [part.angles() for part in self._parts]
        if not kept:
            return
        self._jacobian = self._make_jacobian([number for number, _ in parts])
        brought = np.concatenate(
            [
                part.response(self._jacobian[:, where].T)
                for part, where in zip(self._parts, self._wheres, strict=True)
            ]
        )
        driven: list[int] = []
        self._outputs: list[tuple[int, slice]] = []
        at = 0
        for (number, part), where in zip(parts, self._wheres, strict=True):
            if part.joints:
                driven += range(where.start, where.start + part.joints)
                self._outputs.append((number, slice(at, at + part.joints)))
                at += part.joints
        self._joints = at
        self._brought_to_joints = brought[driven]
        pairs = [points.pairs[index] for index in kept]
        self._surfaces = _surfaces(pairs, reader, step)
        self._problem = ContactProblem(
            self._jacobian @ brought, self._normals, self._surfaces, step
        )
        # closing velocities from the coordinates, to be added to gaps
        normal_rows = np.einsum(
            "mi,mij->mj", self._normals, self._jacobian.reshape(len(kept), 3, -1)
        )
        self._closing = step * normal_rows

    def _lay_down(self, sizes: Sequence[int], points: int) -> None:
        """Make the vector that the changes are linear in: forces, targets, coming coordinates."""
        ends = np.cumsum([0, *sizes]).tolist()
        self._wheres = [slice(*pair) for pair in itertools.pairwise(ends)]
        self._input: Array = np.zeros(5 * points + ends[-1])
        parts = np.split(self._input, np.array([3, 4, 5]) * points)
        self._forces, self._gaps, self._overlaps, self._coming = parts
        self._told = self._input[: 4 * points]
        self._zero: Array = np.zeros(points)
        self._now: Array = np.zeros(ends[-1])
        self._states: bytes = b""

    def is_still(self, points: PressingPoints) -> bool:
        """Whether the geometry is still good where the same links press."""
        old = self._points
        if np.abs(points.normals - old.normals).max() > TURNED:
            return False
        spread = old.on_first - old.on_first[0]
        moved = points.on_first - points.on_first[0] - spread
        if np.abs(moved).max() > MOVED * np.abs(spread).max():
            return False
        return all(
            np.abs(part.angles() - angles).max(initial=0.0) <= TURNED
            for part, angles in zip(self._parts, self._angles, strict=True)
        )

    def renew(self) -> None:
        """Have the operators made anew: friction that slides depends on the velocity."""
        if any(self._states):
            self._states = b""

    def changes(self, pressing: PressingForces) -> Mapping[int, Array]:
        """Return what the coming change of contact forces adds to the accelerations of bodies."""
        if self.is_void:
            return {}
        for part, where in zip(self._parts, self._wheres, strict=True):
            part.write(self._now[where], self._coming[where])
        self._told[:], slides = self._of_kept(pressing)
        np.add(self._closing.dot(self._now), self._gaps, self._gaps)
        np.minimum(self._gaps, self._zero, out=self._overlaps)
        states = bytes(slides)
        if states != self._states:
            self._make_operator(states)
        out: Array = self._operator.dot(self._input)
        if _breaks_a_law(out[self._joints :].tolist()):
            change = self._solve_anew(states)
            if change is None:
                return {}
            out = self._brought_to_joints.dot(change)
        return {number: out[where] for number, where in self._outputs}

    def _of_kept(self, pressing: PressingForces) -> tuple[Sequence[float], Sequence[bool]]:
        """Return forces, then gaps, and which points slide, of the points that are followed."""
        _, forces, gaps, is_sliding = pressing
        if self._takes_all:
            return [*forces, *gaps], is_sliding
        kept = self._kept
        followed = [number for index in kept for number in forces[3 * index : 3 * index + 3]]
        followed += [gaps[index] for index in kept]
        return followed, [is_sliding[index] for index in kept]

    def _make_operator(self, states: bytes) -> None:
        """Lay down what is linear in the input: accelerations of joints, and forces to check."""
        m, h = len(states), self._step
        forces = self._forces.reshape(-1, 3)
        velocities = self._jacobian.dot(self._now).reshape(-1, 3)
        by_need, by_force, seen = self._problem.operators(_coded(states), forces, velocities)
        by_target = np.einsum("imj,mj->im", by_need.reshape(3 * m, m, 3), self._normals)
        by_target /= h * h
        by_overlap = by_target * (1 - self._surfaces.recovery)
        change = np.concatenate(
            [by_force, -by_target, by_overlap, by_need @ self._jacobian / -h], axis=1
        )
        to_joints = self._brought_to_joints @ change
        change[:, : 3 * m] += np.eye(3 * m)
        self._operator: Array = np.concatenate([to_joints, seen @ change])
        self._states = states

    def _solve_anew(self, states: bytes) -> Array | None:
        velocities, free = (
            self._jacobian.dot(one).reshape(-1, 3) for one in (self._now, self._coming)
        )
        forces = self._forces.reshape(-1, 3)
        kept = (1 - self._surfaces.recovery) * self._overlaps
        target = (kept - self._gaps) / self._step
        return self._problem.solve(_coded(states), forces, velocities, free, target)

    def _make_jacobian(self, numbers: Sequence[int]) -> Array:
        """Return how the points on first sides move against those on second ones, (3 m, size)."""
        points, kept = self._points, self._kept
        jacobian: Array = np.zeros((len(kept), 3, len(self._now)))
        for number, part, where in zip(numbers, self._parts, self._wheres, strict=True):
            rows, signs, links, places = [], [], [], []
            for row, index in enumerate(kept):
                sides = zip((1.0, -1.0), (points.on_first, points.on_second), strict=True)
                for (body, link), (sign, at) in zip(points.pairs[index], sides, strict=True):
                    if body == number:
                        rows.append(row)
                        signs.append(sign)
                        links.append(link)
                        places.append(at[index])
            own = part.jacobian(np.array(links), np.array(places)) * np.array(signs)[:, None, None]
            np.add.at(jacobian[:, :, where], rows, own)
        return jacobian.reshape(3 * len(kept), -1)


def _breaks_a_law(seen: Sequence[float]) -> bool:
    """Whether of three numbers a point the first is negative, or smaller than the other two."""
    for at in range(0, len(seen), 3):
        normal, one, two = seen[at : at + 3]
        if normal < 0 or one * one + two * two > LENIENT * normal * normal:
            return True
    return False


def _coded(states: bytes) -> Array:
    return np.where(np.frombuffer(states, dtype=np.uint8), SLIDING, STICKING)


def _surfaces(pairs: Sequence[Pair], reader: ContactReader, step: float) -> Surfaces:
    """Return the surfaces at points as the engine takes them."""
    frictions, recoveries, compliances = [], [], []
    for pair in pairs:
        known = reader.pair(pair)
        recovery, compliance = reader.recovery, 0.0
        if known.compliance is not None:
            stiffness, damping = known.compliance
            whole = step * stiffness + damping
            recovery, compliance = step * stiffness / whole, 1 / whole
        frictions.append(known.friction)
        recoveries.append(recovery)
        compliances.append(compliance)
    return Surfaces(np.array(frictions), np.array(recoveries), np.array(compliances))
