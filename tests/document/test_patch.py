from __future__ import annotations

import random
import re
from collections.abc import Mapping, Sequence

import pytest

from somo_cli.document.edit import override
from somo_cli.document.include import include
from somo_cli.document.parse import Document, parse
from somo_cli.document.patch import patched
from somo_cli.problems import InvalidFile, Pointer, Problem, Span

Values = Mapping[Pointer, float | Sequence[float]]
PLACES = (("parts", "*"), ("parts", "*", "link"), ("base",))
NOT = "this value cannot be set by itself: "
ALIAS = ", by an alias or a merge key"
TWICE = ", as its file is included more than once"


def joined(files: Mapping[str, str]) -> Document:
    """The first of the files, with the others put in where they are named."""
    first = next(iter(files))
    document, problems = include(
        parse(files[first], first), PLACES, lambda _, path: (path, files[path])
    )
    assert problems == ()
    return document


def changed(text: str, values: Values, after: Mapping[str, str] | None = None) -> str:
    return patched(parse(text, "f.yaml"), "f.yaml", values, after)


def refusal(document: Document, source: str, values: Values) -> tuple[Problem, ...]:
    with pytest.raises(InvalidFile) as caught:
        patched(document, source, values)
    assert caught.value.texts == document.texts
    return caught.value.problems


def only(text: str, values: Values) -> Problem:
    (problem,) = refusal(parse(text, "f.yaml"), "f.yaml", values)
    return problem


@pytest.mark.parametrize(
    ("text", "pointer", "new"),
    [
        ("a: 1\nb: 2\n", ("a",), "a: 0.5\nb: 2\n"),
        ("a:   1   # one\n\n# end", ("a",), "a:   0.5   # one\n\n# end"),
        ("a: '1'  # one\n", ("a",), "a: 0.5  # one\n"),
        ('a: "x # y"\n', ("a",), "a: 0.5\n"),
        ("a: null\n", ("a",), "a: 0.5\n"),
        ("a: ~\n", ("a",), "a: 0.5\n"),
        ("a: true\n", ("a",), "a: 0.5\n"),
        ("a: &x 1\n", ("a",), "a: &x 0.5\n"),
        ("a:\nb: 2\n", ("a",), "a: 0.5\nb: 2\n"),
        ("a:  # none yet\n", ("a",), "a: 0.5  # none yet\n"),
        ("a :", ("a",), "a : 0.5"),
        ("é: {ü€𝄞: 'é', a: 1} # é\n", ("é", "a"), "é: {ü€𝄞: 'é', a: 0.5} # é\n"),
        ("- x\n-  - 1 # one\n", (1, 0), "- x\n-  - 0.5 # one\n"),
        ("- ~\n", (0,), "- 0.5\n"),
        ("{a: {b: , c: 2}}", ("a", "b"), "{a: {b: 0.5 , c: 2}}"),
        ('{"a":1,"b":[2,3]}', ("a",), '{"a":0.5,"b":[2,3]}'),
        ('{"a":1,"b":[2,3]}', ("b", 1), '{"a":1,"b":[2,0.5]}'),
        ('{\n\t"a":\t"x"\n}\n', ("a",), '{\n\t"a":\t0.5\n}\n'),
        ("a:\r\n  b: 1  # c\r\nd: 2\r\n", ("a", "b"), "a:\r\n  b: 0.5  # c\r\nd: 2\r\n"),
        ("a: 1\rb: 2\r", ("b",), "a: 1\rb: 0.5\r"),
        ("--- # head\n3 # foot\n...\n", (), "--- # head\n0.5 # foot\n...\n"),
    ],
)
def test_a_value_is_replaced_where_it_stands(text: str, pointer: Pointer, new: str) -> None:
    assert changed(text, {pointer: 0.5}) == new


