"""The sky map by hand: zenith in the middle, north up, east left, a hundred units to the horizon."""

import math
import re
from typing import Any

import pytest

from host.console import skymap
from host.console.skymap import CENTRE, RADIUS, SIZE, Chart, boundary, svg
from host.sky.catalogue import Star
from host.sky.listed import Listed
from host.sky.mount import limits_mount
from host.sky.observed import Observed, horizontal
from host.sky.site import NAINITAL
from host.sky.visibility import Observatory
from tests.host.console.paper import NIGHT

DEG = math.pi / 180
MOUNT = limits_mount(80 * DEG, -45 * DEG, 85 * DEG, NAINITAL.latitude_rad)


def about() -> Observatory:
    return Observatory(NAINITAL, NIGHT, MOUNT)


def place(altitude_deg: float, azimuth_deg: float) -> Observed:
    return Observed(0.0, 0.0, altitude_deg * DEG, azimuth_deg * DEG)


def circles(text: str, kind: str) -> list[Any]:
    """Middle and radius of all circles of a class."""
    found = []
    for each in re.findall(rf'<circle ([^>]*)class="{kind}"', text):
        numbers = dict(re.findall(r'(\w+)="([-\d.]+)"', each))
        found.append((float(numbers.get("cx", 0)), float(numbers.get("cy", 0)), float(numbers["r"])))
    return found


@pytest.mark.parametrize(("altitude_deg", "azimuth_deg", "x", "y"), [
    (90, 0, 0, 0), (0, 0, 0, -100), (0, 90, -100, 0), (0, 180, 0, 100), (0, 270, 100, 0), (45, 90, -50, 0),
    (30, 180, 0, 66.7),
])  # fmt: skip
def test_a_place_is_seen_lying_on_ones_back(
    altitude_deg: float, azimuth_deg: float, x: float, y: float
) -> None:
    made = svg(about(), place(altitude_deg, azimuth_deg), place(altitude_deg + 1e-6, azimuth_deg))
    assert circles(made, "sky-here") == [(pytest.approx(x, abs=0.05), pytest.approx(y, abs=0.05), 3.5)]
    assert circles(made, "sky-target") == [(pytest.approx(x, abs=0.05), pytest.approx(y, abs=0.05), 6)]


def test_what_is_below_the_horizon_is_at_its_edge_or_not_there() -> None:
    made = svg(about(), place(-20, 90), place(-1, 90))
    assert circles(made, "sky-here") == [(-100, 0, 3.5)] and "sky-target" not in made
    assert "sky-target" not in svg(about(), None, place(0, 90)) and "sky-here" not in svg(about(), None, None)


def test_rings_limits_and_names_of_the_map() -> None:
    made = svg(about(), None, None)
    assert made.startswith('<g transform="translate(120 120)">') and SIZE == (240, 240)
    assert circles(made, "sky-ground") == [(0, 0, 100)]
    assert circles(made, "sky-free") == [(0, 0, pytest.approx(100 * 75 / 90, abs=0.05))]
    assert [r for _, _, r in circles(made, "sky-ring")] == pytest.approx([66.7, 33.3])
    names = re.findall(r'<text x="([-\d.]+)" y="([-\d.]+)" class="sky-text">(.)</text>', made)
    assert names == [
        ("0.0", "-104.0", "N"),
        ("-109.0", "4.0", "E"),
        ("0.0", "112.0", "S"),
        ("109.0", "4.0", "W"),
    ]
    path = re.search(r'<path d="M([^Z]*)Z" class="sky-limit"', made)
    assert path is not None and len(path[1].split("L")) == 240


@pytest.mark.parametrize(
    ("slit_deg", "x", "y"), [(0.0, 0.0, -100.0), (90.0, -100.0, 0.0), (210.0, 50.0, 86.6)]
)
def test_the_slit_is_a_line_to_the_edge(slit_deg: float, x: float, y: float) -> None:
    made = svg(about(), None, None, slit_deg)
    line = re.search(r'<line x2="([-\d.]+)" y2="([-\d.]+)" class="sky-slit"/>', made)
    word = re.search(r'<text x="([-\d.]+)" y="([-\d.]+)" class="sky-name">slit</text>', made)
    assert line is not None and word is not None
    assert [float(each) for each in line.groups()] == pytest.approx([x, y], abs=0.06)
    assert [float(each) for each in word.groups()] == pytest.approx([0.93 * x, 0.93 * y], abs=0.06)


def test_the_boundary_goes_around_the_rectangle_of_the_soft_limits() -> None:
    """Sixty steps to a side, corners first."""
    found = boundary(MOUNT, NAINITAL)
    assert len(found) == 240
    for k, (h, d) in {
        0: (-80, -45), 30: (0, -45), 60: (80, -45), 90: (80, 20), 120: (80, 85), 150: (0, 85), 180: (-80, 85),
        210: (-80, 20), 15: (-40, -45), 135: (40, 85),
    }.items():  # fmt: skip
        wanted = horizontal(h * DEG, d * DEG, NAINITAL)
        assert found[k] == pytest.approx((wanted.altitude_rad, wanted.azimuth_rad), abs=1e-6), k
    over = limits_mount(80 * DEG, -95 * DEG, 100 * DEG, 0.5)
    heights = boundary(over, NAINITAL)
    pole = horizontal(0.3, 90 * DEG, NAINITAL)
    assert heights[150][0] == pytest.approx(pole.altitude_rad, abs=1e-6)


