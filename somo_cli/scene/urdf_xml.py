"""Read the elements of a URDF text, each with its position in the file.

A document type declaration is an error, so that no entity can expand. No other module uses expat.
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
    """An element of an XML document; `span` is the position of its start.

    `pieces` are what stands between its tags, comments left out.
    """

    tag: str
    attributes: Mapping[str, str]
    span: Span
    children: list[XmlElement] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text of the element itself, without blanks around it."""
        return "".join(self.pieces).strip()

    def children_with_tag(self, tag: str) -> list[XmlElement]:
        """Return the children with this tag, in document order."""
        return [child for child in self.children if child.tag == tag]

    def first_child_with_tag(self, tag: str) -> XmlElement | None:
        """Return the first child with this tag, or None."""
        return next(iter(self.children_with_tag(tag)), None)

    def walk(self) -> Iterator[XmlElement]:
        """Yield this element and all elements below it, in document order."""
        yield self
        for child in self.children:
            yield from child.walk()


def parse_xml(text: str, source: str, max_depth: int = MAX_DEPTH) -> XmlElement:
    """Return the root element. Raises InvalidFile with the first error: reading stops there.

    `max_depth` is how deep elements may be nested.
    """
    parser = xml.parsers.expat.ParserCreate()
    open_elements: list[XmlElement] = []
    roots: list[XmlElement] = []
    count = 0

    def here() -> Span:
        return Span(source, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def refuse(message: str, hint: str = "") -> None:
        raise InvalidFile([Problem(here(), message, hint)], {source: text})

    def doctype(*_: object) -> None:
        refuse("a document type declaration is not allowed", "remove it: a URDF needs none")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MAX_ELEMENTS or len(open_elements) >= max_depth:
            refuse(f"more than {MAX_ELEMENTS} elements, or more than {max_depth} nested ones")
        element = XmlElement(tag, attributes, here())
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    def characters(data: str) -> None:
        if open_elements:
            open_elements[-1].pieces.append(data)

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    try:
        parser.Parse(text, True)
    except xml.parsers.expat.ExpatError as error:
        reason = xml.parsers.expat.ErrorString(error.code)
        place = Span(source, error.lineno, error.offset + 1)
        message = f"this is not XML: {reason}"
        raise InvalidFile([Problem(place, message, "")], {source: text}) from error
    return roots[0]


def shape_tag(root: XmlElement) -> str:
    """Return the tag of the shapes of a URDF: collision, or visual if it has no collision shape."""
    return "collision" if any(one.tag == "collision" for one in root.walk()) else "visual"


def mesh_filenames(text: str, source: str) -> Mapping[str, Span]:
    """Return each file that the shapes of a URDF name as a mesh, and where it is named first.

    The result is empty if the text is not XML.
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
