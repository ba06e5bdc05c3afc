"""Whole runs of seconds: what they leave, determinism, faults, expectations."""

import dataclasses
import itertools
import json
from pathlib import Path
from typing import Any

import cantools
import pytest
import yaml

from bus.protocol import Device
from host.logs import traces
from scenarios.language.document import ScenarioError, parse
from scenarios.language.load import convert
from scenarios.language.model import check_targets
from scenarios.language.plants import plant_model
from scenarios.run import run as runner
from tests.scenarios.conftest import SHORT, Command

ROOT = Path(__file__).parents[3]


def go(text: str, folder: Path, **changes: Any) -> runner.Result:
    scenario = dataclasses.replace(convert(parse(text, folder / "test.yaml")), **changes)
    check_targets(scenario)
    return runner.run(scenario, plant_model(scenario.plant, folder), folder, lambda *_: None)


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> runner.Result:
    folder = tmp_path_factory.mktemp("quick")
    return go((ROOT / "scenarios/quick-look.yaml").read_text(), folder)


def test_quick_look_holds_all_its_expectations(quick: runner.Result) -> None:
    assert quick.passed, [verdict for verdict in quick.verdicts if not verdict.passed]


@pytest.mark.slow
def test_output_folder_has_everything(quick: runner.Result) -> None:
    names = {path.name for path in quick.folder.iterdir()}
    wanted = "summary.json can.log commands.log status.log sensors.log errors.log axis-ra.csv axis-dec.csv"
    wanted += " truth-ra.parquet truth-dec.parquet host.parquet focus.parquet report.html pointing.png"
    assert set(wanted.split()) <= names
    summary = json.loads((quick.folder / "summary.json").read_text())
    for field in (
        "trace_digest",
        "real_time_factor",
        "simulated_s",
        "bus_load",
        "expectations",
        "seed",
        "version",
    ):
        assert field in summary
    for row in summary["expectations"]:
        assert {"name", "passed", "value", "limit", "unit"} <= set(row)
    page = (quick.folder / "report.html").read_text()
    assert "data:image/png;base64," in page
    assert "http" not in page.replace("http-equiv", "")  # self-contained


def test_cantools_decodes_every_frame_of_the_run(quick: runner.Result) -> None:
    """The DBC is the protocol: no frame of a run is outside it, and byte 0 is the device type."""
    database: Any = cantools.database.load_file(ROOT / "bus/protocol/schmidt.dbc")
    seen: set[int] = set()
    for line in (quick.folder / "can.log").read_text().splitlines():
        identifier, data = line.split()[2].split("#")
        number, payload = int(identifier, 16), bytes.fromhex(data)
        assert payload[0] == number & 0x7F
        if number not in seen or number >= 0x700:
            database.decode_message(number, payload)
        seen.add(number)
    assert {0x200 + device for device in Device if device not in (Device.DISPLAY, Device.GATEWAY)} <= seen


def test_axis_log_rows_are_10_ms_apart_and_agree_with_the_truth(quick: runner.Result) -> None:
    lines = [line for line in (quick.folder / "axis-ra.csv").read_text().splitlines() if line[0] not in "#t"]
    times = [float(line.split(",")[0]) for line in lines]
    gaps = [b - a for a, b in itertools.pairwise(times)]
    assert min(gaps) == pytest.approx(0.01, abs=2e-4)  # stamps have a resolution of 100 µs
    assert max(gaps) == pytest.approx(0.01, abs=2e-4)
    truth = traces.read(quick.folder / "truth-ra.parquet", ("angle",), 0.0, 1e9)
    position = int(lines[-1].split(",")[3])
    reached = [angle / 6.283185307179586 * 2**29 for angle in truth["angle"]]
    assert min(reached) - 500 < position < max(reached) + 500


@pytest.mark.parametrize("change", ["folder", "speed", pytest.param("hash seed", marks=pytest.mark.slow)])
def test_one_seed_gives_one_digest(change: str, tmp_path: Path, schmidt_process: Command) -> None:
    first = go(SHORT, tmp_path / "a").summary["trace_digest"]
    if change == "hash seed":
        (tmp_path / "short.yaml").write_text(SHORT)
        done = schmidt_process("run", "short.yaml", "--out", "b", PYTHONHASHSEED="4711")
        assert done.returncode == 0, done.stderr
        second = json.loads((tmp_path / "b" / "summary.json").read_text())["trace_digest"]
    else:
        second = go(SHORT, tmp_path / "b" / "c", speed=20.0 if change == "speed" else None).summary[
            "trace_digest"
        ]
    assert first == second


def test_another_seed_gives_another_digest(tmp_path: Path) -> None:
    one = go(SHORT, tmp_path / "a").summary["trace_digest"]
    assert one != go(SHORT, tmp_path / "b", seed=2).summary["trace_digest"]


