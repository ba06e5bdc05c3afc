"""Samples, plots and figures without a browser: by hand, and by formulas that are printed elsewhere."""

import math
from types import SimpleNamespace as Some
from typing import Any

import pytest
from nicegui import ui

from bus.protocol import Device
from host.console.figures import (
    Clocks,
    airmass,
    clocks,
    duration,
    hours,
    number,
    pointing,
    summary,
    until_limit_s,
)
from host.console.live import KEPT, RATIO, Live, Sample
from host.console.plots import PANELS, options, plots, rms_text, series, span
from host.console.views import BusState
from host.telescope.alarms import Severity
from tests.host.console.paper import ZERO_STEPS, Page, PaperBus, PaperTelescope, axis, on_paper, snapshot

TURN_ARCSEC = 1296000.0


def live() -> tuple[Live, PaperTelescope, PaperBus]:
    telescope, bus = PaperTelescope(), PaperBus()
    return Live(telescope, bus), telescope, bus  # type: ignore[arg-type]


def sample(t_s: float, error: Any = (None, None), rate: Any = (None, None)) -> Sample:
    return Sample(t_s, error, rate, (0.0, 0.0), (0.0,) * 4, (None, None), (None, None))


def test_the_gear_is_the_papers() -> None:
    """Section 2.2: 113/27, 123/21 and 250/17 are 360.5."""
    assert pytest.approx(360.5, abs=0.05) == RATIO


def test_a_sample_holds_one_moment() -> None:
    made, telescope, _ = live()
    telescope.snapshot = snapshot(
        activity="tracking", errors_arcsec=(0.5, -0.25),
        ra=axis(effort=0.125, currents_a=(0.1, 0.2), rate_arcsec_s=100.0, motor_turns_s=(0.03, 0.025)),
        dec=axis(effort=-0.5, currents_a=(0.3, 0.4), rate_arcsec_s=-40.0, motor_turns_s=(0.01, 0.01)),
    )  # fmt: skip
    made.take()
    taken = made.samples[-1]
    assert taken[:5] == (10.0, (0.5, -0.25), (100.0, -40.0), (12.5, -50.0), (0.1, 0.2, 0.3, 0.4))
    assert taken.gear[0] == pytest.approx(0.0275 * TURN_ARCSEC / 100) and taken.gear[1] is None
    made.take()
    assert len(made.samples) == 1, "time has not gone on"
    telescope.snapshot = telescope.snapshot._replace(t_s=10.25, activity="slewing", slewing=True)
    made.take()
    assert made.samples[-1][:3] == (10.25, (None, None), (None, None)) and len(made.samples) == 2


@pytest.mark.parametrize(("rate", "turns", "gear"), [
    (49.9, (1.0, 1.0), None), (-50.0, (1.0, None), TURN_ARCSEC / 50), (50.0, (None, None), None),
    (50.0, (-1.0, 0.5), 0.25 * TURN_ARCSEC / 50),
])  # fmt: skip
def test_a_gear_is_seen_above_50_arcseconds_a_second(rate: float, turns: Any, gear: float | None) -> None:
    made, telescope, _ = live()
    telescope.snapshot = snapshot(dec=axis(rate_arcsec_s=rate, motor_turns_s=turns))
    made.take()
    assert made.samples[-1].gear == (None, gear if gear is None else pytest.approx(gear))


def test_a_twist_is_of_the_tachometers_counts() -> None:
    """4096 counts to a turn of a motor, 360.5 turns to one of the axis."""
    from bus.protocol import pack_tach

    made, telescope, _ = live()
    heard = telescope.client.link.measurements
    heard[Device.MOTOR_RA_A] = pack_tach(Device.MOTOR_RA_A, 0, 5000, 0)
    made.take()
    assert made.samples[-1].twist_arcsec == (None, None)
    heard[Device.MOTOR_RA_B] = pack_tach(Device.MOTOR_RA_B, 0, 952, 0)
    heard[Device.MOTOR_DEC_B] = pack_tach(Device.MOTOR_DEC_B, 0, 952, 0)
    telescope.snapshot = snapshot(t_s=11.0)
    made.take()
    expected = 4048 / 4096 / 360.5 * TURN_ARCSEC
    ra, dec = made.samples[-1].twist_arcsec
    assert ra == pytest.approx(expected, rel=1e-3) and dec is None


