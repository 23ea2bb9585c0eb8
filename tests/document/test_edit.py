from __future__ import annotations

import copy

import pytest

from somo_cli.document.edit import embed_all, override
from somo_cli.document.parse import Document, parse
from somo_cli.problems import InvalidFile, Pointer, Problem, Span

TEXT = "name: finger\nlinks:\n  - part.yaml\n  - mass: 1\n    size: [1, 2]\n"
HINT = "write it like links[0].mass=0.1"


@pytest.fixture
def document() -> Document:
    return parse(TEXT, "f.yaml")


@pytest.fixture
def part() -> Document:
    return parse("# part\nmass: 2\nsize: [3]\n", "part.yaml")


def refusal(document: Document, assignment: str) -> tuple[Problem, ...]:
    with pytest.raises(InvalidFile) as caught:
        override(document, assignment)
    source = f"--set '{assignment.partition('=')[0]}'"
    assert caught.value.texts == {**document.texts, source: assignment}
    return caught.value.problems


def test_a_part_comes_with_its_spans_and_texts(document: Document, part: Document) -> None:
    before = copy.deepcopy(document)
    whole = embed_all(document, {("links", 0): part})
    assert whole.data == {
        "name": "finger",
        "links": [{"mass": 2, "size": [3]}, {"mass": 1, "size": [1, 2]}],
    }
    assert whole.texts == {**document.texts, **part.texts}
    assert whole.source == "f.yaml"
    assert whole.span(("links", 0), key=True) == Span("f.yaml", 3, 5, 9)
    assert whole.span(("links", 0)) == Span("part.yaml", 1, 1)
    assert whole.span(("links", 0, "mass")) == Span("part.yaml", 2, 7)
    assert whole.span(("links", 0, "size", 0)) == Span("part.yaml", 3, 8)
    assert whole.span(("links", 1, "mass")) == Span("f.yaml", 4, 11)
    # What is missing in the part is missing in its file.
    assert whole.span(("links", 0, "shape")) == Span("part.yaml", 1, 1)
    assert document == before


def test_the_spans_of_what_was_there_are_gone(document: Document) -> None:
    whole = embed_all(document, {("links", 1): parse("5", "five.yaml")})
    assert whole.data == {"name": "finger", "links": ["part.yaml", 5]}
    assert whole.span(("links", 1, "mass")) == Span("five.yaml", 1, 1)
    assert ("links", 1, "size", 1) not in whole.spans


def test_a_part_may_be_the_root_or_a_new_key(document: Document, part: Document) -> None:
    assert embed_all(document, {(): part}).data == part.data
    whole = embed_all(document, {("tip",): part})
    assert whole.at(("tip", "mass")) == 2
    assert "tip" not in parse(TEXT, "f.yaml").spans


@pytest.mark.parametrize(
    "pointer", [("links", 2), ("links", -1), ("links", "a"), ("a", "b"), ("name", "a"), (0,)]
)
def test_a_place_that_is_not_there_raises(
    document: Document, part: Document, pointer: Pointer
) -> None:
    with pytest.raises(KeyError):
        embed_all(document, {pointer: part})


def test_many_parts_at_once_are_as_one_after_the_other(document: Document, part: Document) -> None:
    other = parse("[1]", "other.yaml")
    one_by_one = embed_all(embed_all(document, {("links", 0): part}), {("links", 1, "size"): other})
    at_once = embed_all(document, {("links", 0): part, ("links", 1, "size"): other})
    assert at_once == one_by_one
    assert embed_all(document, {}) == document


@pytest.mark.parametrize(
    ("assignment", "pointer", "value"),
    [
        ("name=thumb", ("name",), "thumb"),
        ("links[1].mass=1e-3", ("links", 1, "mass"), 1e-3),
        ("links[1].size[0]=-2", ("links", 1, "size", 0), -2),
        ("links[1].size=[1, 2, 3]", ("links", 1, "size"), [1, 2, 3]),
        ("links[0]={mass: 3, a: b=c}", ("links", 0), {"mass": 3, "a": "b=c"}),
        ("links[1].colour='017'", ("links", 1, "colour"), "017"),
        ("name=null", ("name",), None),
        ("name=''", ("name",), ""),
        ("new=  yes", ("new",), "yes"),
        ('name={"a":\t1}', ("name",), {"a": 1}),
    ],
)
def test_a_value_is_set(
    document: Document, assignment: str, pointer: Pointer, value: object
) -> None:
    changed = override(document, assignment)
    assert changed.at(pointer) == value
    assert document == parse(TEXT, "f.yaml")


