from __future__ import annotations

import contextlib
import json
import math
import pickle
import random
import time

import pytest

from somo_cli.document.parse import Document, parse
from somo_cli.problems import InvalidFile, Pointer, Span

SOURCE = "f.yaml"


def value_of(text: str) -> object:
    return parse(text, SOURCE).data


def faults_of(text: str) -> list[tuple[int, int, str, str]]:
    with pytest.raises(InvalidFile) as caught:
        parse(text, SOURCE)
    assert {problem.span.source for problem in caught.value.problems} == {SOURCE}
    return [(p.span.line, p.span.column, p.message, p.hint) for p in caught.value.problems]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1e-3", 1e-3),
        ("1E5", 1e5),
        ("1.0e3", 1e3),
        ("+.5", 0.5),
        ("-.5e-3", -0.5e-3),
        ("1.0e-3", 1e-3),
        ("1.e-3", 1e-3),
        (".5", 0.5),
        ("5.", 5.0),
        ("0.", 0.0),
        ("0", 0),
        ("-0", 0),
        ("+12", 12),
        ("0o17", 15),
        ("0x1F", 31),
        ("1" * 300, int("1" * 300)),
        ("true", True),
        ("True", True),
        ("FALSE", False),
        ("null", None),
        ("~", None),
        ("", None),
        # Not numbers, dates or booleans in YAML 1.2.
        ("yes", "yes"),
        ("no", "no"),
        ("on", "on"),
        ("off", "off"),
        ("y", "y"),
        ("n", "n"),
        ("1:30", "1:30"),
        ("190:20:30", "190:20:30"),
        ("2020-01-01", "2020-01-01"),
        ("1_000", "1_000"),
        ("nan", "nan"),
        ("inf", "inf"),
        ("[-]", ["-"]),
        ("1e", "1e"),
        (".", "."),
        ("0o8", "0o8"),
        ("-0x1F", "-0x1F"),
        ("0b11", "0b11"),
        ("=", "="),
        ("'017'", "017"),
        ('"1e-3"', "1e-3"),
        ("'true'", "true"),
        ("''", ""),
        ("|\n  1\n  2", "1\n2\n"),
    ],
)
def test_a_scalar_has_the_value_of_the_core_schema(text: str, expected: object) -> None:
    value = value_of(f"a: {text}\n")
    assert value == {"a": expected}
    assert isinstance(value, dict)
    assert type(value["a"]) is type(expected)


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        ("017", "a number with a leading zero is ambiguous: 017", "write 17 or '017'"),
        ("010", "a number with a leading zero is ambiguous: 010", "write 10 or '010'"),
        ("09", "a number with a leading zero is ambiguous: 09", "write 9 or '09'"),
        ("-007", "a number with a leading zero is ambiguous: -007", "write -7 or '-007'"),
        ("00.5", "a number with a leading zero is ambiguous: 00.5", "write 0.5 or '00.5'"),
        (".nan", "not a finite number: .nan", "write an ordinary number"),
        (".NaN", "not a finite number: .NaN", "write an ordinary number"),
        (".inf", "not a finite number: .inf", "write an ordinary number"),
        ("-.INF", "not a finite number: -.INF", "write an ordinary number"),
        ("1e400", "not a finite number: 1e400", "write an ordinary number"),
        (
            "9" * 5000,
            f"not a finite number: {'9' * 56} ...",
            "write an ordinary number",
        ),
        (
            "0x" + "f" * 5000,
            f"not a finite number: 0x{'f' * 54} ...",
            "write an ordinary number",
        ),
        (
            "!!python/object/apply:os.system [id]",
            "tag '!!python/object/apply:os.system' is not allowed",
            "remove the tag",
        ),
        ("!!float 5", "tag '!!float' is not allowed", "remove the tag"),
        ("!shape box", "tag '!shape' is not allowed", "remove the tag"),
    ],
)
def test_a_scalar_that_could_mean_something_else_is_refused(
    text: str, message: str, hint: str
) -> None:
    assert faults_of(f"a: {text}\n") == [(1, 4, message, hint)]


def test_keys_are_strings() -> None:
    assert value_of("on: 1\n'2': 3\n1e-3x: 4\n") == {"on": 1, "2": 3, "1e-3x": 4}
    assert faults_of("1: a\ntrue: b\n~: c\n? [x]\n: d\n? {x: y}\n: e\n.nan: f\n? \n: h\n") == [
        (1, 1, "a key must be a string, found 1", "write '1', in quotes"),
        (2, 1, "a key must be a string, found true", "write 'true', in quotes"),
        (3, 1, "a key must be a string, found ~", "write '~', in quotes"),
        (4, 3, "a key must be a string, found a list", "check the brackets"),
        (6, 3, "a key must be a string, found a mapping", "check the brackets"),
        (8, 1, "not a finite number: .nan", "write an ordinary number"),
        (9, 2, "a key must be a string, found nothing", "name the key"),
    ]


