"""URDF text to its elements, each with its place; the only place expat is known.

A document type declaration is refused, and with it every entity that could expand.
"""

from __future__ import annotations

import xml.parsers.expat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from somo_cli.problems import InvalidFile, Problem, Span

MAX_ELEMENTS = 100_000
MAX_DEPTH = 50


@dataclass(frozen=True, slots=True)
class XmlElement:
    """An element of an XML document, and where it starts."""

    tag: str
    attributes: Mapping[str, str]
    span: Span
    children: list[XmlElement] = field(default_factory=list)

    def children_with_tag(self, tag: str) -> list[XmlElement]:
        """Return the elements of this tag directly below, in their order."""
        return [child for child in self.children if child.tag == tag]

    def first_child_with_tag(self, tag: str) -> XmlElement | None:
        """Return the first element of this tag directly below, if there is one."""
        return next(iter(self.children_with_tag(tag)), None)

    def walk(self) -> Iterator[XmlElement]:
        """Yield this element and all below it, in their order."""
        yield self
        for child in self.children:
            yield from child.walk()


def parse_xml(text: str, source: str) -> XmlElement:
    """Return the root element. Raises InvalidFile, of one fault: XML cannot be read beyond it."""
    parser = xml.parsers.expat.ParserCreate()
    open_elements: list[XmlElement] = []
    roots: list[XmlElement] = []
    count = 0

    def here() -> Span:
        return Span(source, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def refuse(message: str, hint: str = "") -> None:
        raise InvalidFile([Problem(here(), message, hint)], {source: text})

    def doctype(*_: object) -> None:
        refuse("a document type declaration is not allowed", "leave it out: a URDF needs none")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_ELEMENTS or len(open_elements) >= MAX_DEPTH:
            refuse(f"more than {MAX_ELEMENTS} elements, or {MAX_DEPTH} in one another")
        element = XmlElement(tag, attributes, here())
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    try:
        parser.Parse(text, True)
    except xml.parsers.expat.ExpatError as error:
        said = xml.parsers.expat.ErrorString(error.code)
        place = Span(source, error.lineno, error.offset + 1)
        message = f"this is not XML: {said}"
        raise InvalidFile([Problem(place, message, "")], {source: text}) from error
    return roots[0]


def shape_tag(root: XmlElement) -> str:
    """Return which elements are the shapes of a URDF: collision, or visual if there is none."""
    return "collision" if any(one.tag == "collision" for one in root.walk()) else "visual"


def mesh_filenames(text: str, source: str) -> Mapping[str, Span]:
    """Return the files that the meshes among the shapes of a URDF name, each once, and where.

    Of a text that is no XML there are none.
    """
    try:
        root = parse_xml(text, source)
    except InvalidFile:
        return {}
    names: dict[str, Span] = {}
    tag = shape_tag(root)
    for shape in (one for one in root.walk() if one.tag == tag):
        for mesh in (one for one in shape.walk() if one.tag == "mesh"):
            name = mesh.attributes.get("filename", "")
            if name:
                names.setdefault(name, mesh.span)
    return names