@pytest.mark.parametrize(
    ("text", "value", "new"),
    [
        ("a: [ 1,2 ]  # two\n", [3, 4], "a: [ 3.0,4.0 ]  # two\n"),
        ("a: [ 1,2 ]  # two\n", (3, 4, 5), "a: [3.0, 4.0, 5.0]  # two\n"),
        ("a: [1,\n  2]\nb: 1\n", [3], "a: [3.0]\nb: 1\n"),
        ("a: [1, # one\n  2]\n", [3, 4], "a: [3.0, # one\n  4.0]\n"),
        ("a:\n- 1 # one\n\n- 2\nb: 1", [3, 4], "a:\n- 3.0 # one\n\n- 4.0\nb: 1"),
        ("a: []", [3], "a: [3.0]"),
        ("a: [1]", [], "a: []"),
        ("a: null # none\n", [3], "a: [3.0] # none\n"),
        ("a:\nb: 1\n", [3, 4], "a: [3.0, 4.0]\nb: 1\n"),
        ("b: 1\n", [3, 4], "b: 1\na: [3.0, 4.0]\n"),
    ],
)
def test_a_list_is_replaced_item_by_item_or_between_its_brackets(
    text: str, value: Sequence[float], new: str
) -> None:
    assert changed(text, {("a",): value}) == new


@pytest.mark.parametrize(
    ("text", "holder", "new"),
    [
        ("a: 1\nb: 2\n", (), "a: 1\nnew: 0.5\nb: 2\n"),
        ("b: 1\na: 2", (), "b: 1\na: 2\nnew: 0.5"),
        ("a: 1  # one\n# two\nb: 2\n", (), "a: 1  # one\nnew: 0.5\n# two\nb: 2\n"),
        ("a: 1\n   # more\n\n\nb: 2\n", (), "a: 1\n   # more\nnew: 0.5\n\n\nb: 2\n"),
        ("a: 1\r\nb: 2\r\n", (), "a: 1\r\nnew: 0.5\r\nb: 2\r\n"),
        ("b: 1\r\na: 2", (), "b: 1\r\na: 2\r\nnew: 0.5"),
        ("a:\n- 1\n- - 2\nb: 2\n", (), "a:\n- 1\n- - 2\nnew: 0.5\nb: 2\n"),
        ("a:\n-\n\n-\nb: 2\n", (), "a:\n-\n\n-\nnew: 0.5\nb: 2\n"),
        ("a: [1,\n2,\n]\nb: 2\n", (), "a: [1,\n2,\n]\nnew: 0.5\nb: 2\n"),
        ("a: x\n  y\n\n  z\nb: 2\n", (), "a: x\n  y\n\n  z\nnew: 0.5\nb: 2\n"),
        ("a: |\n  x\n\n  # y\nb: 2\n", (), "a: |\n  x\n\n  # y\nnew: 0.5\nb: 2\n"),
        ("a:\n  c: {d: 1}\nb: 2\n", (), "a:\n  c: {d: 1}\nnew: 0.5\nb: 2\n"),
        ("a:\n  b: 1\n", ("a",), "a:\n  b: 1\n  new: 0.5\n"),
        ("- a: 1\n\n- b: 2\n", (0,), "- a: 1\n  new: 0.5\n\n- b: 2\n"),
        ("- - a: 1\n    b: 2", (0, 0), "- - a: 1\n    new: 0.5\n    b: 2"),
        ("é:\n  - 'a': 1\n...\n", ("é", 0), "é:\n  - 'a': 1\n    \"new\": 0.5\n...\n"),
        ("x: &x 1\na: *x\nb: 2\n", (), "x: &x 1\na: *x\nnew: 0.5\nb: 2\n"),
        (
            "x: &x {c: 1}\ny:\n  b: 2 # own\n  <<: *x\n",
            ("y",),
            "x: &x {c: 1}\ny:\n  b: 2 # own\n  new: 0.5\n  <<: *x\n",
        ),
        ("a:", (), "a:\nnew: 0.5"),
        ("{a: 1, b: 2}", (), "{a: 1, new: 0.5, b: 2}"),
        ("# c\n--- {b: 1, a: [1, {}, ]}\n", (), "# c\n--- {b: 1, a: [1, {}, ], new: 0.5}\n"),
        ("{a: {b: {c: 'x, }'}} , d}", (), "{a: {b: {c: 'x, }'}}, new: 0.5 , d}"),
        ("x: {a: , b}", ("x",), "x: {a:, new: 0.5 , b}"),
        ("x: {b, a}", ("x",), "x: {b, a, new: 0.5}"),
        ("x: {}", ("x",), "x: {new: 0.5}"),
        ('{"x": {\n}}', ("x",), '{"x": {"new": 0.5\n}}'),
        ('{"a":1}', (), '{"a":1, "new": 0.5}'),
        (
            '{\n  "a": [\n    1\n  ],\n  "b": 2\n}\n',
            (),
            '{\n  "a": [\n    1\n  ],\n  "new": 0.5,\n  "b": 2\n}\n',
        ),
        ('{\r\n\t"b": 1\r\n}', (), '{\r\n\t"b": 1,\r\n\t"new": 0.5\r\n}'),
        ("{\n  a: 1, # one\n}\n", (), "{\n  a: 1, new: 0.5, # one\n}\n"),
    ],
)
def test_a_missing_key_is_added_behind_its_sibling(text: str, holder: Pointer, new: str) -> None:
    assert changed(text, {(*holder, "new"): 0.5}, {"new": "a"}) == new


