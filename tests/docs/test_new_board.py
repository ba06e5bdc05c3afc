"""docs/new-board.md does what it says: three files, sixty lines, and conformance passes."""

import json
import re
from pathlib import Path

import pytest

from bus.conformance import Settings, run
from bus.protocol.nodes import documented
from bus.pythoncan import SchmidtBus
from scenarios.networks import config_from, devices_of
from scenarios.served import chosen, wire

PAGE = Path(__file__).parents[2] / "docs" / "new-board.md"
NAMES = {"dbc": "mirror.dbc", "python": "mirror.py", "yaml": "mirror.yaml"}


@pytest.fixture
def folder(tmp_path: Path, forget_boards: None) -> Path:
    blocks = re.findall(r"```(\w+)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert [language for language, _ in blocks] == list(NAMES)
    for language, text in blocks:
        (tmp_path / NAMES[language]).write_text(text, encoding="utf-8")
    return tmp_path


def test_B8_three_files_and_sixty_lines(folder: Path) -> None:
    files = list(folder.iterdir())
    lines = [line for file in files for line in file.read_text(encoding="utf-8").splitlines()]
    assert len(files) == 3
    assert sum(bool(line.strip()) for line in lines) <= 60


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

    from scenarios.canopen import write_eds

    sheets = {file.stem: file for file in write_eds(folder / "sheets", folder / "mirror.yaml")}
    assert {"axis", "mirror"} <= set(sheets)
    sheet = import_od(str(sheets["mirror"]))
    assert [sheet["Identity object"][sub].default for sub in (2, 4)] == [0x76, 0x76]
    row = sheet[0x2101]
    assert (row.name, row.min, row.max, row.default) == ("dew_point_centidegrees", -4000, 6000, 500)
    assert sheet[0x1801][1].default == 0x276  # the measurement frame


@pytest.mark.slow
def test_the_command_of_the_page(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from scenarios.conformance import command

    out = folder / "found.json"
    assert command(None, out, scenario_file=folder / "mirror.yaml") == 0
    assert json.loads(out.read_text())["passed"]
