"""Pages of dome, bus, alignment, maintenance and calibration on paper."""

import math
import sys
from pathlib import Path
from typing import Any

import pytest
from nicegui import ui

from bus.protocol import Device
from host.auxiliary import Auxiliary
from host.console.live import Sample
from host.console.pages import bus as bus_module
from host.console.pages.alignment import alignment
from host.console.pages.bus import bus
from host.console.pages.calibrate import calibrate, run
from host.console.pages.dome import dome, dome_text, interlock_text
from host.console.pages.maintenance import maintenance
from host.console.views import BusState, FaultKind, Node
from host.sky.mount import STEP_ARCSEC
from host.sky.observed import Observed
from host.sky.pointmodel import PointingModel, Term
from host.telescope import Reason, Refused
from tests.host.console.paper import ZERO_STEPS, Page, axis, on_paper, samples, snapshot

DOME = {
    "Azimuth": 123.4, "Moving": 0.0, "Target": 200.0, "Opened": 0.0, "Closed": 1.0, "Shutter": 40.0,
    "ShutterMoving": 0.0, "BadWeather": 0.0,
}  # fmt: skip
WEATHER = {"Temperature": 9.96, "Humidity": 55.4, "Wind": 3.14, "Rain": 1.0, "Unsafe": 0.0}
POWER = {"Voltage": 23.996, "Current": 1.234, "Relays": 0b11111001}


@pytest.mark.parametrize(("fields", "words"), [
    ({}, "azimuth 123.4°; shutter closed"),
    ({"Closed": 0.0}, "azimuth 123.4°; shutter 40 % open"),
    ({"Closed": 0.0, "Opened": 1.0, "BadWeather": 1.0}, "azimuth 123.4°; shutter open; bad weather"),
    ({"Closed": 0.0, "Moving": 1.0, "ShutterMoving": 1.0},
     "azimuth 123.4°; turning to 200.0°; shutter 40 % open, moving"),
])  # fmt: skip
def test_a_dome_is_told_in_one_line(fields: dict[str, float], words: str) -> None:
    assert dome_text(DOME | fields) == words


@pytest.mark.parametrize(("causes", "found", "words"), [
    ([], None, "Interlock: the shutter may open."),
    (["rain", "wind"], None, "Interlock: rain; wind."),
    (["rain", "wind"], DOME, "Interlock: rain; wind."),
    (["rain", "wind"], DOME | {"BadWeather": 1.0}, "Interlock: the shutter is kept shut (rain; wind)."),
    ([], DOME | {"BadWeather": 1.0},
     "Interlock: the shutter is kept shut (the dome board hears no station)."),
])  # fmt: skip
def test_the_interlock_says_why(causes: list[str], found: Any, words: str) -> None:
    assert interlock_text(causes, found) == words


def test_a_network_without_a_house_says_so() -> None:
    async def work(page: Page) -> None:
        page.build(dome).tick()
        assert "No dome board on this network." in page.texts()
        assert [each[1][0] for each in page.tables()] == [
            "No weather board on this network.", "No power board on this network.",
        ]  # fmt: skip
        assert [len(each[1]) for each in page.tables()] == [6, 4]
        assert "The slit stays where it is; the telescope needs it at –." in page.texts()
        assert not any("stale" in each.classes for each in page.every(ui.label) if "azimuth" in each.text)

    on_paper(work)


def test_a_house_is_shown_board_by_board() -> None:
    async def work(page: Page) -> None:
        house = page.telescope.house
        house.said = {
            "DOME": DOME, "WEATHER_MAST": WEATHER, "WEATHER_DOME": WEATHER | {"Rain": 0.0, "Unsafe": 1.0},
            "POWER_DRIVES": POWER, "POWER_ROOM": POWER | {"Relays": 255},
        }  # fmt: skip
        house.old, house.slaved, house.causes = {"WEATHER_DOME", "POWER_ROOM", "DOME"}, True, ["rain"]
        page.telescope.aimed = Observed(0.0, 0.0, 1.0, math.radians(-10.0))
        page.build(dome).tick()
        weather, power = page.tables()
        assert weather[1:] == [
            ["mast", "10.0", "55", "3.1", "yes", "safe"],
            ["dome (stale)", "10.0", "55", "3.1", "no", "unsafe"],
        ]  # fmt: skip
        assert power[1:] == [
            ["POWER_DRIVES", "24.00", "1.23", "2, 3"], ["POWER_ROOM (stale)", "24.00", "1.23", "none"],
        ]  # fmt: skip
        assert "The slit follows the telescope; the telescope needs it at 350.0°." in page.texts()
        assert "Interlock: rain." in page.texts()
        shown = next(each for each in page.every(ui.label) if each.text == dome_text(DOME))
        assert "stale" in shown.classes
        house.old = set()
        page.tick()
        assert "stale" not in shown.classes

    on_paper(work)