def test_several_values_are_set_at_once_and_new_keys_keep_their_order() -> None:
    text = "a:  # none\nb: 1\nc: {d: 1}"
    values: Values = {("y",): 1, ("x",): 2, ("c", "e"): 3, ("c", "d"): 4, ("a",): 5, ("z",): 6}
    new = "a: 5.0  # none\ny: 1.0\nz: 6.0\nb: 1\nc: {d: 4.0, e: 3.0}\nx: 2.0"
    assert changed(text, values, {"y": "a", "z": "a", "x": "gone"}) == new
    assert changed(text, {}) == text
    assert changed("{a: }", {("b",): 1, ("a",): 2}) == "{a: 2.0, b: 1.0 }"
    assert changed("a:", {("b",): 1, ("a",): 2}) == "a: 2.0\nb: 1.0"


@pytest.mark.parametrize("name", ["true nonsense: 1", "1", "é", "a#"])
def test_a_key_that_is_not_plain_is_quoted(name: str) -> None:
    assert changed("b: 1\n", {(name,): 1}) == f'b: 1\n"{name}": 1.0\n'


def test_a_number_reads_back_as_the_same_float() -> None:
    draw = random.Random(1)
    numbers = [draw.uniform(-1, 1) * 10.0 ** draw.randint(-320, 308) for _ in range(500)]
    numbers += [0.0, -0.0, 5e-324, 1e-05, 1e16, 1.7976931348623157e308, 3]
    new = parse(changed("a: [1]\n", {("a",): numbers}), "f.yaml").at(("a",))
    assert repr(new) == repr([float(number) for number in numbers])


@pytest.mark.parametrize("number", [float("nan"), float("inf"), [1.0, -float("inf")]])
def test_a_number_that_is_not_finite_is_a_mistake(number: float | Sequence[float]) -> None:
    with pytest.raises(ValueError, match=r"^'a' cannot be .*: not finite$"):
        changed("a: 1", {("a",): number})


def test_a_byte_order_mark_stays_where_the_text_has_one() -> None:
    document = parse("\ufeffa: 1\n", "f.yaml")
    assert patched(document, "f.yaml", {("a",): 2}) == "a: 2.0\n"
    kept = Document("f.yaml", document.data, {"f.yaml": "\ufeffa: 1\n"}, document.spans)
    assert patched(kept, "f.yaml", {("a",): 2}) == "\ufeffa: 2.0\n"
    assert patched(kept, "f.yaml", {("b",): 2}) == "\ufeffa: 1\nb: 2.0\n"


