"""The shortest decimals of many floats at once, to the last character those of `repr`.

`repr` takes longer for a number than the engine does for a joint's step. Here a number x > 0 is
scaled to m = x 10^k within [1e16, 1e17), kept as a sum of two floats with an error below 1e-13.
There, half a unit in the last place of x is 0.5 to 12. So the shortest decimal that reads back as
x is the multiple of 100 nearest to m if it lies within that half unit, else such a multiple of 10,
else the nearest integer; zeros at its end are dropped. `repr` writes what lies within
`DECISION_MARGIN` of such a decision, numbers from 10 on, those below `SMALLEST`, powers of two,
and NaN.

orjson writes the same digits faster, but spells 1e-09 as 1e-9 and NaN as null: files would change.

Dekker, Num. Math. 18 (1971) 224 (the product of two floats as a sum of two).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

SMALLEST = 1e-200
LARGEST = 10.0  # from here on the point stands elsewhere
DECISION_MARGIN = 1e-6
_SPLIT = 134217729.0  # 2^27 + 1
_EXPONENTS = range(-200, 1)
_EXPONENT_BITS = 0x7FF << 52
_END_OFFSET = 29  # where a number's end is, in the 32 bytes that it has before they are packed

Floats = npt.NDArray[np.float64]
Words = npt.NDArray[np.uint64]
Whole = npt.NDArray[Any]
"""Whole numbers of any type."""


def lines(values: Floats) -> bytes:
    """Return the rows of a table, shape (rows, columns), as lines of CSV."""
    rows, columns = values.shape
    if columns == 0:
        return b"\n" * int(rows)
    words = _words(np.ascontiguousarray(values, dtype=np.float64).ravel())
    bytes_of = words.view(np.uint8).reshape(rows, columns, 32)
    bytes_of[:, -1, _END_OFFSET] = ord("\n")
    return words.tobytes().translate(None, b"\0")


@np.errstate(all="ignore")  # NaN is left to repr
def _words(values: Floats) -> Words:
    """Return each number as 32 bytes, shape (n, 4): characters, in between them zeros."""
    size = np.abs(values)
    is_known = (size >= SMALLEST) & (size < LARGEST) & (np.frexp(size)[0] != 0.5)
    x = np.where(is_known, size, 1.0)
    # a logarithm that is off by a digit beside a power of ten leads out of [1e16, 1e17)
    exponent = np.floor(np.log10(x)).clip(_EXPONENTS[0], _EXPONENTS[-1]).astype(np.int64)
    digits, is_sure = _shortest(x, exponent)
    is_known &= is_sure
    words = _packed_bytes(digits, exponent)
    sign = values.view(np.uint64) >> 63
    sign *= ord("-")
    words[:, 0] |= sign
    is_zero = size == 0
    if is_zero.any():
        words[is_zero] = np.array([_word("\0" + "0.0"), 0, 0, _END], dtype="<u8")
        words[is_zero, 0] |= sign[is_zero]
    others = np.flatnonzero(~(is_known | is_zero))
    if len(others):
        texts = (
            repr(value).ljust(_END_OFFSET, "\0") + ",\0\0" for value in values[others].tolist()
        )
        words[others] = np.frombuffer("".join(texts).encode(), dtype="<u8").reshape(-1, 4)
    return words


def _shortest(
    x: Floats, exponent: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Return the digits of the shortest decimal as an integer of 17 digits, and where it is sure.

    `exponent` is that of the first digit.
    """
    place = exponent - _EXPONENTS.start
    power, upper, lower, rest = (table.take(place) for table in _POWERS)
    product = x * power
    wide = x * _SPLIT
    x_upper = wide - (wide - x)
    x_lower = x - x_upper
    # Dekker's product: m = product + error; from 2^53 on product is an integer
    error = ((x_upper * upper - product) + x_upper * lower + x_lower * upper) + x_lower * lower
    error += x * rest
    # the remainder of m above a multiple of 100, and the decimal nearest to it
    whole = product.astype(np.int64)
    hundreds = whole // 100 * 100
    remainder = (whole - hundreds) + error
    half = _half_in_the_last_place(x) * power
    found = np.rint(remainder)
    margin = np.abs(np.abs(remainder - found) - 0.5)  # how far m is from where the decision changes
    for unit in (10, 100):
        nearest = np.rint(remainder / unit) * unit
        distance = np.abs(remainder - nearest)
        np.minimum(margin, np.abs(distance - half), out=margin)
        np.minimum(margin, np.abs(distance - 0.5 * unit), out=margin)
        np.copyto(found, nearest, where=distance < half)
    hundreds += found.astype(np.int64)
    return hundreds, (margin > DECISION_MARGIN) & (hundreds >= 10**16) & (hundreds < 10**17)


