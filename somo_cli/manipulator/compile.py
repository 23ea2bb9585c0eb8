"""Compile a document: find its problems, and make its definition, its chain and its URDF."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.document.include import unresolved_references
from somo_cli.document.parse import Document
from somo_cli.document.validate import schema_problems, soundness_test
from somo_cli.manipulator import assembly, assembly_chain, assembly_checks, urdf
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.definition import Definition
from somo_cli.manipulator.dimensions import Scale, scaled
from somo_cli.problems import InvalidFile, Pointer, Problem, has_errors, in_reading_order

_PLACES: tuple[tuple[str, ...], ...] = (
    ("actuator_definitions", "*"),
    ("actuator_definitions", "*", "link_definition"),
    ("actuator_definitions", "*", "joint_definitions", "*"),
    ("base_definition",),
    ("tip_definition",),
    ("tip_definitions", "*"),
)
FILE_POINTERS: tuple[tuple[str, ...], ...] = (
    *_PLACES,
    ("body_definition",),
    ("limbs", "*", "definition"),
    *(("limbs", "*", "definition", *place) for place in _PLACES),
)
"""The places where a definition or an assembly may name a file instead of holding a mapping."""


@dataclass(frozen=True, slots=True)
class Compiled:
    """A definition and its chain in the unit of the file, and the world scale of the file."""

    definition: Definition
    chain: Chain
    scale: Scale | None
    warnings: tuple[Problem, ...]

    def scaled_chain(self, scale: Scale) -> Chain:
        """Return the chain in the units of a scale."""
        return scaled(self.chain, scale)

    def urdf(
        self,
        scale: Scale | None = None,
        tip_frame: str | None = None,
        has_all_limits: bool = False,
    ) -> str:
        """Return the URDF in the units of a scale, by default that of the file, else 1.

        A comment says so if they are not SI. `has_all_limits` is explained at `urdf.render`.
        """
        wanted = scale or self.scale or Scale()
        note = urdf.scale_note(wanted)
        return urdf.render(self.scaled_chain(wanted), tip_frame, note, has_all_limits)

    def described(self, scale: Scale) -> str:
        """Return one line with the size of the manipulator, in the unit of the file."""
        links = self.chain.links
        limbs = f"{len(self.chain.limbs)} limbs, " if self.chain.limbs else ""
        mass = sum(link.inertial.mass for link in links)
        return (
            f"{limbs}{len(links)} links, {len(self.chain.joints)} joints, {mass:.4g} kg, "
            f"{self.chain.length:.4g} m long, world scale {scale.length:g}"
        )


def document_problems(document: Document) -> tuple[Problem, ...]:
    """Return all errors and warnings about a definition or an assembly, in reading order."""
    schema = "assembly" if assembly.is_assembly(document.data) else "manipulator"
    shape = schema_problems(document, schema)
    is_sound = soundness_test(shape, unresolved_references(document, FILE_POINTERS))
    wrong_kinds = assembly_checks.wrong_file_kinds(document, ())
    problems = [one.problem for one in shape if one.pointer[:3] not in wrong_kinds]
    problems.extend(wrong_kinds.values())
    problems.extend(assembly_checks.assembly_problems(document, (), is_sound))
    return in_reading_order(problems, document.texts)


def compile_sound(document: Document, at: Pointer, warnings: tuple[Problem, ...]) -> Compiled:
    """Return the compiled definition at a pointer without errors."""
    definition = assembly.read(document, at)
    scale = assembly.world_scale(document, at)
    return Compiled(definition, assembly_chain.build(definition), scale, warnings)


class DefinitionCompiler:
    """Compiles the definitions of one document without errors, each only once."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._compiled: dict[Pointer, Compiled] = {}

    def at(self, pointer: Pointer) -> Compiled:
        """Return the compiled definition or assembly at a pointer."""
        if pointer not in self._compiled:
            self._compiled[pointer] = compile_sound(self._document, pointer, ())
        return self._compiled[pointer]


def compile_definition(document: Document) -> Compiled:
    """Return the compiled definition. Raises InvalidFile with all problems if it has errors."""
    problems = document_problems(document)
    if has_errors(problems):
        raise InvalidFile(problems, document.texts)
    return compile_sound(document, (), problems)