def test_a_value_that_is_set_has_its_place_in_the_assignment(document: Document) -> None:
    assignment = "links[1].size=[7,  {a: 8}]"
    source = "--set 'links[1].size'"
    changed = override(document, assignment)
    assert changed.texts == {"f.yaml": TEXT, source: assignment}
    assert changed.span(("links", 1, "size"), key=True) == Span(source, 1, 10, 4)
    assert changed.span(("links", 1, "size")) == Span(source, 1, 15)
    assert changed.span(("links", 1, "size", 0)) == Span(source, 1, 16)
    assert changed.span(("links", 1, "size", 1, "a")) == Span(source, 1, 24)
    assert changed.span(("links", 1, "size", 1, "a"), key=True) == Span(source, 1, 21)
    # A key that is missing there is missing in the assignment.
    assert changed.span(("links", 1, "size", "b")) == Span(source, 1, 10, 4)
    new = override(document, "links[1].colour=  red")
    assert new.span(("links", 1, "colour")) == Span("--set 'links[1].colour'", 1, 19, 3)
    item = override(document, "links[1]=5")
    assert item.span(("links", 1), key=True) == Span("--set 'links[1]'", 1, 6, 3)


def test_overrides_follow_each_other(document: Document) -> None:
    for assignment in ("links[0]={mass: 1}", "links[0].mass=2", "links[0].mass=3", "a=1"):
        document = override(document, assignment)
    assert document.at(("links", 0)) == {"mass": 3}
    assert document.span(("links", 0, "mass")) == Span("--set 'links[0].mass'", 1, 15)
    assert document.texts["--set 'links[0].mass'"] == "links[0].mass=3"


@pytest.mark.parametrize(
    ("assignment", "column", "width", "message", "hint"),
    [
        ("name", 1, 4, "'name' does not say what to set", HINT),
        ("", 1, 1, "'' does not say what to set", HINT),
        ("=5", 1, 1, "'' is not a path", HINT),
        (".name=5", 1, 1, "'.name' is not a path", HINT),
        ("links..a=5", 6, 1, "'links..a' is not a path", HINT),
        ("links[-1]=5", 6, 1, "'links[-1]' is not a path", HINT),
        ("links[1]mass=5", 9, 1, "'links[1]mass' is not a path", HINT),
        ("links[x]=5", 6, 1, "'links[x]' is not a path", HINT),
        ("links.=5", 6, 1, "'links.' is not a path", HINT),
        ("a b=5", 2, 1, "'a b' is not a path", HINT),
        ("links[2]=5", 6, 3, "'links' has no item [2]", "the last one is [1]"),
        ("name[0]=5", 5, 3, "'name' is not a list", ""),
        ("[0]=5", 1, 3, "the file is not a list", "name a key instead"),
        ("links.mass=5", 7, 4, "'links' is not a mapping", "name an index, such as [0]"),
        ("links[0].mass=5", 10, 4, "'links[0]' is not a mapping", ""),
        ("link[0].mass=5", 1, 4, "the file has no key 'link'", "did you mean 'links'?"),
        ("links[1].xyz.a=5", 10, 3, "'links[1]' has no key 'xyz'", "known keys: mass, size"),
        ("name=", 6, 1, "there is no value after the '='", "null stands for nothing"),
        ("name= ", 6, 1, "there is no value after the '='", "null stands for nothing"),
        (
            "name=#f00",
            6,
            4,
            "there is no value after the '='",
            "quote a value that starts with '#'",
        ),
        (
            "links[1].mass=017",
            15,
            3,
            "a number with a leading zero is ambiguous: 017",
            "write 17 or '017'",
        ),
        (
            "name=[1, 2",
            11,
            1,
            "expected ',' or ']'",
            "the bracket opened on line 1, column 6, is not closed, or a comma is missing",
        ),
    ],
)
def test_a_wrong_assignment_is_refused_at_its_place(
    document: Document, assignment: str, column: int, width: int, message: str, hint: str
) -> None:
    span = Span(f"--set '{assignment.partition('=')[0]}'", 1, column, width)
    assert refusal(document, assignment) == (Problem(span, message, hint),)


def test_every_problem_of_a_value_is_reported(document: Document) -> None:
    problems = refusal(document, "name=[017, .nan]")
    assert [(problem.span.column, problem.span.width) for problem in problems] == [(7, 3), (12, 4)]
