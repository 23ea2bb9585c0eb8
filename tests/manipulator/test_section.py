"""Cross-sections against integration, limits and published constants."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from somo_cli.manipulator.section import Section, parse_section

SHAPES = [
    "box:0.02,0.012",
    "box:0.003,0.02",
    "disc:0.007",
    "stadium:0.03,0.01",
    "stadium:0.01,0.03",
]


def half_height(text: str, x: np.ndarray) -> np.ndarray:
    """Return the largest y inside a shape for each x [m], from what its name means."""
    name, _, numbers = text.partition(":")
    sizes = [float(word) for word in numbers.split(",")]
    if name == "disc":
        return np.sqrt(np.maximum(sizes[0] ** 2 - x**2, 0))
    if name == "box":
        return np.where(np.abs(x) <= sizes[0] / 2, sizes[1] / 2, 0.0)
    radius = min(sizes) / 2
    beyond = np.maximum(np.abs(x) - max(sizes[0] / 2 - radius, 0), 0)
    straight = max(sizes[1] / 2 - radius, 0)
    cap = np.sqrt(np.maximum(radius**2 - beyond**2, 0))
    return np.where(beyond <= radius, straight + cap, 0.0)


def integrated(text: str) -> tuple[float, float, float]:
    """Return area, Ix and Iy of a shape by the midpoint rule over strips along y."""
    first = float(text.partition(":")[2].split(",")[0])
    half = first if text.startswith("disc") else first / 2
    # strips that grow thin towards the ends, where discs are steep
    edges = -half * np.cos(np.linspace(0, math.pi, 20_001))
    x, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    y = half_height(text, x)
    return (
        float(np.sum(2 * y * width)),
        float(np.sum(2 / 3 * y**3 * width)),
        float(np.sum(2 * y * x**2 * width)),
    )


@pytest.mark.parametrize("text", SHAPES)
def test_area_and_second_moments_are_those_of_the_integrals(text: str) -> None:
    section = parse_section(text)
    area, about_x, about_y = integrated(text)
    assert section.area == pytest.approx(area, rel=1e-6)
    assert section.second_moment((1, 0)) == pytest.approx(about_x, rel=1e-6)
    assert section.second_moment((0, 1)) == pytest.approx(about_y, rel=1e-6)


@pytest.mark.parametrize("bore", ["disc:0.003", "box:0.012,0.004", "stadium:0.015,0.006"])
def test_a_bore_is_subtracted(bore: str) -> None:
    outer = parse_section("stadium:0.03,0.01")
    hollow = outer.without(parse_section(bore))
    solid, void = integrated("stadium:0.03,0.01"), integrated(bore)
    assert hollow.area == pytest.approx(solid[0] - void[0], rel=1e-6)
    assert hollow.second_moment((3, 0)) == pytest.approx(solid[1] - void[1], rel=1e-6)
    assert hollow.second_moment((0, -2)) == pytest.approx(solid[2] - void[2], rel=1e-6)
    assert str(hollow) == f"stadium:0.03,0.01 with a bore of {bore}"


def test_textbook_sections() -> None:
    box = parse_section("box:0.02,0.012")
    assert box.second_moment((1, 0)) == pytest.approx(0.02 * 0.012**3 / 12, rel=1e-14)
    assert box.second_moment((0, 1)) == pytest.approx(0.02**3 * 0.012 / 12, rel=1e-14)
    ring = parse_section("disc:0.01").without(parse_section("disc:0.008"))
    assert ring.second_moment((1, 1)) == pytest.approx(math.pi / 4 * (1e-8 - 0.008**4), rel=1e-14)
    assert ring.torsion_constant() == pytest.approx(math.pi / 2 * (1e-8 - 0.008**4), rel=1e-14)
    assert parse_section("disc:0.01").torsion_constant() == pytest.approx(math.pi / 2e8, rel=1e-14)


def test_an_oblique_axis_is_that_of_a_turned_grid() -> None:
    """I(axis) = ∫ (distance from the axis)² dA over the cells of a grid on the box itself."""
    x, y = np.meshgrid((np.arange(400) - 199.5) * 5e-5, (np.arange(400) - 199.5) * 3e-5)
    axis = (0.6, -1.7)
    distance = (x * axis[1] - y * axis[0]) / math.hypot(*axis)
    total = float(np.sum(distance**2) * 5e-5 * 3e-5)
    assert parse_section("box:0.02,0.012").second_moment(axis) == pytest.approx(total, rel=1e-5)
    square = parse_section("box:0.01,0.01")
    assert square.second_moment(axis) == pytest.approx(1e-8 / 12, rel=1e-14)


def test_an_axis_without_direction_is_refused() -> None:
    with pytest.raises(ValueError, match=re.escape("the bending axis (0.0, 0.0) has no direction")):
        parse_section("disc:1").second_moment((0.0, 0.0))
    with pytest.raises(ValueError, match="no direction"):
        parse_section("disc:1").second_moment((math.nan, 1.0))


# Timoshenko and Goodier, Theory of Elasticity, 3rd ed., sec. 109: J / (a b³), to their digits, and
# of the square to seven
@pytest.mark.parametrize(
    ("ratio", "constant", "digits"),
    [
        (1.0, 0.1405770, 5e-8),
        (1.2, 0.166, 5e-4),
        (1.5, 0.196, 5e-4),
        (2.0, 0.229, 5e-4),
        (2.5, 0.249, 5e-4),
        (3.0, 0.263, 5e-4),
        (4.0, 0.281, 5e-4),
        (5.0, 0.291, 5e-4),
        (10.0, 0.312, 5.5e-4),
    ],
)
def test_the_torsion_of_a_box_is_that_of_the_table(
    ratio: float, constant: float, digits: float
) -> None:
    size = 0.01
    for text in (f"box:{ratio * size},{size}", f"box:{size},{ratio * size}"):
        found = parse_section(text).torsion_constant() / (ratio * size**4)
        assert found == pytest.approx(constant, abs=digits)


def test_the_torsion_of_a_box_is_its_plain_series() -> None:
    for a, b in ((1.0, 1.0), (1.0, 0.7), (1.0, 0.1)):
        odd = np.arange(1, 20_001, 2)
        series = float(np.sum(np.tanh(odd * math.pi * a / (2 * b)) / odd**5.0))
        plain = a * b**3 / 3 * (1 - 192 * b / (math.pi**5 * a) * series)
        assert parse_section(f"box:{a},{b}").torsion_constant() == pytest.approx(plain, rel=1e-13)


def test_a_thin_strip_has_a_third_of_its_thickness_cubed() -> None:
    strip = parse_section("box:1e-5,10").torsion_constant()
    assert strip == pytest.approx(10 * 1e-15 / 3, rel=1e-6)


def test_a_stadium_as_wide_as_high_is_a_disc() -> None:
    stadium, disc = parse_section("stadium:0.02,0.02"), parse_section("disc:0.01")
    assert (stadium.core, stadium.rounding) == (disc.core, disc.rounding)
    assert stadium.torsion_constant() == disc.torsion_constant()


@pytest.mark.parametrize(
    ("outer", "bore"),
    [
        ("stadium:0.03,0.01", None),
        ("box:0.03,0.03", "disc:0.01"),
        ("disc:0.03", "box:0.01,0.01"),
        ("box:0.03,0.03", "box:0.01,0.01"),
    ],
)
def test_other_sections_have_no_closed_form_of_torsion(outer: str, bore: str | None) -> None:
    section = parse_section(outer)
    if bore is not None:
        section = section.without(parse_section(bore))
    message = f"there is no closed form for the torsion of '{section}'; give the rigidity instead"
    with pytest.raises(ValueError, match=re.escape(message)):
        section.torsion_constant()


@pytest.mark.parametrize(
    ("outer", "bore", "fits"),
    [
        ("disc:0.01", "disc:0.0099", True),
        ("disc:0.01", "disc:0.01", False),
        ("disc:0.01", "box:0.014,0.014", True),
        ("disc:0.01", "box:0.0142,0.0142", False),
        ("disc:0.01", "box:0.019,0.006", True),
        ("disc:0.01", "box:0.019,0.0064", False),
        ("box:0.02,0.01", "disc:0.0049", True),
        ("box:0.02,0.01", "disc:0.005", False),
        ("box:0.02,0.01", "box:0.019,0.01", False),
        ("box:0.02,0.01", "stadium:0.005,0.012", False),
        ("stadium:0.03,0.01", "box:0.02,0.0099", True),
        ("stadium:0.03,0.01", "box:0.022,0.0099", False),
        ("stadium:0.03,0.01", "stadium:0.029,0.009", True),
    ],
)
def test_a_bore_has_to_fit_strictly_inside(outer: str, bore: str, fits: bool) -> None:
    section, void = parse_section(outer), parse_section(bore)
    if fits:
        assert section.without(void).bore == void
    else:
        message = re.escape(f"the bore '{bore}' does not fit inside '{outer}'")
        with pytest.raises(ValueError, match=message):
            section.without(void)


def test_there_is_one_bore_and_it_has_none_itself() -> None:
    def hollow(outer: str, bore: str) -> Section:
        return parse_section(outer).without(parse_section(bore))

    with pytest.raises(ValueError, match="'disc:3' has a bore already: 'disc:1'"):
        hollow("disc:3", "disc:1").without(parse_section("disc:2"))
    with pytest.raises(
        ValueError, match="the bore 'disc:2 with a bore of disc:1' has a bore itself"
    ):
        parse_section("disc:3").without(hollow("disc:2", "disc:1"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("box:0.02", "'box:0.02' needs two numbers: box:X,Y in metres"),
        ("box:", "'box:' needs two numbers: box:X,Y in metres"),
        ("disc:1,2", "'disc:1,2' needs one number: disc:R in metres"),
        ("stadium:1,2,3", "'stadium:1,2,3' needs two numbers: stadium:X,Y in metres"),
        ("disc:1cm", "'1cm' in 'disc:1cm' is not a number: disc:R in metres"),
        ("disc:nan", "'nan' in 'disc:nan' is not a number: disc:R in metres"),
        ("box:1,", "'' in 'box:1,' is not a number: box:X,Y in metres"),
        ("box:1,0", "0 in 'box:1,0' is not positive: box:X,Y in metres"),
        ("box:-1,1", "-1 in 'box:-1,1' is not positive: box:X,Y in metres"),
        ("disc:inf", "inf in 'disc:inf' is not from 1e-09 to 1000: disc:R in metres"),
        ("disc:1e-10", "1e-10 in 'disc:1e-10' is not from 1e-09 to 1000: disc:R in metres"),
        (
            "circle:1",
            "'circle:1' is not a known shape: use box:X,Y, disc:R or stadium:X,Y in metres",
        ),
        ("", "'' is not a known shape: use box:X,Y, disc:R or stadium:X,Y in metres"),
    ],
)
def test_other_texts_are_not_sections(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        parse_section(text)


def test_blanks_do_not_matter() -> None:
    spaced, plain = parse_section(" box : 0.02, 0.01 "), parse_section("box:0.02,0.01")
    assert (spaced.core, spaced.rounding) == (plain.core, plain.rounding)
