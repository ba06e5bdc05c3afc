"""docs/guides/new-board.md does what it says: three files each, counted lines, and conformance passes."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from bus.can import Frame
from bus.conformance import Settings, run
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import pack_command
from bus.protocol.nodes import arguments_of, documented
from scenarios.lab.network import Network
from scenarios.lab.networks import config_from, devices_of
from scenarios.lab.prepare import chosen, load
from scenarios.lab.snapshot.freeze import restore, take
from scenarios.lab.wiring import wire
from scenarios.language.document import ScenarioError
from scenarios.native import compiled

PAGE = Path(__file__).parents[2] / "docs" / "guides" / "new-board.md"
SUFFIX = {"dbc": ".dbc", "python": ".py", "yaml": ".yaml"}
BOARDS = {"mirror": 60, "cover": 60}
"""The page's examples in its order, and the most lines that each may have."""


def examples() -> dict[str, str]:
    """The page's files by their names."""
    blocks = re.findall(r"```(\w+)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    files = [(name, language) for name in BOARDS for language in SUFFIX]
    assert [language for language, _ in blocks] == [language for _, language in files]
    return {
        f"{name}{SUFFIX[language]}": text for (name, language), (_, text) in zip(files, blocks, strict=True)
    }


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in examples().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("name", BOARDS)
def test_B8_three_files_and_so_many_lines(folder: Path, name: str) -> None:
    files = list(folder.glob(f"{name}.*"))
    lines = [line for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    assert len(files) == 3
    assert sum(bool(line.strip()) for line in lines) <= BOARDS[name]


def test_B8_the_new_board_passes_conformance(folder: Path) -> None:
    scenario, model = chosen(folder / "mirror.yaml")
    devices = devices_of(config_from(scenario.network, {}, folder))
    assert [device.name for device in devices][-1] == "MIRROR"
    made = wire(scenario, model)
    with SchmidtBus(made.wire) as bus:
        results = run(bus, devices=devices[-1:], settings=Settings(motion=True, period_tolerance=0.002))
    assert [result for result in results if not result.passed] == []
    said = {(result.check, result.subject) for result in results}
    for expected in (
        ("period", "MIRROR_CELL"), ("period", "MIRROR_HEARTBEAT"), ("command", "MIRROR HEAT 100"),
        ("out of range", "MIRROR HEAT 101"), ("out of range", "MIRROR SET_PARAMETER 1 6001"),
    ):  # fmt: skip
        assert expected in said
    seen = []
    made.wire.tap(lambda _t, frame, sender: seen.append(frame) if sender == "MIRROR" else None)
    made.run_until(made.queue.now_ns + 2_000_000_000)
    frame = next(frame for frame in seen if frame.identifier == 0x276)
    decoded = documented(devices).decode_message(frame.identifier, frame.data)
    assert decoded == {"Device": "MIRROR", "Dew": 0, "Temperature": 8.5, "Heater": 100}


def test_the_new_board_has_a_data_sheet(folder: Path) -> None:
    from canopen import import_od

    from boards.canopen.dictionary import NO_REMOTE
    from scenarios.commands.describing import write_eds

    sheets = {file.stem: file for file in write_eds(folder / "sheets", folder / "mirror.yaml")}
    assert {"axis", "mirror"} <= set(sheets)
    sheet = import_od(str(sheets["mirror"]))
    assert [sheet["Identity object"][sub].default for sub in (2, 4)] == [0x76, 0x76]
    row = sheet[0x2101]
    assert (row.name, row.min, row.max, row.default) == ("dew_point_centidegrees", -4000, 6000, 500)
    assert sheet[0x1801][1].default == 0x276 | NO_REMOTE  # the measurement frame


def covered(folder: Path) -> tuple[Network, list[bytes]]:
    """The network with the cover, and a list that its STATE frames come into."""
    made = wire(*chosen(folder / "cover.yaml"))
    return made, states(made)


def states(network: Network) -> list[bytes]:
    heard: list[bytes] = []
    network.wire.tap(lambda _t, frame, _who: heard.append(frame.data) if frame.identifier == 0x277 else None)
    return heard


def tell(network: Network, opcode: str, *arguments: int) -> None:
    device = network.devices[-1]
    number = next(each for each in arguments_of(device.declared) if each.name == opcode)
    port = next((each for each in network.wire.ports if each.name == "pc"), None) or network.wire.attach("pc")
    port.send(Frame(0x080 + device, pack_command(device, number, *arguments)), network.queue.now_ns)


def go_on(network: Network, seconds: float) -> None:
    network.run_until(network.queue.now_ns + round(seconds * 1e9))


OPENED, CLOSED, MOVING = 1, 2, 4


def test_P13_the_cover_opens_meets_its_switch_and_stops(folder: Path) -> None:
    network, heard = covered(folder)
    go_on(network, 0.25)
    assert heard[-1][1] == CLOSED
    tell(network, "COVER_OPEN", 1)
    go_on(network, 11.5)
    assert heard[-1][1] == MOVING
    go_on(network, 1.0)
    assert heard[-1][1] == OPENED
    tell(network, "COVER_OPEN", 0)
    go_on(network, 5.0)
    network.board("COVER").power_off(network.queue.now_ns)
    go_on(network, 10.0)
    network.board("COVER").power_on(network.queue.now_ns)
    go_on(network, 1.0)
    assert heard[-1][1] == 0, "without supply it has stopped half way"


def test_B8_the_cover_passes_conformance_in_motion_and_is_stopped(folder: Path) -> None:
    network, heard = covered(folder)
    with SchmidtBus(network.wire) as bus:
        settings = Settings(motion=True, period_tolerance=0.002)
        results = run(bus, devices=network.devices[-1:], settings=settings)
    assert [result for result in results if not result.passed] == []
    assert {("command", "COVER COVER_OPEN 1"), ("out of range", "COVER COVER_OPEN 2")} <= {
        (result.check, result.subject) for result in results
    }
    assert any(data[1] & MOVING for data in heard) and not heard[-1][1] & MOVING


@pytest.mark.skipif(compiled(), reason="snapshots are taken of the plain source")
def test_a_snapshot_holds_the_cover_where_it_is(folder: Path) -> None:
    network, heard = covered(folder)
    tell(network, "COVER_OPEN", 1)
    go_on(network, 6.0)
    assert heard[-1][1] == MOVING
    network.wire._taps.clear()
    again = restore(take(network))
    assert again is not network
    both = [states(each) for each in (network, again)]
    for each in (network, again):
        go_on(each, 8.0)
    assert both[0] == both[1] and both[0][0][1] == MOVING and both[0][-1][1] == OPENED


@pytest.mark.slow
@pytest.mark.skipif(compiled(), reason="snapshots are taken of the plain source")
def test_the_snapshot_of_the_page(folder: Path) -> None:
    """In a process that has never seen the board's file."""

    def schmidt(*words: object) -> None:
        main = "from scenarios.cli import main; main()"
        call = [sys.executable, "-c", main, *map(str, words), "--no-report"]
        done = subprocess.run(call, capture_output=True, text=True, cwd=PAGE.parents[1])
        assert done.returncode == 0, done.stderr

    whole, on = folder / "whole", folder / "on"
    schmidt("run", folder / "cover.yaml", "--out", whole, "--snapshot-at", "1")
    schmidt("run", "--from", whole / "snapshot", "--out", on)
    assert (on / "can.log").read_bytes() == (whole / "can.log").read_bytes()


@pytest.mark.parametrize(
    ("was", "now", "complaint"),
    [
        (
            '"COVER", {',
            '"MIRROR_COVER", {',
            "board kind 'MIRROR_COVER': a name is capitals",
        ),
        ('"COVER": 0x77', '"LID": 0x77', "board LID: boards of kind COVER are called COVER or COVER_…"),
        ("0x77", "0x71", "board COVER: name or device type 0x71 is taken"),
        ("def cover_stop", "def stop", "CoverBoard has no method cover_stop, as its opcode is called"),
        ("    PART = Cover\n", "", "board COVER: pin motor: there is no part.drive to wire it to"),
        ("512 STATE", "512 COVER_STATE", "frame COVER_STATE: a frame's name has no underscore"),
    ],
)
def test_what_breaks_a_rule_of_the_page_is_one_line(folder: Path, was: str, now: str, complaint: str) -> None:
    for file in (folder / "cover.py", folder / "cover.dbc"):
        file.write_text(file.read_text(encoding="utf-8").replace(was, now), encoding="utf-8")
    with pytest.raises(ValueError, match=re.escape(complaint)) as error:
        load(folder / "cover.yaml")
        covered(folder)
    assert "\n" not in str(error.value)
    if "part.drive" not in complaint:
        assert isinstance(error.value, ScenarioError) and "cover.yaml:4" in str(error.value)


@pytest.mark.slow
def test_the_command_of_the_page(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from scenarios.commands.checking import command

    out = folder / "found.json"
    assert command(None, out, scenario_file=folder / "mirror.yaml") == 0
    assert json.loads(out.read_text())["passed"]
