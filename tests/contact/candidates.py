"""What could be done about the impulse that a measured force holds after an impact: candidate laws.

All but the first are the product's law with another measured force. The whole force can be
filtered, or only the part that is not gravity and Coriolis forces, which inverse dynamics gives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np

from somo_cli.arrays import Array
from somo_cli.scene.model import Integrator
from somo_cli.simulation.integrator import body_stepper
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.law_stepper import LawStepper
from somo_cli.simulation.plan.joint_springs import JointSprings

MEAN_WEIGHT = 0.3  # of the newest in a running mean
IMPACT = (
    0.02  # rad/s: what a change of the force must do to a joint in a step to count as an impact
)
CAP = 0.01  # rad: a change of the force is cut to what turns a joint's spring by this much


class FilteredLaw(SpringDamperLaw):
    """The product's law but for a filter on the force that it measures."""

    is_contact_alone = False

    def __init__(self, springs: JointSprings, time_step: float, integrator: Integrator) -> None:
        super().__init__(springs, time_step, integrator)
        self.history: list[Array] = []  # what was measured, newest first

    def measured_force(self, bias: Array) -> Array:
        """Return f, filtered."""
        force = super().measured_force(bias)
        smooth = -bias if self.is_contact_alone else np.zeros_like(force)
        return smooth + self.passed(force - smooth)

    def passed(self, force: Array) -> Array:
        """Return what the filter makes of a force, and remember it."""
        self.history.insert(0, force)
        del self.history[3:]
        return self.filtered() if len(self.history) == 3 else force

    def filtered(self) -> Array:
        """Return what is made of the last three forces."""
        raise NotImplementedError


class Minmod(FilteredLaw):
    """The smaller of the last two where they agree in sign, else nothing."""

    def filtered(self) -> Array:
        """Return what is made of the last three forces."""
        new, old, _ = self.history
        smaller: Array = np.where(np.abs(new) < np.abs(old), new, old)
        return np.where(new * old > 0, smaller, 0.0)


class Median(FilteredLaw):
    """The median of the last three."""

    def filtered(self) -> Array:
        """Return what is made of the last three forces."""
        return np.asarray(np.median(self.history, axis=0))


class Mean(FilteredLaw):
    """A running mean."""

    def passed(self, force: Array) -> Array:
        """Return what the filter makes of a force, and remember it."""
        if self.history:
            force = MEAN_WEIGHT * force + (1 - MEAN_WEIGHT) * self.history[0]
        self.history[:] = [force]
        return force


class Dropped(FilteredLaw):
    """Where the force jumps, the one before for one step."""

    was_dropped = False

    def filtered(self) -> Array:
        """Return what is made of the last three forces."""
        new, old, _ = self.history
        jump = np.abs(self.response @ (new - old)).max() * self.time_step
        self.was_dropped = bool(jump > IMPACT) and not self.was_dropped
        return old if self.was_dropped else new


class Capped(FilteredLaw):
    """The force may change by so much in a step, and no more."""

    def passed(self, force: Array) -> Array:
        """Return what the filter makes of a force, and remember it."""
        if self.history:
            most = CAP * self.springs.stiffness
            force = self.history[0] + np.clip(force - self.history[0], -most, most)
        self.history[:] = [force]
        return force


class Forgetful(FilteredLaw):
    """No contact force at all: B then acts on it as an inertia would, and statics are lost."""

    def passed(self, force: Array) -> Array:
        """Return what the filter makes of a force, and remember it."""
        return np.zeros_like(force)


@dataclass(frozen=True, slots=True)
class Candidate:
    """A law by name."""

    name: str
    law: type[SpringDamperLaw] = SpringDamperLaw
    integrator: Integrator = "implicit"
    is_held: bool = True  # whether calm bodies may be followed with a held correction

    @contextmanager
    def installed(self) -> Iterator[None]:
        """Let runs follow this law."""
        held: Callable[..., int] = LawStepper._reuse_steps if self.is_held else lambda *_: 1
        with (
            patch.object(body_stepper, "SpringDamperLaw", self.law),
            patch.object(LawStepper, "_reuse_steps", held),
        ):
            yield


def of_contact(law: type[FilteredLaw]) -> type[FilteredLaw]:
    """Return the law that filters the contact part alone."""
    return type(f"Contact{law.__name__}", (law,), {"is_contact_alone": True})


def filters() -> Iterator[Candidate]:
    """Yield every filter, of the whole force and of its contact part."""
    named = {"minmod": Minmod, "median": Median, "mean": Mean, "dropped": Dropped, "capped": Capped}
    for name, law in named.items():
        yield Candidate(f"{name}, f", law, is_held=False)
        yield Candidate(f"{name}, contact", of_contact(law), is_held=False)
    yield Candidate("no contact force", of_contact(Forgetful), is_held=False)


PLAIN = Candidate("plain")
EVERY_STEP = Candidate("plain, no holding", is_held=False)
EULER = Candidate("euler", integrator="euler")
EXPLICIT = Candidate("explicit", integrator="explicit")


def candidates() -> tuple[Candidate, ...]:
    """Return every candidate, the product's law first."""
    return (PLAIN, EVERY_STEP, *filters(), EULER)