def test_every_duplicate_key_is_found() -> None:
    assert faults_of("a: 1\nb: {c: 1, c: 2}\na: 2\n'a': 3\n") == [
        (2, 11, "duplicate key 'c', first on line 2", "keep one of them"),
        (3, 1, "duplicate key 'a', first on line 1", "keep one of them"),
        (4, 1, "duplicate key 'a', first on line 1", "keep one of them"),
    ]


def test_all_problems_are_reported_at_once_in_reading_order() -> None:
    text = (
        "a: 017\n"
        "b: [1, .nan, 2]\n"
        "a: {1: .inf}\n"
        "c: !!int '3'\n"
        '<<: {d: "\\0"}\n'
        "<<: 5\n"
        "---\n"
        "e: 010\n"
    )
    assert faults_of(text) == [
        (1, 4, "a number with a leading zero is ambiguous: 017", "write 17 or '017'"),
        (2, 8, "not a finite number: .nan", "write an ordinary number"),
        (3, 1, "duplicate key 'a', first on line 1", "keep one of them"),
        (3, 5, "a key must be a string, found 1", "write '1', in quotes"),
        (3, 8, "not a finite number: .inf", "write an ordinary number"),
        (4, 4, "tag '!!int' is not allowed", "remove the tag"),
        (5, 9, "control character '\\x00' in a string", "remove it"),
        (6, 1, "duplicate key '<<', first on line 5", "keep one of them"),
        (
            6,
            5,
            "'<<' takes a mapping or a list of mappings",
            "name an anchor, as in '<<: *base'",
        ),
        (7, 1, "a second document starts here", "keep one document in a file"),
    ]


def test_anchors_aliases_and_merge_keys() -> None:
    text = (
        "base: &base {mass: 1, shape: box}\n"
        "other: &other\n"
        "  <<: *base\n"
        "  mass: 2\n"
        "both:\n"
        "  <<: [*other, *base]\n"
        "  colour: red\n"
        "same: *base\n"
        "'<<': plain\n"
    )
    base = {"mass": 1, "shape": "box"}
    document = parse(text, SOURCE)
    assert document.data == {
        "base": base,
        "other": {"mass": 2, "shape": "box"},
        "both": {"mass": 2, "shape": "box", "colour": "red"},
        "same": base,
        "<<": "plain",
    }
    # A merged value stands where its anchor does.
    assert document.span(("both", "shape"), key=True) == Span(SOURCE, 1, 23, 5)
    assert document.span(("both", "mass")) == Span(SOURCE, 4, 9, 1)
    assert document.span(("same", "mass")) == Span(SOURCE, 1, 20, 1)
    assert document.span(("base",)) == Span(SOURCE, 1, 13, 1)


def test_an_aliased_value_is_not_shared() -> None:
    data = value_of("a: &a [1]\nb: *a\n")
    assert isinstance(data, dict)
    data["a"].append(2)
    assert data["b"] == [1]


@pytest.mark.parametrize("text", ["", "  \n\n", "# only this\n", "---\n", "---\n...\n", "\ufeff"])
def test_an_empty_file_is_refused(text: str) -> None:
    assert faults_of(text) == [(1, 1, "the file is empty", "")]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\n---\nb: 2\n", (2, 1)),
        ("a: 1\n...\n---\nb: 2\n", (3, 1)),
        ("---\na: 1\n---\n", (3, 1)),
    ],
)
def test_a_second_document_is_refused(text: str, expected: tuple[int, int]) -> None:
    message, hint = "a second document starts here", "keep one document in a file"
    assert faults_of(text) == [(*expected, message, hint)]


@pytest.mark.parametrize("text", ["---\na: 1\n", "a: 1\n...\n", "%YAML 1.2\n---\na: 1\n"])
def test_the_marks_of_one_document_are_fine(text: str) -> None:
    assert value_of(text) == {"a": 1}