def test_a_target_below_the_horizon_is_refused_before_anything_is_built(tmp_path: Path) -> None:
    text = SHORT + "  - goto: {target: Antares}\n"
    with pytest.raises(ScenarioError, match=r"test\.yaml:7: Antares is at altitude .* below the horizon"):
        go(text, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_target_that_sets_during_the_track_is_refused(tmp_path: Path) -> None:
    text = SHORT + "  - goto: {target: Fomalhaut}\n  - track: {for: 2 h}\n"
    early = text.replace("2026-02-10T14:00", "2026-02-10T10:00")
    with pytest.raises(ScenarioError, match="Fomalhaut"):
        go(early, tmp_path / "run")


def eccentric(amplitude: str) -> str:
    """A plant with one effect, of an amplitude."""
    effect = f"{{name: gear_eccentricity, stage: axis, parameters: {{amplitude: {amplitude}}}}}"
    return f"{{file: low-preload-bridge, effects: [{effect}]}}"


def test_an_effect_is_bounded_in_the_unit_it_is_given_in() -> None:
    model = plant_model(yaml.safe_load(eccentric("{value: 500, unit: N mm}")), Path())
    assert model.axes.ra.effects[-1].parameters["amplitude"].si == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("plant", "words"),
    [
        ("low-preloat", "did you mean 'low_preload'"),
        ("{file: low-preload, effects: [torque_riple]}", "did you mean 'torque_ripple'"),
        ("{file: low-preload, effects: [gear_eccentricity]}", "gear_eccentricity.stage: missing"),
        (eccentric("{value: 300000, unit: N mm}"), "300000 N mm is outside 0 to 200 N m"),
        (eccentric("{value: 500, unit: N}"), "'N' does not fit"),
        ("{file: low-preload, overrides: {axes.ra.inertea: 3}}", "axes.ra.inertea"),
        ("none.yaml", "no such file"),
    ],
)
def test_a_wrong_plant_is_named(plant: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=words):
        go(SHORT + f"plant: {plant}\n", tmp_path)


def test_a_board_without_supply_is_silent_and_comes_back(tmp_path: Path) -> None:
    text = (
        SHORT.replace("for: 1 s", "for: 8 s")
        + "faults:\n  - node_off: {node: DISPLAY}\n    at: 1 s\n    until: 6 s\n"
    )
    go(text, tmp_path)
    beats = [
        float(line.split(")")[0][1:])
        for line in (tmp_path / "can.log").read_text().splitlines()
        if " 751#" in line
    ]
    assert not [t for t in beats if 1.0 < t < 6.0]
    assert [t for t in beats if t > 6.0]
    assert "DISPLAY" in (tmp_path / "errors.log").read_text()
    assert "is back" in (tmp_path / "status.log").read_text()


def test_a_missing_axis_board_fails_the_health_check(tmp_path: Path) -> None:
    result = go(SHORT + "faults:\n  - node_off: {node: AXIS_DEC}\n", tmp_path)
    assert not result.passed
    assert "AXIS_DEC: PING: no answer after 3 tries" in result.verdicts[0].reason


def test_a_stuck_sensor_shows_one_value(tmp_path: Path) -> None:
    text = (
        SHORT.replace("for: 1 s", "for: 2 s")
        + "faults:\n  - sensor_stuck: {sensor: ra.tachometer_a}\n    at: 1 s\n"
    )
    go(text, tmp_path)
    rows = [
        line.split(",") for line in (tmp_path / "axis-ra.csv").read_text().splitlines() if line[0] not in "#t"
    ]
    assert {row[7] for row in rows[-100:]} == {"0"}
    assert {row[8] for row in rows[-100:]} != {"0"}


def test_lost_frames_leave_a_stale_position_behind(tmp_path: Path) -> None:
    """Without POSITION frames (identifier 0x221) the RA axis board is not healthy, and is not switched on."""
    result = go(SHORT + "faults:\n  - frame_loss: {identifier: 0x221}\n", tmp_path)
    assert not result.passed
    assert "AXIS_RA reports" in result.verdicts[0].reason
    assert "stale" in result.verdicts[0].reason


def test_disturbed_bits_become_error_frames(tmp_path: Path) -> None:
    result = go(SHORT + "faults:\n  - bit_errors: {probability: 5 %}\n    at: 1 s\n", tmp_path)
    assert result.summary["frame_errors"] > 10


def test_expectations_fail_with_their_value(tmp_path: Path) -> None:
    text = SHORT + "expect:\n  - bus_load: {at_most: 1 %}\n  - overruns: {at_most: 0}\n"
    result = go(text, tmp_path)
    assert [verdict.passed for verdict in result.verdicts] == [True, False, True]
    assert result.verdicts[1].value == pytest.approx(result.summary["bus_load"])
    assert 0.05 < result.summary["bus_load"] < 0.2  # 8 nodes at 100 Hz are 10.8 % (hardware.md 3.3)