def test_a_source_that_is_not_there_is_a_mistake() -> None:
    with pytest.raises(KeyError, match=r"g\.yaml"):
        patched(parse("a: 1", "f.yaml"), "g.yaml", {("a",): 2})


def test_a_value_of_an_included_file_is_set_there() -> None:
    files = {
        "f.yaml": "parts:\n- p.yaml\n- {link: {x: 1}}\nbase: b.json\n",
        "p.yaml": "# part\nlink: l.yaml\n",
        "l.yaml": "x: 3  # x\nz: 1\n",
        "b.json": '{"x": 1}',
    }
    document = joined(files)
    x, y = ("parts", 0, "link", "x"), ("parts", 0, "link", "y")
    assert patched(document, "l.yaml", {x: 2, y: 4}, {"y": "x"}) == "x: 2.0  # x\ny: 4.0\nz: 1\n"
    assert patched(document, "b.json", {("base", "y"): 2}) == '{"x": 1, "y": 2.0}'
    assert patched(document, "p.yaml", {("parts", 0, "y"): 2}) == files["p.yaml"] + "y: 2.0\n"
    new = files["f.yaml"].replace("x: 1", "x: 5.0")
    assert patched(document, "f.yaml", {("parts", 1, "link", "x"): 5}) == new
    assert refusal(document, "f.yaml", {x: 2, y: 4}) == (
        Problem(Span("l.yaml", 1, 1), f"{NOT}it stands in 'l.yaml'", "set y: 4.0 by hand"),
        Problem(Span("l.yaml", 1, 4), f"{NOT}it stands in 'l.yaml'", "set x: 2.0 by hand"),
    )


def test_a_value_of_a_file_included_twice_is_set_only_for_both() -> None:
    document = joined({"f.yaml": "parts: [p.yaml, p.yaml]\n", "p.yaml": "x: 1\n"})
    first, second = ("parts", 0, "x"), ("parts", 1, "x")
    assert patched(document, "p.yaml", {first: 2, second: 2}) == "x: 2.0\n"
    both: Values = {("parts", 0, "y"): 2, ("parts", 1, "y"): 2}
    assert patched(document, "p.yaml", both) == "x: 1\ny: 2.0\n"
    assert refusal(document, "p.yaml", {first: 2, second: 3, ("parts", 1, "y"): 4}) == (
        Problem(
            Span("p.yaml", 1, 1),
            f"{NOT}it is shared with 'parts[0].y'{TWICE}",
            "set y: 4.0 by hand",
        ),
        Problem(
            Span("p.yaml", 1, 4),
            f"{NOT}it is shared with 'parts[1].x'{TWICE}",
            "set x: 2.0 by hand",
        ),
        Problem(
            Span("p.yaml", 1, 4),
            f"{NOT}it is shared with 'parts[0].x'{TWICE}",
            "set x: 3.0 by hand",
        ),
    )


def test_a_file_that_includes_itself_keeps_its_values() -> None:
    document = joined({"f.yaml": "base: f.yaml\nx: 1\n"})
    for pointer, other in ((("x",), "base.x"), (("base", "x"), "x")):
        message = f"{NOT}it is shared with '{other}'{TWICE}"
        assert refusal(document, "f.yaml", {pointer: 2}) == (
            Problem(Span("f.yaml", 2, 4), message, "set x: 2.0 by hand"),
        )


def test_a_value_from_the_command_line_is_not_in_the_file() -> None:
    document = override(override(parse("a: 1\nb: {}\n", "f.yaml"), "a=2"), "b={c: 1}")
    problems = refusal(document, "f.yaml", {("a",): 3, ("b", "d"): 4})
    assert [problem.message for problem in problems] == [
        f"{NOT}it stands in '--set 'a''",
        f"{NOT}it stands in '--set 'b''",
    ]


