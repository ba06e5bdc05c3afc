"""The night log: an observer's words, in order, once each; what the wire carries is not in it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from host.console.live import Live
from host.console.pages.dome import interlock_text
from host.console.plots import PANELS, rms_text, series, span
from host.telescope import Refused
from host.telescope.alarms import Severity, of_house
from scenarios.doors.piped_host import BusMirror
from tests.host.telescope.conftest import Rig


@pytest.fixture
def final(tmp_path: Path) -> Iterator[Rig]:
    made = Rig(tmp_path, network="final")
    yield made
    made.host.close()


def looked(rig: Rig, live: Live, seconds: float) -> list[str]:
    """What is logged meanwhile; the consoles look four times a second."""
    before = len(live.events.kept)
    for _ in range(round(seconds * 4)):
        rig.advance(0.25)
        live.take()
    return [text for _, text in list(live.events.kept)[before:]]


@pytest.mark.slow
def test_a_night_in_words(final: Rig) -> None:
    live = Live(final.telescope, BusMirror([], [], lambda _: None))
    first = looked(final, live, 1.0)
    assert {"Parked", "Motors off", "Shutter closed", "Weather safe"} <= set(first)
    star = final.up("Capella")
    final.do(lambda t: t.drive.goto(star, wake=True))
    final.do(lambda t: t.house.slave(True))
    said = looked(final, live, 90.0)
    order = ["Motors on", "Slewing Capella", "Tracking Capella"]
    assert [text for text in said if text in order] == order and "Dome follows the telescope" in said
    assert not any("TRACK_RATE" in text for text in said)
    assert any("TRACK_RATE" in entry.text for entry in final.pc.journal.entries)  # the wire's own log

    with pytest.raises(Refused):
        final.do(lambda t: t.house.turn(10.0))
    final.run(lambda t: t.house.shutter(True))
    assert "Shutter open" in looked(final, live, 60.0)
    mast = final.network.board("WEATHER_MAST")
    mast.pins["rain"] = lambda _t_ns: 1.0  # type: ignore[attr-defined]
    said = looked(final, live, 3.0)
    assert "Weather unsafe: WEATHER_MAST: rain" in said and "ALARM: WEATHER_MAST: rain" in said
    assert of_house(final.telescope.house) == {"WEATHER_MAST: rain": Severity.ALARM}
    assert "Shutter closed" in looked(final, live, 60.0)
    assert of_house(final.telescope.house) == {"WEATHER_MAST: rain": Severity.WARNING}
    text = interlock_text(final.telescope.house.unsafe(), final.telescope.house.reading("DOME"))
    assert text == "Interlock: the shutter is kept shut (WEATHER_MAST: rain)."
    with pytest.raises(Refused, match="not allowed"):
        final.run(lambda t: t.house.shutter(True))


@pytest.mark.slow
def test_the_tracking_strip_is_not_ruined_by_a_slew(final: Rig) -> None:
    live = Live(final.telescope, BusMirror([], [], lambda _: None))
    assert rms_text(live.samples) == "rms of 120 s: RA –, Dec –"
    star = final.up()
    final.do(lambda t: t.drive.goto(star, wake=True))
    looked(final, live, 110.0)
    assert final.telescope.snapshot.activity == "tracking"
    errors, rates = (
        [y for line in series(live.samples, pick, 2) for _, y in line if y is not None]
        for _, _, pick, _ in PANELS[:2]
    )
    assert max(map(abs, rates)) < 600  # the slew is a gap, not a peak of 3000″/s
    ends = span(errors, 0.2)
    assert -20 < ends["min"] < 0 < ends["max"] < 20
    assert rms_text(live.samples).startswith("rms of 120 s: RA 0.")
    final.do(lambda t: t.drive.stop())
    looked(final, live, 150.0)  # the sky leaves; that is no error
    assert rms_text(live.samples) == "rms of 120 s: RA –, Dec –"


def test_a_peak_does_not_set_the_scale() -> None:
    ends = span([*[0.1, -0.1] * 50, 3000.0], 0.2)
    assert -0.5 < ends["min"] < -0.1 and 0.1 < ends["max"] < 0.5
    assert span([], 0.2) == {"min": -0.1, "max": 0.1}, "an empty plot has an axis"
    assert span([0.0] * 9, 0.2) == {"min": -0.1, "max": 0.1}
