"""Objects to point at: what the lists hold, one's own file and what is wrong with it; where the Moon is."""

import datetime as dt
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from host.console.skymap import CENTRE, Chart, svg
from host.sky.catalogue import STARS, Star
from host.sky.listed import VARIABLE, Listed, bright_stars, listed, moon, read
from host.sky.observed import Clock, Observed, observe, observe_all
from host.sky.site import NAINITAL
from host.telescope import Observatory
from tests.host.console.test_parts import MOUNT

EVENING = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))


@pytest.fixture(autouse=True)
def fresh() -> Iterator[None]:
    listed.cache_clear()
    yield
    listed.cache_clear()


def test_the_lists_hold_stars_messier_and_the_bright_ngc() -> None:
    found = listed()
    assert sum(name.startswith("M ") for name in found) >= 109  # M 102 is in doubt, and left out
    assert sum(name.startswith("NGC ") for name in found) > 200
    assert all(found[name].star == star and found[name].stellar for name, star in STARS.items())
    crab = found["M 1 (Crab Nebula)"].star
    assert math.degrees(crab.right_ascension_rad) == pytest.approx(83.633, abs=0.01)
    assert math.degrees(crab.declination_rad) == pytest.approx(22.0145, abs=0.01)
    assert found["Sirius"].magnitude == pytest.approx(-1.44, abs=0.1)


def test_bright_stars_are_where_the_alignment_stars_are() -> None:
    """Two lists of their own, both of Hipparcos."""
    others = {each.star.name: each.star for each in bright_stars()}
    both = [name for name in STARS if name in others]
    assert len(both) > 20
    for name in both:
        off = math.degrees(abs(others[name].declination_rad - STARS[name].declination_rad)) * 3600
        assert off < 2, name


def test_ones_own_list_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "own.csv"
    own.write_text("# of tonight\nname,ra,dec\nComet,12:00:00,+10:00:00\nVega,00:00:00,+00:00:00\n")
    monkeypatch.setenv(VARIABLE, str(own))
    found = listed()
    assert list(found)[:2] == ["Comet", "Vega"] and found["Vega"].star.right_ascension_rad == 0
    assert found["Comet"] == Listed(Star("Comet", math.pi, math.radians(10)), None)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name,ra\nX,1:00:00\n", "line 1: the head line needs name, ra and dec"),
        ("", "line 1: the head line needs"),
        ("name,ra,dec\nX,1:00:00\n", "line 2: declination '' cannot be read"),
        ("name,ra,dec\n" + "X" * 200_000 + ",1:00:00,+10:00:00\n", "line 2: field larger than"),
        ("name,ra,dec\nX,25:00:00,+10:00:00\n", "line 2: right ascension '25:00:00' is outside"),
        ("# note\nname,ra,dec,magnitude\nX,1:00:00,+10:00:00,bright\n", "line 3: magnitude 'bright' is no"),
        ("name,ra,dec,magnitude\nX,1:00:00,+10:00:00,nan\n", "line 2: magnitude 'nan' is no number"),
        ("\x80", "cannot be read"),
    ],
)
def test_a_list_that_cannot_be_read_says_where(text: str, said: str, tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_bytes(text.encode("latin-1"))
    with pytest.raises(ValueError, match=f"own.csv: {said}"):
        read(own)
    with pytest.raises(ValueError, match="cannot be read"):
        read(tmp_path / "none.csv")
    with own.open("wb") as file:
        file.truncate(1 << 33)
    with pytest.raises(ValueError, match="is longer than 50000000 bytes"):
        read(own)


def test_many_at_once_are_where_each_is() -> None:
    stars = [STARS["Pollux"], STARS["Polaris"]]
    many = observe_all(stars, NAINITAL, EVENING, 60.0)
    for k, star in enumerate(stars):
        one = observe(star, NAINITAL, EVENING, 60.0)
        assert many[0][k] == pytest.approx(one.altitude_rad, abs=1e-4)  # proper motion and parallax


def test_the_moon_of_an_eclipse_is_full_and_opposite_the_sun() -> None:
    """3 March 2026, 11:34 UTC: total, greatest over the Pacific; new two weeks before, on 17 February."""
    _, lit = moon(NAINITAL, Clock(dt.datetime(2026, 3, 3, 11, 34, tzinfo=dt.UTC)), 0.0)
    assert lit > 0.9999
    _, lit = moon(NAINITAL, Clock(dt.datetime(2026, 2, 17, 12, 1, tzinfo=dt.UTC)), 0.0)
    assert lit < 0.001


def test_a_click_means_the_object_or_the_sky_beside_it_or_nothing() -> None:
    about = Observatory(NAINITAL, EVENING, MOUNT)
    chart = Chart(about)
    picture = chart.layer(0.0)
    assert "Capella" in picture and "sky-cloud" in picture and chart.layer(1.0) is picture
    seen = observe(STARS["Capella"], NAINITAL, EVENING, 0.0)
    r = 100 * (1 - seen.altitude_rad / (math.pi / 2))
    x, y = CENTRE - r * math.sin(seen.azimuth_rad), CENTRE - r * math.cos(seen.azimuth_rad)
    assert chart.pick(x + 0.5, y) == STARS["Capella"]
    assert chart.pick(1.0, 1.0) is None  # beyond the horizon
    bare = next(
        found
        for k in range(200)
        if isinstance(found := chart.pick(CENTRE + 0.4 * k, CENTRE - 30.0), Observed)
    )
    assert bare.altitude_rad > 0


def test_the_slit_is_on_the_chart_where_there_is_a_dome() -> None:
    about = Observatory(NAINITAL, EVENING, MOUNT)
    assert "sky-slit" not in svg(about, None, None) and "sky-slit" in svg(about, None, None, 90.0)
