"""How well a chain of few joints follows the uniform beam whose tip stiffness it has.

All lengths are in units of the beam's, forces and frequencies such that EI and mass are 1. The
beam is clamped, slender and inextensible; the chain's links are slender rods.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import root

from somo_cli.analysis.closed_forms import tip_load
from somo_cli.arrays import Array
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.manipulator.definition import Placement

_FIRST = {"bending": 1.875104068711961**2, "torsion": math.pi / 2}
"""First frequency of the beam, clamped and free: Blevins, Formulas for Natural Frequency (1979)."""

_STATIONS = 401  # along the length


@dataclass(frozen=True, slots=True)
class BeamComparison:
    """Errors of a chain with matched tip stiffness, as ratios: 0.01 is one per cent.

    `along` is the largest error of the deflection along the length under a force on the tip
    (torsion: of the angle under a moment), over that of the tip, and `profile` the errors at
    tenths of the length, from the clamp, shape (11,). `moment` and `weight` are errors
    of the tip's deflection under an end moment and under the beam's own weight, `large` is the
    distance of the tip from the elastica's under a dead load P L² / EI = 1, over the length; all
    three are nan for torsion. `frequency` is the error of the first natural frequency, `top` how
    many times higher the highest one is than the first, of which long steps have to be short.
    """

    moment_arms: MomentArms
    placement: Placement
    along: float
    profile: Array
    moment: float
    weight: float
    large: float
    frequency: float
    top: float


def compare_with_beam(moment_arms: MomentArms, placement: Placement) -> BeamComparison:
    """Return how well the moment_arms, their stiffness the exact one, follow the beam."""
    arms = moment_arms.arms[moment_arms.arms > 0]
    places = moment_arms.places[: len(arms)] / moment_arms.at
    rigid = (
        moment_arms.rigidity(moment_arms.tip_stiffness(1.0)) / moment_arms.at
    )  # EI / a for a stiffness of 1
    stiffness = (moment_arms.profile / moment_arms.shares)[: len(arms)] / rigid
    lowest, highest = _frequencies(moment_arms, places, stiffness)
    errors = _errors_along(moment_arms, places, stiffness)
    is_bending = moment_arms.kind == "bending"
    return BeamComparison(
        moment_arms=moment_arms,
        placement=placement,
        along=float(np.abs(errors).max()),
        profile=errors[:: (_STATIONS - 1) // 10],
        moment=_tip_deflection(places, stiffness, 0) * 2 - 1 if is_bending else math.nan,
        weight=_tip_deflection(places, stiffness, 2) * 4 - 1 if is_bending else math.nan,
        large=_elastica_distance(places, stiffness) if is_bending else math.nan,
        frequency=lowest / _FIRST[moment_arms.kind] - 1,
        top=highest / lowest,
    )


def compare_placements(
    made: Callable[[int, Placement], MomentArms], numbers: Iterable[int]
) -> Iterator[BeamComparison]:
    """Yield how well chains of so many joints follow the beam, evenly placed and by Gauss."""
    for number in numbers:
        for placement in ("uniform", "gauss"):
            yield compare_with_beam(made(number, placement), placement)


def _tip_deflection(places: Array, stiffness: Array, power: int) -> float:
    """Return the tip's deflection under a moment (1 - s)^power along the beam."""
    arms = 1 - places
    return float(np.sum(arms**power / stiffness * arms))


def _errors_along(moment_arms: MomentArms, places: Array, stiffness: Array) -> Array:
    """Return chain minus beam at even stations along the length, over the tip's deflection."""
    s = np.linspace(0, 1, _STATIONS)
    beyond = s[:, np.newaxis] - places
    if moment_arms.kind == "torsion":
        # between two joints the link has one angle: the worst is at its ends
        twist: Array = (beyond > 0) @ (1 / stiffness) - s
        return twist
    chain = np.maximum(beyond, 0) @ ((1 - places) / stiffness)
    beam = s * s * (3 - s) / 6  # Timoshenko, Strength of Materials I (1955), sec. 32
    errors: Array = 3 * (chain - beam)
    return errors


def _elastica_distance(places: Array, stiffness: Array) -> float:
    """Return how far the tip is from the elastica's under P L² / EI = 1, over the length."""
    links = np.diff(np.append(places, 1.0))

    def shape(angles: Array) -> tuple[Array, Array]:
        slopes = np.cumsum(angles)
        return links * np.cos(slopes), links * np.sin(slopes)

    def unbalance(angles: Array) -> Array:
        along, _ = shape(angles)
        arms = np.cumsum(along[::-1])[::-1]  # of a force across the clamp
        rest: Array = stiffness * angles - arms
        return rest

    found = root(unbalance, (1 - places) / stiffness, method="hybr", options={"xtol": 1e-13})
    along, across = shape(found.x)
    return math.dist((places[0] + along.sum(), across.sum()), tip_load(1.0))


def _frequencies(moment_arms: MomentArms, places: Array, stiffness: Array) -> tuple[float, float]:
    """Return the lowest and the highest frequency about the straight pose, rods of mass 1."""
    last = np.maximum.outer(places, places)
    free = 1 - last  # what both joints move
    mass = free
    if moment_arms.kind == "bending":
        # the integral of (s - x_i)(s - x_j) from the later joint to the tip
        apart = np.abs(np.subtract.outer(places, places))
        mass = free**3 / 3 + apart * free**2 / 2
    # many crowded joints leave digits to the largest eigenvalue alone, so one problem for each end
    flexible = eigh(mass / np.sqrt(np.outer(stiffness, stiffness)), eigvals_only=True)
    squares = eigh(np.diag(stiffness), mass, eigvals_only=True)
    return 1 / math.sqrt(flexible[-1]), math.sqrt(squares[-1])