def listing(*each: tuple[str, float | None, bool]) -> dict[str, Listed]:
    """Objects at hour angle nought, a degree apart from 30 degrees of declination on."""
    from host.sky.observed import Place, sidereal_time_rad, star_of_apparent

    sidereal = sidereal_time_rad(NAINITAL, NIGHT, 0.0)
    found = {}
    for k, (name, magnitude, stellar) in enumerate(each):
        star = star_of_apparent(Place(sidereal, (30 + 9 * k) * DEG), NIGHT, 0.0, name)
        found[name] = Listed(Star(name, star.right_ascension_rad, star.declination_rad), magnitude, stellar)
    return found


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> dict[str, Listed]:
    made = listing(
        ("bright", -1.0, True), ("named", 1.29, True), ("plain", 1.3, True), ("faint", 4.99, True),
        ("gone", 5.0, True), ("cloud", 1.0, False), ("unknown", None, False),
    )  # fmt: skip
    monkeypatch.setattr(skymap, "listed", lambda: made)
    monkeypatch.setattr(skymap, "moon", lambda *_: (place(-5, 0), 0.5))
    return made


def test_stars_are_as_large_as_they_are_bright_and_the_brightest_have_names(shown: dict[str, Listed]) -> None:
    layer = Chart(about()).layer(0.0)
    stars = circles(layer, "sky-star")
    assert [r for _, _, r in stars] == pytest.approx([1.9, 1.2, 1.2, 0.4])
    assert [r for _, _, r in circles(layer, "sky-cloud")] == [1.6, 1.6]
    assert [x for x, _, _ in stars] == pytest.approx([0.0] * 4, abs=0.2)
    height = 90 - (30 - math.degrees(NAINITAL.latitude_rad))
    assert stars[0][1] == pytest.approx(-(90 - height) / 0.9, abs=0.1)
    names = re.findall(r'<text x="[-\d.]+" y="([-\d.]+)" class="sky-name">(\w+)</text>', layer)
    assert [name for _, name in names] == ["bright", "named"]
    assert float(names[0][0]) == pytest.approx(stars[0][1] - 3, abs=0.11)
    assert "sky-moon" not in layer


def test_a_star_without_a_magnitude_is_drawn_as_of_the_third(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(skymap, "listed", lambda: listing(("own", None, True), ("dim", 4.5, True)))
    assert [r for _, _, r in circles(Chart(about()).layer(0.0), "sky-star")] == pytest.approx([0.7, 0.4])


def test_the_moon_is_drawn_with_its_lit_share(
    monkeypatch: pytest.MonkeyPatch, shown: dict[str, Listed]
) -> None:
    monkeypatch.setattr(skymap, "moon", lambda *_: (place(45, 180), 0.456))
    layer = Chart(about()).layer(0.0)
    assert circles(layer, "sky-moon") == [(pytest.approx(0.0, abs=0.05), 50.0, 4)]
    assert re.search(r'<text x="-?0.0" y="44.0" class="sky-name">Moon, 46 %</text>', layer)


def test_the_sky_is_looked_at_anew_every_half_minute(shown: dict[str, Listed], monkeypatch: Any) -> None:
    chart = Chart(about())
    first = chart.layer(100.0)
    monkeypatch.setattr(skymap, "listed", lambda: listing(("one", 1.0, True)))
    assert chart.layer(129.9) is first and chart.layer(70.1) is first
    assert chart.layer(130.0) != first


def test_a_click_is_an_object_the_bare_sky_or_nothing(shown: dict[str, Listed]) -> None:
    chart = Chart(about())
    assert isinstance(chart.pick(CENTRE, CENTRE), Observed), "before anything was drawn"
    chart.layer(0.0)
    x, y, each = chart._seen[3]
    for off in (0.0, 2.4):
        assert chart.pick(CENTRE + x + off, CENTRE + y) is each.star
    bare = chart.pick(CENTRE + x + 2.6, CENTRE + y)
    assert isinstance(bare, Observed)
    assert chart.pick(CENTRE + 100.1, CENTRE) is None and chart.pick(CENTRE, CENTRE + RADIUS) is None
    for left, top, azimuth in ((-50.0, 0.0, 90), (50.0, 0.0, 270), (0.0, 50.0, 180), (35.0, -35.0, 315)):
        found = chart.pick(CENTRE + left, CENTRE + top)
        assert isinstance(found, Observed)
        assert math.degrees(found.azimuth_rad) == pytest.approx(azimuth)
        assert math.degrees(found.altitude_rad) == pytest.approx(90 - 0.9 * math.hypot(left, top))
