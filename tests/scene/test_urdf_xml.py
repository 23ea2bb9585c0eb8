"""XML with places, and without what could harm."""

from __future__ import annotations

import pytest

from somo_cli.problems import InvalidFile, Span
from somo_cli.scene import urdf_xml


def refusal(text: str) -> tuple[Span, str]:
    with pytest.raises(InvalidFile) as caught:
        urdf_xml.parse_xml(text, "r.urdf")
    (problem,) = caught.value.problems
    return problem.span, problem.message


def test_elements_know_where_they_are() -> None:
    root = urdf_xml.parse_xml(
        '<robot name="ü">\n  <link/>\n  <joint/><link name="b"/>\n</robot>', "r"
    )
    assert (root.tag, root.attributes, root.span) == ("robot", {"name": "ü"}, Span("r", 1, 1))
    assert [one.span for one in root.children_with_tag("link")] == [
        Span("r", 2, 3),
        Span("r", 3, 11),
    ]
    assert [one.tag for one in root.walk()] == ["robot", "link", "joint", "link"]
    assert root.first_child_with_tag("transmission") is None


def test_a_thousand_laughs_are_none() -> None:
    text = '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]>\n<r>&b;</r>'
    assert refusal(text)[1] == "a document type declaration is not allowed"
    assert refusal('<!DOCTYPE r SYSTEM "file:///etc/passwd"><r/>')[1].startswith("a document type")
    assert refusal("<r>&amp;&a;</r>")[1] == "this is not XML: undefined entity"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "this is not XML: no element found"),
        ("<a>\n<b>\n</a>", 3, "this is not XML: mismatched tag"),
        ("<a/>\n<a/>", 2, "this is not XML: junk after document element"),
        ("<a b='1' b='2'/>", 1, "this is not XML: duplicate attribute"),
        ("robot: 1\n", 1, "this is not XML: syntax error"),
    ],
)
def test_what_is_no_xml(text: str, line: int, message: str) -> None:
    span, found = refusal(text)
    assert (span.line, found) == (line, message)
    assert urdf_xml.mesh_filenames(text, "r.urdf") == {}


@pytest.mark.moderate
def test_what_is_too_much() -> None:
    deep = "<a>" * 60 + "</a>" * 60
    assert refusal(deep)[1] == "more than 100000 elements, or more than 50 nested ones"
    assert refusal("<a>" + "<b/>" * 100_001 + "</a>")[1] == refusal(deep)[1]


def test_meshes_are_named_once_and_only_for_collisions() -> None:
    mesh = '<{0}><geometry><mesh filename="{1}"/></geometry></{0}>'
    text = "\n".join(
        [
            "<robot><link>",
            mesh.format("visual", "v.dae"),
            mesh.format("collision", "b.stl"),
            mesh.format("collision", "a.stl"),
            mesh.format("collision", "b.stl"),
            "</link></robot>",
        ]
    )
    found = urdf_xml.mesh_filenames(text, "r.urdf")
    assert {name: span.line for name, span in found.items()} == {"b.stl": 3, "a.stl": 4}
    assert list(found) == ["b.stl", "a.stl"]