@pytest.mark.parametrize(
    ("text", "pointer", "shared"),
    [
        ("a: &x 1\nb: *x\n", ("a",), "'b'"),
        ("a: &x 1\nb: *x\n", ("b",), "'a'"),
        ("a: &x {c: 1}\nb: *x\n", ("b", "c"), "'a.c'"),
        ("a: &x {c: 1}\nb: *x\n", ("b", "d"), "'a.d'"),
        ("a: &x {c: 1}\nb: {<<: *x, d: 1}\n", ("b", "c"), "'a.c'"),
        ("a: &x {c: 1}\nb: {<<: *x, d: 1}\n", ("a", "c"), "'b.c'"),
        ("- &x [1]\n- *x\n", (0, 0), "'[1][0]'"),
    ],
)
def test_a_shared_value_is_refused(text: str, pointer: Pointer, shared: str) -> None:
    assert only(text, {pointer: 2}).message == f"{NOT}it is shared with {shared}{ALIAS}"


def test_a_list_with_a_shared_item_is_refused_once() -> None:
    problem = only("x: &x 1\na: [2, *x, *x]\n", {("a",): [1, 2, 3]})
    assert problem == Problem(
        Span("f.yaml", 2, 4),
        f"{NOT}it is shared with 'x'{ALIAS}",
        "set a: [1.0, 2.0, 3.0] by hand",
    )


def test_a_shared_value_is_set_if_all_who_share_it_are() -> None:
    text = "a: &x {c: 1}\nb: *x\n"
    assert changed(text, {("a", "c"): 2, ("b", "c"): 2}) == "a: &x {c: 2.0}\nb: *x\n"
    new = "a: &x {c: 1, d: 2.0}\nb: *x\n"
    assert changed(text, {("a", "d"): 2, ("b", "d"): 2}) == new
    own = "a: &x {c: 1}\nb: {<<: *x, c: 2}\nd: {<<: {c: 3}}\n"
    new = "a: &x {c: 5.0}\nb: {<<: *x, c: 6.0}\nd: {<<: {c: 7.0}}\n"
    assert changed("a: &x {c: 1}\nb: {<<: *x, d: 2}\n", {("a", "d"): 3}) == (
        "a: &x {c: 1, d: 3.0}\nb: {<<: *x, d: 2}\n"
    )
    assert changed(own, {("a", "c"): 5, ("b", "c"): 6, ("d", "c"): 7}) == new


@pytest.mark.parametrize(
    ("text", "pointer", "value", "place", "reason"),
    [
        ("a: {b: 1}", ("a",), 2, (1, 4), "a mapping is written there"),
        ("a: [1, 2]", ("a",), 2, (1, 4), "a list of 2 is written there"),
        ("a: [1, [2]]", ("a",), [2], (1, 4), "a list of 2 is written there"),
        ("a: [1, # b\n 2]", ("a",), [2], (1, 4), "a list of 2 is written there"),
        ("a:\n- 1\n", ("a",), [1, 2], (2, 1), "a list of 1 is written there"),
        ("{a, b: 1}", ("a",), 2, (1, 2), "its key has no ':'"),
        ("a: 'x\n  # y'\n", ("a",), 2, (1, 4), "it is not written on one line"),
        ("a: |\n  # x\n", ("a",), 2, (1, 4), "it is not written on one line"),
        ("a: x\n  y\n", ("a",), 2, (1, 4), "it is not written on one line"),
        ("a: 1\n", ("b", "c"), 2, (1, 1), "'b' is not a mapping that is there"),
        ("a: 1\n", ("a", "c"), 2, (1, 1), "'a' is not a mapping that is there"),
        ("a: [1]\n", ("a", 1), 2, (1, 1), "'a' is not a mapping that is there"),
        ("- 1\n", (1,), 2, (1, 1), "the file is not a mapping that is there"),
        (
            "a: &x {c: 1}\nb:\n  <<: *x\n",
            ("b", "d"),
            2,
            (2, 1),
            "no key of its mapping is written there",
        ),
        ("{x: &x 1, a: *x}", ("d",), 2, (1, 1), "it would follow an alias"),
        ("{x: &x 1, a: [1, *x]}", ("d",), 2, (1, 1), "it would follow an alias"),
        (
            "a: &x {c: 1}\nb: {<<: *x}\n",
            ("a", "d"),
            2,
            (1, 1),
            "its mapping is merged into 'b'",
        ),
        ("a: |-\n\n", ("a",), 2, (1, 4), "the text around it would read differently"),
        ("- [a: 1]\n", (0, 0, "b"), 2, (1, 4), "the text around it would read differently"),
        ("a: 1\n", ("true",), 2, (1, 1), "the text around it would read differently"),
    ],
)
def test_what_cannot_be_set_by_itself_is_refused(
    text: str,
    pointer: Pointer,
    value: float | Sequence[float],
    place: tuple[int, int],
    reason: str,
) -> None:
    problem = only(text, {pointer: value})
    assert (problem.span.line, problem.span.column) == place
    assert problem.message == NOT + reason