def test_alarms_of_the_telescope_the_bus_and_the_house_come_together() -> None:
    made, telescope, bus = live()
    bus.state = BusState([], 0.6, {}, [(1, "noise, on")], [])
    telescope.house.causes = ["WEATHER_MAST: rain"]
    telescope.snapshot = snapshot(t_s=0.5, ra=axis(fault=True))
    made.take()
    early = {each.what: each.severity for each in made.alarms.standing}
    assert early == {
        "RA: FAULT, the motors are off": Severity.ALARM, "the bus is loaded": Severity.WARNING,
        "fault 1 runs: noise": Severity.WARNING,
    }  # fmt: skip
    telescope.snapshot = snapshot(t_s=10.0)
    made.take()
    assert "WEATHER_MAST: rain" in [each.what for each in made.alarms.standing]
    assert (10.0, "WARNING: WEATHER_MAST: rain") in made.events.kept


def test_clocks_are_looked_at_every_fourth_sample_and_two_minutes_are_kept() -> None:
    made, telescope, _ = live()
    seen: list[str] = []
    for k in range(9):
        telescope.snapshot = snapshot(t_s=10.0 + k)
        made.take()
        seen.append(made.clocks.utc)
    assert seen == ["14:00:10"] * 4 + ["14:00:14"] * 4 + ["14:00:18"]
    assert made.samples.maxlen == KEPT == 480


def test_hours_are_of_a_day_rounded_to_tenths() -> None:
    assert hours(0.0) == "00h00m00.0s" and hours(math.pi) == "12h00m00.0s"
    assert hours(2 * math.pi - 1e-9) == "00h00m00.0s" and hours(-math.pi / 2) == "18h00m00.0s"
    assert hours(math.radians(15 * (5 + 16 / 60 + 41.36 / 3600))) == "05h16m41.4s"


def test_clocks_of_a_place_by_hand() -> None:
    """An hour before the meridian is 60.16 minutes less 10 s of sidereal against UTC."""
    _, telescope, _ = live()
    steps = ZERO_STEPS - round(1.0 / 24 * 2**29)
    telescope.snapshot = snapshot(ra=axis(steps=steps))
    found = clocks(telescope)  # type: ignore[arg-type]
    assert found.utc == "14:00:10" and found.sidereal == "04h40m37"
    assert found.to_meridian == "0:59 h before"
    telescope.snapshot = snapshot(ra=axis(steps=ZERO_STEPS + round(2.01 / 24 * 2**29)))
    assert clocks(telescope).to_meridian == "2:00 h after"  # type: ignore[arg-type]
    telescope.snapshot = snapshot(dec=axis(steps=None))
    assert clocks(telescope) == Clocks("14:00:10", "04h40m37", "–", "–", "–")  # type: ignore[arg-type]
    assert pointing(telescope)[:5] == ("–",) * 5  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("altitude_deg", "mass"), [(90, 1.0), (60, 1.154), (30, 1.994), (10, 5.59), (0, 37.92)]
)
def test_the_airmass_is_kastens_and_youngs_table(altitude_deg: float, mass: float) -> None:
    """Their table II, to three or four digits."""
    assert airmass(math.radians(altitude_deg)) == pytest.approx(mass, rel=2e-3)
    assert airmass(math.radians(-0.01)) is None


def test_a_limit_is_met_by_the_minute() -> None:
    """The soft limit is at 80° of hour angle, 15.04° an hour; the pole at 85° north never sets."""
    _, telescope, _ = live()
    about = telescope.observatory
    left = until_limit_s(about, 0.0, math.radians(60))
    assert left is not None and left == pytest.approx(80 / 15.041 * 3600, abs=60) and left % 60 == 0
    south = until_limit_s(about, 0.0, math.radians(-40))
    assert south is not None and south < 80 / 15.041 * 3600
    assert until_limit_s(about, 0.0, math.radians(-50)) == 0.0
    wide = Some(site=about.site, horizon_rad=-2.0, mount=Some(ra=Some(within=lambda _: True)))
    assert until_limit_s(wide, 0.0, 0.0) is None  # type: ignore[arg-type]


def test_durations_and_numbers_are_cut_and_dashed() -> None:
    assert duration(3599.9) == "0:59 h" and duration(3600) == "1:00 h" and duration(36061) == "10:01 h"
    assert (
        number(None, ".1f", " V") == "–" and number(1.25, "+.2f", " V") == "+1.25 V" and number(2, "d") == "2"
    )


@pytest.mark.parametrize(("fields", "words"), [
    ({}, "idle, motors off"),
    ({"powered": True}, "idle"),
    ({"powered": True, "target": "Vega"}, "idle"),
    ({"powered": True, "target": "Vega", "slewing": True}, "idle, Vega"),
    ({"powered": True, "target": "Vega", "tracking": True}, "idle, Vega"),
    ({"parked": True}, "idle, parked, motors off"),
    ({"powered": True, "ra": axis(fault=True)}, "idle, FAULT"),
    ({"powered": True, "dec": axis(fault=True, soft_limit=True)}, "idle, FAULT, SOFT LIMIT"),
    ({"powered": True, "ra": axis(soft_limit=True)}, "idle, SOFT LIMIT"),
])  # fmt: skip
def test_a_summary_says_what_is_the_case(fields: dict[str, Any], words: str) -> None:
    assert summary(snapshot(**fields)) == words