def test_a_dome_is_commanded() -> None:
    async def work(page: Page) -> None:
        page.build(dome)
        place = page.labelled("Azimuth, °")
        assert (place.value, place.props["min"], place.props["max"]) == (0, 0, 359.9)
        await page.press("Turn")
        place.value = 123.5
        await page.press("Turn")
        for text in ("Open shutter", "Close shutter", "Stop dome", "Follow the telescope", "Stay"):
            await page.press(text)
        assert page.telescope.told == [
            ("house.turn", 0.0), ("house.turn", 123.5), ("house.shutter", True), ("house.shutter", False),
            ("house.stop",), ("house.slave", True), ("house.slave", False),
        ]  # fmt: skip
        page.telescope.snapshot = snapshot(locked=True)
        page.tick()
        enabled = {each.text for each in page.every(ui.button) if each.enabled}
        assert enabled == {"Stop dome", "STOP  (space)", "Unlock", "Night / day"}

    on_paper(work)


def test_the_bus_is_shown() -> None:
    nodes = [Node("AXIS_RA", True, "active", 1, 2, 0.01234), Node("FOCUS", False, "silent", 0, 0)]
    frames = [(1_500_000_000, "AXIS_RA", 0x2A, bytes([1, 255])), (2_000_000_000, "X", 0x7FF, b"")]

    async def work(page: Page) -> None:
        page.bus.state = BusState(nodes, 0.2345, {"CRC": 3, "form": 0}, [], frames)
        page.telescope.journal.command(3_000_000_000, "HOST", "power on", "sent")
        page.build(bus, page.bus).tick()
        assert "23.4 %" in page.texts() or "23.5 %" in page.texts()
        assert "of the last second; CRC 3" in page.texts()
        found = page.tables()
        assert found[0][1:] == [
            ["AXIS_RA", "on", "active", "1", "2", "1.23"], ["FOCUS", "OFF", "silent", "0", "0", "0.00"],
        ]  # fmt: skip
        assert [each[:4] for each in found[-1][1:]] == [
            ["2.0000", "X", "7FF", ""], ["1.5000", "AXIS_RA", "02A", "01 ff"],
        ]  # fmt: skip
        log = page.labelled("Commands and boards").content
        assert "14:00:03  HOST: power on" in log
        page.bus.state = BusState([], 0.0, {}, [], [])
        page.labelled("Follow the frames").value = False
        page.tick()
        assert "of the last second; no errors" in page.texts()
        assert len(page.tables()[-1]) == 3 and len(page.tables()[0]) == 1
        assert "This is no emulated bus: nothing can be broken from here." in page.texts()

    on_paper(work)


def test_the_bus_page_has_the_last_14_entries() -> None:
    async def work(page: Page) -> None:
        for k in range(20):
            page.telescope.journal.error(k * 1_000_000_000, "HOST", f"entry {k}")
        page.build(bus, page.bus).tick()
        lines = page.labelled("Commands and boards").content.split("\n")
        assert len(lines) == 14 and "entry 19" in lines[0] and "entry 6<" in lines[-1]

    on_paper(work)


KINDS = [
    FaultKind("silent-bus", "bus", "Nobody is heard.", "seconds=", "seconds: 0 to 60"),
    FaultKind("stuck", "board", "It hangs.", "board=", "board: any"),
]


def test_supplies_are_cut_and_faults_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(page: Page) -> None:
        page.bus.boards, page.bus.kinds = ("AXIS_RA", "FOCUS"), KINDS
        page.bus.state = BusState([], 0.0, {}, [(4, "silent-bus, for 5 s")], [])
        page.build(bus, page.bus).tick()
        assert page.labelled("Board").value == "AXIS_RA"
        await page.press("Cut its supply")
        page.labelled("Board").value = "FOCUS"
        await page.press("Give it back")
        chosen, given = page.labelled("Fault"), page.labelled("Arguments, name=value")
        assert chosen.options == {"silent-bus": "bus: silent-bus", "stuck": "board: stuck"}
        assert (chosen.value, given.value) == ("silent-bus", "seconds=")
        assert {"Nobody is heard.", "seconds: 0 to 60"} <= set(page.texts())
        chosen.value = "stuck"
        await page.settle()
        assert given.value == "board=" and {"It hangs.", "board: any"} <= set(page.texts())
        given.value = "board=FOCUS"
        await page.press("Start it")
        assert page.said == "done" and "bad" not in page.shell._said.classes
        given.value = ""
        page.bus.answer = ValueError("board is missing")
        await page.press("Start it")
        assert page.said == "board is missing" and "bad" in page.shell._said.classes
        assert page.tables()[1][1:] == [["4", "silent-bus, for 5 s"]]
        number = page.labelled("Number")
        assert (number.value, number.props["min"]) == (0, 0)
        await page.press("Clear it")
        number.value = 4.0
        await page.press("Clear it")
        assert page.bus.wishes == [
            "power AXIS_RA off", "power FOCUS on", "fault start stuck board=FOCUS", "fault start stuck ",
            "fault clear 0", "fault clear 4",
        ]  # fmt: skip
        page.bus.answer = None
        monkeypatch.setattr(bus_module, "ANSWER_S", 0.001)
        await page.press("Clear it")
        await page.later()
        assert page.said == "no slice of time has come; is it paused?"

    on_paper(work)