def _half_in_the_last_place(x: Floats) -> Floats:
    """Return half the distance from normal numbers to the next: 2^-53 times the power of two."""
    bits = x.view(np.int64) & _EXPONENT_BITS
    bits -= 53 << 52
    return bits.view(np.float64)


def _packed_bytes(digits: npt.NDArray[np.int64], exponent: npt.NDArray[np.int64]) -> Words:
    """Return signless numbers as 32 bytes each: 8 up to the first digit and a point, 16, 8."""
    first, rest = _quotients_and_remainders(digits, 10**16)
    halves = (half.astype(np.uint32) for half in _quotients_and_remainders(rest, 10**8))
    groups = [part for half in halves for part in _quotients_and_remainders(half, 10**4)]
    words = np.empty((len(digits), 4), dtype="<u8")
    place = exponent - _EXPONENTS.start
    has_rest = rest != 0
    words[:, 0] = np.where(has_rest, _HEADS[0].take(place), _HEADS[1].take(place))
    words[:, 0] += (first.astype(np.uint64) + np.uint64(ord("0"))) << np.uint64(48)
    fours = words.view("<u4")
    is_end = np.ones(len(digits), dtype=np.int64)  # whether nothing but zeros follows
    for number in (3, 2, 1, 0):
        group = groups[number]
        fours[:, 2 + number] = _DIGIT_QUADS.take(group + 10**4 * is_end)
        is_end &= group == 0
    fours[:, 2] += np.where(has_rest | (exponent < 0), 0, ord("0")).astype(np.uint32)
    words[:, 3] = _TAILS.take(place)
    return words


def _quotients_and_remainders(numbers: Whole, divisor: int) -> tuple[Whole, Whole]:
    """Return quotients and remainders; numpy's own remainder is slow."""
    quotients = numbers // divisor
    return quotients, numbers - quotients * divisor


def _word(text: str) -> np.uint64:
    return np.uint64(int.from_bytes(text.encode(), "little"))


def _head(exponent: int, has_rest: bool) -> np.uint64:
    """Return what stands before the first digit, and the point behind it: sign, 5, 1, 1 bytes."""
    is_fixed = exponent >= -4
    zeros = ("0." + "0" * (-exponent - 1)) if is_fixed and exponent < 0 else ""
    has_point = exponent == 0 or (not is_fixed and has_rest)
    return _word("\0" + zeros.ljust(6, "\0") + ("." if has_point else ""))


def _tail(exponent: int) -> np.uint64:
    power = "" if exponent >= -4 else f"e-{-exponent:02}"
    return _word(power.ljust(_END_OFFSET - 24, "\0") + ",")


def _powers() -> tuple[Floats, Floats, Floats, Floats]:
    """Return 10^(16 - exponent) as a float, its upper and its lower half, and what it lacks."""
    exact = [10 ** (16 - exponent) for exponent in _EXPONENTS]
    power = np.array([float(one) for one in exact])
    wide = power * _SPLIT
    upper = wide - (wide - power)
    rest = [float(one - int(near)) for one, near in zip(exact, power.tolist(), strict=True)]
    return power, upper, power - upper, np.array(rest)


def _digit_quads() -> npt.NDArray[np.uint32]:
    """Return the characters of 0 to 9999, four each; then again, but for zeros at the end."""
    figures = np.arange(10**4)[:, None] // [1000, 100, 10, 1]
    is_end = figures * [1000, 100, 10, 1] == np.arange(10**4)[:, None]
    whole = (figures % 10 + ord("0")).astype(np.uint8)
    is_zero_at_end = (figures % 10 == 0) & np.column_stack([is_end[:, :1] & False, is_end[:, :-1]])
    is_zero_at_end[0] = True
    return (
        np.concatenate([whole, np.where(is_zero_at_end, 0, whole)])
        .astype(np.uint8)
        .view("<u4")[:, 0]
    )


_END = _tail(0)
_POWERS = _powers()
_HEADS = tuple(
    np.array([_head(exponent, has_rest) for exponent in _EXPONENTS], dtype="<u8")
    for has_rest in (True, False)
)
_TAILS = np.array([_tail(exponent) for exponent in _EXPONENTS], dtype="<u8")
_DIGIT_QUADS = _digit_quads()