def test_a_span_leaves_out_what_a_tenth_does_alone() -> None:
    """By hand: of 20 values the two at either end are cut; the room between the others is 1."""
    values = [-100.0, -50.0, *[0.0] * 8, *[1.0] * 8, 80.0, 90.0]
    assert span(values, 0.1) == {"min": -1.05, "max": 2.05}
    assert span([0.0, 1.0], 0.1) == {"min": -0.05, "max": 1.05}
    assert span([5.0], 1.0) == {"min": 4.5, "max": 5.5}
    assert span([0.0, 0.5], 2.0) == {"min": -0.75, "max": 1.25}


def test_the_rms_is_of_what_the_plot_shows() -> None:
    shown = [sample(0.0, (100.0, 0.0)), sample(100.0, (3.0, None)), sample(200.0, (4.0, None))]
    assert rms_text(shown) == f"rms of 120 s: RA {math.sqrt(12.5):.2f}″, Dec –"
    assert rms_text([]) == "rms of 120 s: RA –, Dec –"


def test_a_line_has_seconds_before_now_and_four_digits() -> None:
    taken = [sample(79.999, (9.0, 9.0)), sample(80.0, (0.123456, None)), sample(200.004, (1.0, 2.0))]
    lines = series([*taken[1:], sample(200.0, (5.0, 6.0))], PANELS[0][2], 2)
    assert lines == [[[-120.0, 0.1235], [0.0, 1.0], [0.0, 5.0]], [[-120.0, None], [0.0, 2.0], [0.0, 6.0]]]
    assert series(taken, PANELS[0][2], 2)[0][0] == [0.0, 1.0] and series([], PANELS[0][2], 3) == [[], [], []]


@pytest.mark.parametrize(("mode", "colours"), [
    ("night", ["#ff6a5a", "#b3463b", "#ff8f80", "#8a3026"]),
    ("day", ["#0b5cad", "#a85a00", "#16202c", "#7a5a2a"]),
])  # fmt: skip
def test_a_plot_is_in_the_consoles_colours(mode: str, colours: list[str]) -> None:
    made = options(("a", "b", "c"), mode)
    assert made["color"] == colours and made["animation"] is False
    assert (made["xAxis"]["min"], made["xAxis"]["max"]) == (-120, 0)
    assert [each["name"] for each in made["series"]] == ["a", "b", "c"]
    assert [each["lineStyle"]["type"] for each in made["series"]] == ["solid", "dashed", "solid"]
    assert made["yAxis"]["scale"] is True and made["legend"]["top"] == 0
    assert made["yAxis"]["axisLabel"] == {"color": colours[0], "showMinLabel": False, "showMaxLabel": False}
    assert made["grid"] == {"left": 55, "right": 24, "top": 24, "bottom": 24}


def framed(shell: Any) -> None:
    with shell.page("/", "Plots"):
        plots(shell)


def test_plots_are_drawn_anew_once_a_second() -> None:
    async def work(page: Page) -> None:
        page.live.samples.append(sample(10.0, (1.0, 2.0), (15.0, 0.0)))
        page.build(framed).tick()
        error, rate, effort, current = page.every(ui.echart)
        assert error.options["series"][0]["data"] == [[0.0, 1.0]] and rate.options["series"][0]["data"] == [
            [0.0, 15.0]
        ]
        assert [len(each.options["series"]) for each in (error, rate, effort, current)] == [2, 2, 2, 4]
        assert (error.options["yAxis"]["min"], error.options["yAxis"]["max"]) == (0.95, 2.05)
        heights = [
            each.options["yAxis"]["max"] - each.options["yAxis"]["min"] for each in (rate, effort, current)
        ]
        assert heights == pytest.approx([16.5, 1.0, 0.02])
        assert "rms of 120 s: RA 1.00″, Dec 2.00″" in page.texts()
        assert error.props["aria-label"] == "Position error, ″ over the last two minutes"
        page.live.samples.append(sample(11.0, (1.0, 2.0), (15.0, 0.0)))
        page.shell.day = True
        page.tick(3)
        assert len(error.options["series"][0]["data"]) == 1 and error.options["color"][0] == "#ff6a5a"
        page.tick()
        assert len(error.options["series"][0]["data"]) == 2 and error.options["color"][0] == "#0b5cad"

    on_paper(work)