def model() -> PointingModel:
    terms = (
        Term(name="IH", arcsec=12.345, within_arcsec=0.678),
        Term(name="TF", arcsec=-3.0, within_arcsec=1.0),
    )
    return PointingModel(
        latitude_rad=0.5, terms=terms, stars=9, before_arcsec=40.04, after_arcsec=1.234, held_out_arcsec=2.345
    )


def test_a_star_aligns_both_encoders() -> None:
    async def work(page: Page) -> None:
        page.build(alignment)
        await page.press("Align on this star")
        assert page.said == "choose the star that is in the middle of the field"
        page.labelled("Star in the middle of the field").value = "Pollux"
        page.telescope.answers["drive.sync"] = (12.34, -5.67)
        await page.press("Align on this star")
        assert page.telescope.told[0][1].name == "Pollux"
        assert "aligned: hour angle +12.3″, declination -5.7″" in page.texts()
        page.telescope.answers["drive.sync"] = Refused(Reason.STATE, "it moves")
        await page.press("Align on this star")
        assert page.said == "it moves" and "aligned: hour angle +12.3″, declination -5.7″" in page.texts()

    on_paper(work)


def test_offsets_are_against_the_makers_zero() -> None:
    """A step is 1296000″ by two to the 29."""

    async def work(page: Page) -> None:
        about = page.telescope.observatory
        about.mount = about.mount.__class__(
            about.mount.ra.aligned(10_000), about.mount.dec, 0.0, about.mount.park_declination_rad
        )
        page.telescope.snapshot = snapshot(dec=axis(steps=None), stale=frozenset({Device.POSITION_RA}))
        page.build(alignment).tick()
        assert page.tables()[0][1:] == [
            ["RA (stale)", str(ZERO_STEPS), str(ZERO_STEPS + 10_000), f"{10_000 * 1296000 / 2**29:+.2f}"],
            ["Dec", "–", str(ZERO_STEPS), "+0.00"],
        ]  # fmt: skip
        here = next(each for each in page.every(ui.label) if each.text == "RA –, Dec –")
        assert "stale" in here.classes
        page.telescope.snapshot = snapshot(stale=frozenset({Device.POSITION_DEC}))
        page.tick()
        assert "stale" in here.classes and here.text.startswith("RA 04h40m")
        page.telescope.snapshot = snapshot()
        page.tick()
        assert "stale" not in here.classes

    on_paper(work)


def test_a_model_is_fitted_applied_and_left() -> None:
    async def work(page: Page) -> None:
        page.build(alignment).tick()
        assert "Stars aligned on: 0; the telescope points by no model" in page.texts()
        await page.press("Apply")
        assert page.said == "fit a model first" and page.telescope.told == []
        await page.press("Fit")
        assert "not fitted" in page.texts()
        page.telescope.answers["drive.fit_model"] = made = model()
        await page.press("Fit")
        assert (
            "rms on the sky: 40.0″ without, 1.23″ with the model, 2.35″ on stars held out" in page.texts()
            or (
                "rms on the sky: 40.0″ without, 1.23″ with the model, 2.34″ on stars held out" in page.texts()
            )
        )
        assert page.tables()[1][1:] == [
            ["IH", "zero of hour angle", "+12.35", "0.68"], ["TF", "tube bends, sin z", "-3.00", "1.00"],
        ] or page.tables()[1][1][2] == "+12.34"  # fmt: skip
        await page.press("Apply")
        await page.press("Without model")
        assert page.telescope.told[-2:] == [("drive.apply_model", made), ("drive.apply_model", None)]
        about = page.telescope.observatory
        about.mount = about.mount.__class__(about.mount.ra, about.mount.dec, 0.0, 0.5, made)
        page.tick()
        assert "Stars aligned on: 0; the telescope points by a model of 2 terms, 9 stars" in page.texts()

    on_paper(work)


def sample(gear: Any = (None, None), twist: Any = (None, None)) -> Sample:
    return Sample(10.0, (None, None), (None, None), (0.0, 0.0), (0.0, 0.0, 0.0, 0.0), gear, twist)