def test_every_value_that_is_refused_is_named_and_no_other() -> None:
    text = "a: &x {c: 1}\nb: {<<: *x}\ne: 1\n"
    document = parse(text, "f.yaml")
    reads = f"{NOT}its mapping is merged into 'b'"
    assert refusal(document, "f.yaml", {("e",): 1, ("a", "d"): 2}) == (
        Problem(Span("f.yaml", 1, 1), reads, "set d: 2.0 by hand"),
    )
    reads = f"{NOT}the text around it would read differently"
    assert refusal(document, "f.yaml", {("e",): 1, ("null",): 2}) == (
        Problem(Span("f.yaml", 1, 1), reads, "set null: 2.0 by hand"),
    )
    assert refusal(document, "f.yaml", {("e",): 1, ("a", "c"): 2, ("g", 0): 3}) == (
        Problem(
            Span("f.yaml", 1, 1),
            f"{NOT}'g' is not a mapping that is there",
            "set g[0]: 3.0 by hand",
        ),
        Problem(
            Span("f.yaml", 1, 11), f"{NOT}it is shared with 'b.c'{ALIAS}", "set c: 2.0 by hand"
        ),
    )


TEXT = """\
# a finger

name: finger   # of two
links:

  - {mass: 1e-2, size: [ 1,2 , 3 ], "é": '7'}   # first
  - mass: 2.50 # kg

    # how stiff
    joint:
      spring: 0.1     # N m
      damping:        # not known
    size:
    - 1
    # between
    - 2
  # the last
  - base: {a: 1,
           b: 2}
"""


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\r"])
def test_nothing_but_the_number_changes(line_break: str) -> None:
    text = TEXT.replace("\n", line_break)
    document = parse(text, "f.yaml")
    scalars = [p for p in document.spans if not isinstance(document.at(p), dict | list)]
    assert len(scalars) == 13
    for pointer in scalars:
        # Without the number it is the old text, without what stood there.
        before, after = changed(text, {pointer: 123.5}).split("123.5")
        old = text[len(before) : len(text) - len(after)]
        was = document.at(pointer)
        assert old == "" if was is None else parse(old, "f.yaml").data == was
        assert text.startswith(before.removesuffix(" ") if was is None else before)
        assert text.endswith(after)


# On a line of its own, on a last line that has no end, in brackets.
NEW_KEY = (
    r" *\"?new\"?: 123\.5(\r\n|\r|\n)",
    r"(\r\n|\r|\n) *new: 123\.5$",
    r",\s*\"?new\"?: 123\.5",
)


@pytest.mark.parametrize("line_break", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("end", ["", "\n"])
def test_nothing_but_the_new_key_comes_in(line_break: str, end: str) -> None:
    text = (TEXT.rstrip("\n") + end).replace("\n", line_break)
    document = parse(text, "f.yaml")
    holders = {p: value for p in document.spans if isinstance(value := document.at(p), dict)}
    assert len(holders) == 6
    for holder, mapping in holders.items():
        for sibling in mapping:
            new = changed(text, {(*holder, "new"): 123.5}, {"new": sibling})
            without = {re.sub(pattern, "", new, count=1) for pattern in NEW_KEY}
            assert text in without - {new}