@pytest.mark.parametrize(
    ("text", "expected_problem"),
    [
        ("a:\t1\n", (1, 3, "a tab cannot stand here", "use spaces")),
        ("a:\n\tb: 1\n", (2, 1, "a tab cannot stand here", "use spaces")),
        (
            "a: b: c\n",
            (1, 5, "a ':' cannot stand here", "put the value in quotes, or check the indentation"),
        ),
        ("a: @b\n", (1, 4, "a value cannot start with '@'", "put the value in quotes")),
        (
            "a: 1\n b: 2\n",
            (2, 3, "a ':' cannot stand here", "put the value in quotes, or check the indentation"),
        ),
        (
            "a: {b: 1}\n  c: 2\n",
            (
                2,
                3,
                "the indentation does not fit the lines above",
                "lines that go with line 1 start in column 1",
            ),
        ),
        (
            "a: 1\n: 2\n",
            (2, 1, "unexpected ':'", "check the indentation of this line and the line above"),
        ),
        ("a: 1\nb\nc: 2\n", (2, 1, "a ':' is missing after the key", "write 'key: value'")),
        (
            "a: [1, 2\n",
            (
                2,
                1,
                "expected ',' or ']'",
                "the bracket opened on line 1, column 4, is not closed, or a comma is missing",
            ),
        ),
        ("a: 'b\n", (1, 4, "this quote is not closed", "close it, or remove it")),
        ("a: *b\n", (1, 4, "alias '*b' has no anchor '&b' above it", "")),
        ("a: &a 1\nb: &a 2\n", (2, 4, "this anchor is already in use", "give it another name")),
        ('a: "\\UFFFFFFFF"\n', (1, 7, "this is not a character", "")),
        ('a: "\\q"\n', (1, 6, "found unknown escape character 'q'", None)),
    ],
)
def test_a_syntax_error_has_its_position(
    text: str, expected_problem: tuple[int, int, str, str | None]
) -> None:
    [(line, column, message, hint)] = faults_of(text)
    assert (line, column, message) == expected_problem[:3]
    assert expected_problem[3] is None or hint == expected_problem[3]


def test_control_characters_are_refused_with_their_place() -> None:
    hint = "remove it, or write it as an escape in quotes"
    assert faults_of("a: b\r\nc: \x00d\x00\n\x1b: 2\x7f\n\ud800\ufffe") == [
        (2, 4, "control character '\\x00'", hint),
        (3, 1, "control character '\\x1b'", hint),
        (3, 5, "control character '\\x7f'", hint),
        (4, 1, "control character '\\ud800'", hint),
        (4, 2, "control character '\\ufffe'", hint),
    ]


def test_a_binary_file_gives_few_problems_fast() -> None:
    noise = bytes(random.Random(1).choices(range(256), k=600_000)).decode("latin-1")
    start = time.process_time()
    assert len(faults_of(noise)) == 20
    assert time.process_time() - start < 10


def test_byte_order_mark_and_line_ends_change_nothing() -> None:
    plain = "a: 1\nb:\n  - 2\n  - c: x\n"
    expected = parse(plain, SOURCE)
    for text in ("\ufeff" + plain, plain.replace("\n", "\r\n"), plain.replace("\n", "\r")):
        document = parse(text, SOURCE)
        assert (document.data, document.spans) == (expected.data, expected.spans)


@pytest.mark.parametrize(
    "text",
    [
        '{"a": [1, 2.5, -1e-3, true, null], "b": {"c": "x y"}}',
        '{"a":1,"b":[{"c":"d"},{}],"e":""}',
        '\n\t{\n\t"a"\t:\t[\t1,\t2\t]\t}\n',
        '["\\/\\u0041\\n\\t\\"\\\\", "\\ud83d\\ude00", "é"]',
        '{"a": "1\\t2", "b":\t"\\\\"}',
        "[]",
        "{}",
        '"text"',
        "5",
    ],
)
def test_json_reads_as_json(text: str) -> None:
    assert value_of(text) == json.loads(text)


def test_json_with_tabs_keeps_its_places() -> None:
    text = '{\n\t"mass":\t017}'
    assert faults_of(text)[0][:2] == (2, 1)  # not JSON: the tab is YAML's
    document = parse('{\n\t"mass":\t17,\n\t"a\tb": 1}'.replace("a\tb", "a\\tb"), SOURCE)
    assert document.data == {"mass": 17, "a\tb": 1}
    assert document.span(("mass",), key=True) == Span(SOURCE, 2, 2, 6)
    assert document.span(("mass",)) == Span(SOURCE, 2, 10, 2)


def test_half_a_character_is_refused() -> None:
    message = "control character '\\ud83d' in a string"
    assert faults_of('a: "\\ud83d"\n') == [(1, 4, message, "remove it")]


