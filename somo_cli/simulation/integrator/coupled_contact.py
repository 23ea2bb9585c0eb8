"""Bodies and objects that touch, as one: what forces at the points of contact do to them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.cross_products import skew_matrices
from somo_cli.simulation.engine.pressing import ContactReader, PressingForces, PressingPoints
from somo_cli.simulation.integrator.contact_change import (
    ContactProblem,
    Surfaces,
    rows_of_points,
)
from somo_cli.simulation.integrator.contact_coordinates import Part
from somo_cli.simulation.integrator.contact_states import SLIDING

TURNED = 0.01  # by which normals may turn [rad] until the geometry of contact is renewed, and by
# which joints may have turned
LENIENT = 1 + 4e-5  # times the limit of friction, squared: what counts as within it
MOVED = 0.02  # likewise points among themselves, over their distances


class CoupledContact:
    """Points that press, and the parts there; the geometry is that of when it was made."""

    def __init__(
        self,
        points: PressingPoints,
        parts: Sequence[tuple[int, Part]],
        reader: ContactReader,
        step: float,
    ) -> None:
        """Take points, and the parts that they touch, by number."""
        self._points = points
        self._parts = [part for _, part in parts]
        self._step = step
        self._lay_down([part.size for part in self._parts], len(points.pairs))
        spread = float(np.abs(points.on_first - points.on_first[0]).max())
        self._per_spread = TURNED / (MOVED * spread) if spread > 0 else 0.0
        self._placed = self._place(points)
        self._axes = _axes(points.normals)
        self._surfaces = _surfaces(points, reader, step)
        self._rows = rows_of_points(self._surfaces.friction)
        whole = self._make_jacobian([number for number, _ in parts])
        self._jacobian = whole[self._rows]
        frictions: list[float] = self._surfaces.friction.tolist()
        self._limits = [one * one * LENIENT for one in frictions]
        compliance = self._lay_responses([number for number, _ in parts])
        self._problem = ContactProblem(compliance, self._surfaces, step)
        # closing velocities from the coordinates, to be added to gaps
        self._closing: Array = step * whole[::3]
        self._operators: dict[bytes, Array] = {}
        self._passing: list[bytes] = []  # states in which the operator depends on the velocity

    def _lay_down(self, sizes: Sequence[int], points: int) -> None:
        """Make the vector that the changes are linear in: forces, targets, coming coordinates."""
        ends = list(itertools.accumulate(sizes, initial=0))
        self._wheres = [slice(*pair) for pair in itertools.pairwise(ends)]
        self._input: Array = np.zeros(5 * points + ends[-1])
        one, two, three = 3 * points, 4 * points, 5 * points
        self._forces, self._gaps = self._input[:one], self._input[one:two]
        self._overlaps, self._coming = self._input[two:three], self._input[three:]
        self._told = self._input[:two]
        self._zero: Array = np.zeros(points)
        self._now: Array = np.zeros(ends[-1])
        self._coordinates = [(self._now[where], self._coming[where]) for where in self._wheres]

    def _lay_responses(self, numbers: Sequence[int]) -> Array:
        """Keep how forces at points accelerate joints, and return the compliance of points."""
        brought = np.concatenate(
            [
                part.response(self._jacobian[:, where].T)
                for part, where in zip(self._parts, self._wheres, strict=True)
            ]
        )
        driven: list[Array] = []
        self._outputs: list[tuple[int, slice]] = []
        at = 0
        for number, part, where in zip(numbers, self._parts, self._wheres, strict=True):
            if part.joints:
                driven.append(brought[where.start : where.start + part.joints])
                self._outputs.append((number, slice(at, at + part.joints)))
                at += part.joints
        self._joints = at
        self._brought_to_joints: Array = np.concatenate(driven)
        compliance: Array = self._jacobian.dot(brought)
        return compliance

    def is_still(self, points: PressingPoints) -> bool:
        """Whether the geometry is still good where the same links press."""
        change = self._place(points) - self._placed
        return bool(change.max() <= TURNED and change.min() >= -TURNED)

    def _place(self, points: PressingPoints) -> Array:
        """Return what may change by TURNED: joint angles, normals, and where points are."""
        among = (points.on_first - points.on_first[0]) * self._per_spread
        angles = [part.angles() for part in self._parts]
        return np.concatenate([*angles, points.normals.ravel(), among.ravel()])

    def renew(self) -> None:
        """Have the operators made anew: friction that slides depends on the velocity."""
        for states in self._passing:
            del self._operators[states]
        self._passing.clear()

    def changes(self, pressing: PressingForces) -> Mapping[int, Array]:
        """Return what the coming change of contact forces adds to the accelerations of bodies."""
        for part, (now, coming) in zip(self._parts, self._coordinates, strict=True):
            part.write(now, coming)
        forces, gaps, is_sliding = pressing
        self._told[:] = forces + gaps
        gaps_here = self._gaps
        gaps_here += self._closing.dot(self._now)
        np.minimum(gaps_here, self._zero, out=self._overlaps)
        states = bytes(is_sliding)  # of STICKING and SLIDING
        operator = self._operators.get(states)
        if operator is None:
            operator = self._make_operator(states)
        out: Array = operator.dot(self._input)
        if self._breaks_a_law(out[self._joints :].tolist(), is_sliding):
            change = self._solve_anew(states)
            if change is None:
                return {}
            out = self._brought_to_joints.dot(change)
        return {number: out[where] for number, where in self._outputs}

    def _breaks_a_law(self, whole: Sequence[float], is_sliding: Sequence[bool]) -> bool:
        """Whether a normal force is negative, or friction that sticks beyond its limit."""
        for limit, at, slides in zip(self._limits, self._problem.normals, is_sliding, strict=True):
            normal = whole[at]
            if normal < 0:
                return True
            if not slides:
                one, two = whole[at + 1], whole[at + 2]
                if one * one + two * two > limit * normal * normal:
                    return True
        return False

    def _make_operator(self, states: bytes) -> Array:
        """Return what is linear in the input: accelerations of joints, then whole forces."""
        h = self._step
        velocities = self._jacobian.dot(self._now)
        by_need, by_force = self._problem.operators(states, self._forces_in_axes(), velocities)
        by_target = by_need[:, self._problem.normals] / (h * h)
        change = np.concatenate(
            [
                self._from_world(by_force),
                -by_target,
                by_target * (1 - self._surfaces.recovery),
                by_need.dot(self._jacobian) / -h,
            ],
            axis=1,
        )
        to_joints = self._brought_to_joints.dot(change)
        change[:, : len(self._forces)] += self._from_world(np.eye(len(self._rows)))
        operator: Array = np.concatenate([to_joints, change])
        if any(
            one == SLIDING and limit > 0 for one, limit in zip(states, self._limits, strict=True)
        ):
            self._passing.append(states)
        self._operators[states] = operator
        return operator

    def _solve_anew(self, states: bytes) -> Array | None:
        target = (1 - self._surfaces.recovery) * self._overlaps - self._gaps
        return self._problem.solve(
            states,
            self._forces_in_axes(),
            self._jacobian.dot(self._now),
            self._jacobian.dot(self._coming),
            target / self._step,
        )

    def _forces_in_axes(self) -> Array:
        """Return the forces in the axes of their points, (rows,)."""
        turned: Array = np.matmul(self._axes, self._forces.reshape(-1, 3, 1)).reshape(-1)
        return turned[self._rows]

    def _from_world(self, by_force: Array) -> Array:
        """Return what is linear in forces in the axes of points, for forces in the world."""
        whole: Array = np.zeros((len(by_force), len(self._forces)))
        whole[:, self._rows] = by_force
        turned: Array = np.matmul(whole.reshape(len(whole), -1, 1, 3), self._axes)
        return turned.reshape(len(whole), -1)

    def _make_jacobian(self, numbers: Sequence[int]) -> Array:
        """Return how points move on first sides against second ones, in their axes, (3 m, size)."""
        points = self._points
        jacobian: Array = np.zeros((len(points.pairs), 3, len(self._now)))
        for number, part, where in zip(numbers, self._parts, self._wheres, strict=True):
            for side, sign, at in ((0, 1.0, points.on_first), (1, -1.0, points.on_second)):
                own = [row for row, pair in enumerate(points.pairs) if pair[side][0] == number]
                if own:
                    links = np.array([points.pairs[row][side][1] for row in own])
                    jacobian[own, :, where] += sign * part.jacobian(links, at[own])
        turned: Array = np.matmul(self._axes, jacobian)
        return turned.reshape(3 * len(points.pairs), -1)


def _axes(normals: Array) -> Array:
    """Return the axes of points as rows, (m, 3, 3): unit normals, then two across each."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    crosses = skew_matrices(normals)
    first = np.matmul(crosses, least[:, :, np.newaxis])
    first /= np.sqrt((first * first).sum(axis=1, keepdims=True))
    second = np.matmul(crosses, first)
    axes: Array = np.concatenate(
        [normals[:, np.newaxis], first.transpose(0, 2, 1), second.transpose(0, 2, 1)], axis=1
    )
    return axes


def _surfaces(points: PressingPoints, reader: ContactReader, step: float) -> Surfaces:
    """Return the surfaces at points as the engine takes them."""
    frictions, recoveries, compliances = [], [], []
    for pair in points.pairs:
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