def test_motors_gears_and_encoders_of_maintenance() -> None:
    steps = round(100.0 / STEP_ARCSEC)

    async def work(page: Page) -> None:
        page.telescope.snapshot = snapshot(
            ra=axis(
                currents_a=(0.1234, 0.5), motor_turns_s=(1.5, None), steps=steps,
                auxiliary=Auxiliary(100.6, 0.9),
            ),
            dec=axis(currents_a=(0.25, 0.75), motor_turns_s=(-0.5, 0.25), steps=None),
            stale=frozenset({Device.AXIS_DEC, Device.MOTOR_RA_B}),
        )  # fmt: skip
        page.build(maintenance).tick()
        motors, encoders = page.tables()[:2]
        assert motors[1:] == [
            ["RA A", "0.123", "+1.5000"], ["RA B", "0.500", "– (stale)"],
            ["Dec A", "0.250 (stale)", "-0.5000"], ["Dec B", "0.750 (stale)", "+0.2500"],
        ]  # fmt: skip
        assert encoders[1][:4] == ["RA", "100.00", "100.60", "-0.60"] and "±" in encoders[1][4]
        assert encoders[2] == ["Dec", "–", "no board", "–", "– ± inf"] or encoders[2][:4] == [
            "Dec", "–", "no board", "–",
        ]  # fmt: skip
        page.live.samples = samples(sample(), sample((360.456, None), (None, -41.26)))
        page.tick()
        assert page.tables()[1][1:] == [["RA (stale)", "360.46", "–"], ["Dec (stale)", "–", "-41.3"]]

    on_paper(work)


def test_encoders_that_disagree_and_old_ones_are_marked() -> None:
    from host.auxiliary import BOARDS

    async def work(page: Page) -> None:
        far = axis(steps=round(100.0 / STEP_ARCSEC), auxiliary=Auxiliary(200.0, 0.9))
        old = frozenset({BOARDS["ra"], Device.POSITION_DEC})
        page.telescope.snapshot = snapshot(ra=far, dec=far, stale=old)
        page.build(maintenance).tick()
        ra, dec = page.tables()[1][1:]
        assert ra == ["RA", "100.00", "200.00 (stale)", "-100.00", "100.00 ± 0.58 (they disagree)"]
        assert dec == ["Dec", "100.00 (stale)", "200.00", "-100.00", "100.00 ± 0.58 (they disagree)"]

    on_paper(work)


class Runs:
    """Recorded runs in a folder, and a command that prints."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.recording, self.asked = folder, False, list[str]()
        self.found: list[Path] = []
        self.code = 0

    def logs(self, axis: str) -> list[Path]:
        return self.found

    def start(self) -> None:
        raise ValueError("no RS232 line")

    def stop(self) -> None:
        self.recording = False

    def command(self, axis: str, out: Path) -> list[str]:
        self.asked += [axis, out.name]
        return [sys.executable, "-S", "-c", f"print('<found>'); raise SystemExit({self.code})"]


@pytest.mark.parametrize("code", [0, 3])
def test_the_finder_is_asked_and_its_report_is_linked(tmp_path: Path, code: int) -> None:
    async def work(page: Page) -> None:
        runs = Runs(tmp_path)
        page.build(calibrate, runs).tick()
        assert "0 runs recorded" in page.texts()
        await page.press("Start a run")
        assert page.said == "no RS232 line" and "bad" in page.shell._said.classes
        await page.press("Calibrate on the recorded runs")
        assert page.said == "record a run first" and runs.asked == []
        runs.recording = True
        page.tick()
        assert "recording run 1" in page.texts()
        await page.press("End the run")
        runs.found, runs.code = [tmp_path / "a", tmp_path / "b"], code
        page.tick()
        assert "2 runs recorded" in page.texts()
        link = next(each for each in page.every(ui.link) if each.text == "Report")
        assert not link.visible
        page.labelled("Axis").value = "dec"
        await page.press("Calibrate on the recorded runs")
        said = page.labelled("What the finder says")
        assert "looking" in said.content
        for _ in range(500):
            if "looking" not in said.content:
                break
            await page.later()
        assert said.content == '<pre class="lines">&lt;found&gt;\n</pre>'
        assert runs.asked == ["dec", "report-dec-2"]
        assert link.visible == (code == 0)
        if link.visible:
            assert link.props["href"] == "/reports/report-dec-2/report.html"

    on_paper(work)


def test_what_a_program_prints_is_cut_to_its_end() -> None:
    import asyncio

    def asked(words: str) -> tuple[str, int]:
        return asyncio.run(run([sys.executable, "-S", "-c", words]))

    assert asked("import sys; sys.stderr.write('x' * 5000); raise SystemExit(7)") == ("x" * 4000, 7)