def test_an_alias_bomb_is_refused_at_once() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    start = time.process_time()
    [(line, _, message, _)] = faults_of("\n".join(lines))
    assert time.process_time() - start < 10
    assert (line, message) == (6, "more than 200000 values, with aliases expanded")


def test_a_bomb_of_merges_is_refused_at_once() -> None:
    lines = ["a0: &a0 {x: 1}"]
    lines += [f"a{i}: &a{i} {{<<: [{', '.join([f'*a{i - 1}'] * 20)}]}}" for i in range(1, 9)]
    start = time.process_time()
    [(_, _, message, _)] = faults_of("\n".join(lines))
    assert time.process_time() - start < 10
    assert message == "more than 200000 values, with aliases expanded"


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [("a: &a [*a]", 1, 8), ("a: &a\n  b: 1\n  c: {d: *a}", 3, 10), ("&a {<<: *a}", 1, 9)],
)
def test_an_alias_of_itself_is_refused(text: str, line: int, column: int) -> None:
    assert faults_of(text) == [(line, column, "alias '*a' contains itself", "")]


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        ("[" * 100_000, 1, 51),
        ("{a: " * 100_000, 1, 201),
        ("- " * 100_000, 1, 101),
        ("? " * 100_000, 1, 101),
        ("a: &a " + "[" * 40 + "]" * 40 + "\nb: [[[[[[[[[[*a]]]]]]]]]]", 2, 14),
    ],
)
def test_deep_nesting_is_refused(text: str, line: int, column: int) -> None:
    start = time.process_time()
    assert faults_of(text) == [(line, column, "nested more than 50 deep", "")]
    assert time.process_time() - start < 10


def test_nesting_up_to_the_limit_is_fine() -> None:
    assert value_of("[" * 50 + "]" * 50) is not None
    assert value_of("a: &a " + "[" * 39 + "]" * 39 + "\nb: [[[[[[[[[[*a]]]]]]]]]]")


def test_a_chain_of_aliases_cannot_go_deep() -> None:
    lines = ["a0: &a0 [x]"] + [f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 500)]
    assert faults_of("\n".join(lines)) == [(50, 12, "nested more than 50 deep", "")]


def test_a_long_text_is_refused() -> None:
    assert faults_of("# " + "x" * 1_000_000) == [
        (1, 1, "the text is longer than 1000000 bytes", "")
    ]
    assert faults_of("# " + "é" * 500_000) == [(1, 1, "the text is longer than 1000000 bytes", "")]


def test_tens_of_thousands_of_values_are_fine() -> None:
    data = value_of("\n".join(f"k{i}: 1" for i in range(5_000)))
    assert isinstance(data, dict)
    assert len(data) == 5_000


# Positions


TEXT = """\
# a comment
manipulator_name: finger
links:
  - shape: box
    dimensions: [0.1, 2e-2,   3]
    empty:
    quoted: 'a b'
  - &other
    shape: cylinder
    mass: &m 0.5
    mass_again: *m
    folded: >
      some
      text
    long: one
      two
"ü key": {größe: 1, b:   -.5}
"""


