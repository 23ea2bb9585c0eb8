"""The whole compiler on one screen: Document → faults, Definition → Chain → scaled Chain → URDF."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.document.include import unread
from somo_cli.document.parse import Document
from somo_cli.document.validate import faults_of_shape, soundness
from somo_cli.manipulator import chain, meaning, read, urdf
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.definition import Definition
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.problems import InvalidFile, Pointer, Problem, has_errors, in_reading_order

PLACES_OF_FILES: tuple[tuple[str, ...], ...] = (
    ("actuator_definitions", "*"),
    ("actuator_definitions", "*", "link_definition"),
    ("actuator_definitions", "*", "joint_definitions", "*"),
    ("base_definition",),
    ("tip_definition",),
    ("tip_definitions", "*"),
)
"""Where a definition may name a file instead of holding a mapping."""


@dataclass(frozen=True, slots=True)
class Compiled:
    """A definition and its chain in the unit of the file, with the scale its file asks for."""

    definition: Definition
    chain: Chain
    scale: Scale | None
    warnings: tuple[Problem, ...]

    def scaled_chain(self, scale: Scale) -> Chain:
        """Return the chain in the units of a scale."""
        return scaled(self.chain, scale)

    def urdf(self, scale: Scale | None = None, tip_frame: str | None = None) -> str:
        """Return the URDF, scaled as asked, else as the file says, else by 1."""
        return urdf.render(self.scaled_chain(scale or self.scale or Scale()), tip_frame)

    def described(self, scale: Scale) -> str:
        """Say in a line what was compiled, in the unit of the file."""
        links = self.chain.links
        mass = sum(link.inertial.mass for link in links)
        return (
            f"{len(links)} links, {len(self.chain.joints)} joints, {mass:.4g} kg, "
            f"{self.chain.length:.4g} m long, world scale {scale.length:g}"
        )


def faults(document: Document) -> tuple[Problem, ...]:
    """Return every error and warning about a definition, of shape and of meaning."""
    shape = faults_of_shape(document, "manipulator")
    is_sound = soundness(shape, unread(document, PLACES_OF_FILES))
    problems = [fault.problem for fault in shape]
    problems.extend(meaning.faults(document, (), is_sound))
    return in_reading_order(problems, document.texts)


def compile_sound(document: Document, at: Pointer, warnings: tuple[Problem, ...]) -> Compiled:
    """Compile the definition at a pointer, in which no error was found."""
    definition = read.read(document, at)
    return Compiled(definition, chain.build(definition), read.world_scale(document, at), warnings)


def compile_definition(document: Document) -> Compiled:
    """Compile a definition; raise InvalidFile with all its faults if one is an error."""
    problems = faults(document)
    if has_errors(problems):
        raise InvalidFile(problems, document.texts)
    return compile_sound(document, (), problems)