def test_log_effects_reach_the_axis_log(tmp_path: Path) -> None:
    effect = "{name: sample_loss, axis: ra, parameters: {packet_loss: 0.5}}"
    plant = f"plant: {{file: low-preload-bridge, effects: [{effect}]}}\n"
    go(plant + SHORT.replace("for: 1 s", "for: 9 s"), tmp_path)
    texts = [(tmp_path / f"axis-{axis}.csv").read_text().splitlines() for axis in ("ra", "dec")]
    ra, dec = (sum(line[0] not in "#t" for line in lines) for lines in texts)
    assert 0.2 < ra / dec < 0.8
    assert ra % 25 == 0


def test_steps_beside_the_line_and_conditions(tmp_path: Path) -> None:
    """`after` runs beside the line, `at` and `delay` wait, `when` looks at the boards."""
    text = """\
name: order
start_utc: 2026-02-10T14:00:00Z
steps:
  - {name: up, power_on: {}}
  - {name: long, wait: {for: 2 s}}
  - {name: beside, after: up, delay: 500 ms, focus: {by: 1 half step}}
  - {name: late, at: 4 s, wait: {for: 100 ms}}
  - {name: at rest, when: stopped, wait: {for: 50 ms}}
"""
    steps = {step["name"]: step for step in go(text, tmp_path).summary["steps"]}
    assert steps["beside"]["start_s"] == pytest.approx(steps["up"]["end_s"] + 0.5, abs=0.11)
    assert steps["beside"]["end_s"] < steps["long"]["end_s"]
    assert steps["late"]["start_s"] == pytest.approx(4.0, abs=0.051)
    assert steps["at rest"]["start_s"] >= steps["late"]["end_s"]


def test_a_step_that_takes_too_long_fails_and_the_axes_are_stopped(tmp_path: Path) -> None:
    text = SHORT.replace("for: 1 s}", "for: 60 s}\n    timeout: 2 s") + "  - wait: {for: 1 s}\n"
    result = go(text, tmp_path)
    assert "go: not done within 2 s" in result.verdicts[0].reason
    assert "AXIS_RA  STOP  ok" in (tmp_path / "commands.log").read_text()
    assert result.summary["simulated_s"] < 6


def test_a_timeout_ends_the_wait_for_a_condition(tmp_path: Path) -> None:
    text = SHORT + "  - {name: never, wait: {for: 1 s}, when: on_target, timeout: 2 s}\n"
    result = go("time_limit: 20 s\n" + text, tmp_path)
    assert "never: not on_target within 2 s" in result.verdicts[0].reason
    assert result.summary["simulated_s"] < 8


def test_the_time_limit_ends_a_run(tmp_path: Path) -> None:
    result = go("time_limit: 2 s\n" + SHORT.replace("for: 1 s", "for: 60 s"), tmp_path)
    assert "time limit" in result.verdicts[0].reason
    assert result.summary["simulated_s"] == pytest.approx(2.0)


def test_a_fault_that_never_acted_fails_the_run_unless_it_may(tmp_path: Path) -> None:
    """Nobody sends the identifier that would be lost; the noise meets every reading."""
    faults = SHORT + "faults:\n  - sensor_bias: {sensor: focus.lvdt, offset: 0.01}\n    at: 0.5 s\n"
    faults += "  - frame_loss: {identifier: 0x7FF}\n"
    failed = go(faults, tmp_path / "a")
    missed = [verdict for verdict in failed.verdicts if not verdict.passed]
    assert [verdict.name for verdict in missed] == ["fault frame_loss from 0 s on acted"]
    assert "test.yaml:10: it met nothing; may_not_act: true" in missed[0].reason
    summary = json.loads((tmp_path / "a" / "summary.json").read_text())
    acted, silent = summary["faults"]
    assert (summary["silent_faults"], silent["first_s"], silent["on"]) == (1, None, "")
    assert (acted["name"], acted["at_s"], acted["on"]) == ("sensor_bias", 0.5, "sample of focus.lvdt")
    assert 0.5 <= acted["first_s"] < 0.6
    page = (tmp_path / "a" / "report.html").read_text()
    assert "sample of focus.lvdt" in page and "never" in page
    assert go(faults + "    may_not_act: true\n", tmp_path / "b").passed


def test_a_fault_after_the_end_never_acted(tmp_path: Path) -> None:
    late = SHORT + "faults:\n  - node_off: {node: DISPLAY}\n    at: 1 h\n"
    assert go(late, tmp_path).verdicts[1].name == "fault node_off from 3600 s on acted"