def test_the_spans_of_keys_and_values() -> None:
    document = parse(TEXT, SOURCE)

    def places(*pointer: str | int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        key, value = document.span(pointer, key=True), document.span(pointer)
        return (key.line, key.column, key.width), (value.line, value.column, value.width)

    assert places() == ((1, 1, 1), (1, 1, 1))
    assert places("manipulator_name") == ((2, 1, 16), (2, 19, 6))
    assert places("links") == ((3, 1, 5), (4, 3, 1))
    assert places("links", 0) == ((4, 5, 1), (4, 5, 1))
    assert places("links", 0, "shape") == ((4, 5, 5), (4, 12, 3))
    assert places("links", 0, "dimensions") == ((5, 5, 10), (5, 17, 1))
    assert places("links", 0, "dimensions", 2) == ((5, 31, 1), (5, 31, 1))
    assert places("links", 0, "empty") == ((6, 5, 5), (6, 5, 5))
    assert places("links", 0, "quoted") == ((7, 5, 6), (7, 13, 5))
    assert places("links", 1, "mass") == ((10, 5, 4), (10, 14, 3))
    assert places("links", 1, "mass_again") == ((11, 5, 10), (10, 14, 3))
    assert places("links", 1, "folded") == ((12, 5, 6), (12, 13, 1))
    assert places("links", 1, "long") == ((15, 5, 4), (15, 11, 3))
    assert places("ü key", "größe") == ((17, 11, 5), (17, 18, 1))
    assert places("ü key", "b") == ((17, 21, 1), (17, 26, 3))


def test_a_pointer_to_nothing_is_placed_at_the_key_of_its_nearest_ancestor() -> None:
    document = parse(TEXT, SOURCE)
    assert document.span(("links", 0, "mass")) == document.span(("links", 0), key=True)
    assert document.span(("ü key", "c", 3)) == Span(SOURCE, 17, 1, 7)
    assert document.span(("nothing",)) == Span(SOURCE, 1, 1)
    assert Document("x", None, {}, {}).span(("a",)) == Span("x", 1, 1)


def test_the_value_at_a_pointer() -> None:
    document = parse(TEXT, SOURCE)
    assert document.at(()) is document.data
    assert document.at(("links", 1, "shape")) == "cylinder"
    missing: list[Pointer] = [("a",), ("links", 2), ("links", -1), ("links", "0"), ("links", 0, 0)]
    for pointer in missing:
        with pytest.raises(KeyError):
            document.at(pointer)


def plain_scalars(value: object, pointer: Pointer = ()) -> dict[Pointer, object]:
    if isinstance(value, dict):
        parts = [plain_scalars(item, (*pointer, key)) for key, item in value.items()]
    elif isinstance(value, list):
        parts = [plain_scalars(item, (*pointer, i)) for i, item in enumerate(value)]
    else:
        return {pointer: value}
    return {key: item for part in parts for key, item in part.items()}


@pytest.mark.parametrize("seed", range(20))
def test_the_text_at_every_span_starts_with_the_value(seed: int) -> None:
    rng = random.Random(seed)

    def scalar() -> str:
        return rng.choice(["1", "-2.5", "1e-3", "box", "a b", "true", "ä", "x-1", "2020-01-01"])

    def flow(depth: int) -> str:
        kind = rng.randrange(3) if depth else 0
        if kind == 0:
            return rng.choice(["", "", f"&n{rng.randrange(10**9)}  "]) + scalar()
        blank = rng.choice(["", " ", "  "])
        if kind == 1:
            return "[" + ", ".join(blank + flow(depth - 1) for _ in range(3)) + "]"
        return "{" + ", ".join(f"k{i}: {blank}{flow(depth - 1)}" for i in range(3)) + "}"

    def block(depth: int, indent: str) -> str:
        lines = []
        for i in range(rng.randrange(1, 4)):
            head = rng.choice([f"{indent}key{i}:", f"{indent}'key {i}':"])
            if depth and rng.random() < 0.5:
                lines.append(f"{head}\n{block(depth - 1, indent + '  ')}")
            else:
                lines.append(f"{head}  {flow(2)}  # comment\n")
        return "".join(lines)

    text = block(3, "")
    document = parse(text, SOURCE)
    lines = text.split("\n")
    scalars = plain_scalars(document.data)
    assert scalars
    for pointer, value in scalars.items():
        span = document.span(pointer)
        written = lines[span.line - 1][span.column - 1 :][: span.width]
        assert parse(written, SOURCE).data == value
        assert not isinstance(value, str) or written == value
        key = document.span(pointer, key=True)
        if isinstance(pointer[-1], str):
            assert lines[key.line - 1][key.column - 1 :][: key.width].strip("'") == pointer[-1]


def test_a_document_and_an_invalid_file_travel_between_processes() -> None:
    document = parse(TEXT, SOURCE)
    assert pickle.loads(pickle.dumps(document)) == document
    with pytest.raises(InvalidFile) as caught:
        parse("a: 017", SOURCE)
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (copy.problems, copy.texts) == (caught.value.problems, caught.value.texts)
    assert str(copy) == "f.yaml:1:4: error: a number with a leading zero is ambiguous: 017"
    assert copy.texts == {SOURCE: "a: 017"}


def test_mutations_of_a_file_either_parse_or_are_refused() -> None:
    rng = random.Random(7)
    alphabet = "{}[]:,-?&*!|>'\"%@`#~ \n\t\r\\.0a<é\x00\x85\u2028"
    for _ in range(800):
        text = list(TEXT)
        for _ in range(rng.randrange(1, 6)):
            place = rng.randrange(len(text))
            text[place : place + rng.randrange(3)] = rng.choices(alphabet, k=rng.randrange(4))
        with contextlib.suppress(InvalidFile):
            for value in plain_scalars(parse("".join(text), SOURCE).data).values():
                assert value is None or isinstance(value, str | bool | int | float)
                assert not isinstance(value, float) or math.isfinite(value)
