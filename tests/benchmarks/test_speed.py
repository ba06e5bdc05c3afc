"""The bench: its yardstick does the network's work, and its history tells a fall from noise."""

from pathlib import Path

import numpy as np
import pytest

from plant.model import load
from plant.plant import Plant
from tests.benchmarks import checkouts, dither, history, named, network, night, serving, show
from tests.benchmarks.bare import BareLoop


def test_the_bare_loop_has_the_networks_ticks_and_frames() -> None:
    """Frames and timer ticks a second of the lab network by its periods (docs/reference/protocol.md)."""
    bare = BareLoop(Plant(load(), 1))
    bare.advance(1_000_000_000)
    frames, ticks = bare.frames, bare.ticks
    bare.advance(3_000_000_000)
    # 2 positions at 5 ms, 2 axes and 4 motors at 10 ms, focus at 50 ms, 4 summaries at 250 ms, 11 heartbeats
    assert (bare.frames - frames) / 2 == 2 * 200 + 6 * 100 + 20 + 4 * 4 + 11
    # both encoders of each axis at 5 ms, telemetry and motors at 10 ms, focus, summaries, heartbeats
    assert (bare.ticks - ticks) / 2 == 4 * 200 + 6 * 100 + 20 + 4 + 1


def test_the_bare_loop_moves_the_plant() -> None:
    plant = Plant(load(), 1)
    BareLoop(plant).advance(500_000_000)
    assert 500_000_000 - plant.now_ns <= 5_000_000
    assert plant.world.any()


def test_a_fall_beyond_the_noise_is_said_and_noise_is_not(tmp_path: Path) -> None:
    path = tmp_path / "history.jsonl"
    for value in (100.0, 104.0, 97.0, 101.0):
        history.add(path, {"speed": value, "steady": 1.0}, {})
    before = history.read(path)
    assert len(before) == 4
    assert history.falls(before, {"speed": 95.0, "steady": 0.98}) == []
    (line,) = history.falls(before, {"speed": 80.0, "steady": 1.2})
    assert line.startswith("speed fell from 100")
    assert history.falls(before[:2], {"speed": 1.0}) == []


def test_a_cost_that_rises_is_said_and_one_that_falls_is_not(tmp_path: Path) -> None:
    before = [{"memory": 130.0 + k, "speed": 1.0} for k in range(4)]
    assert history.falls(before, {"memory": 90.0, "speed": 1.0}, {"memory"}) == []
    (line,) = history.falls(before, {"memory": 180.0, "speed": 1.0}, {"memory"})
    assert line.startswith("memory rose from 13")


def test_benches_of_another_machine_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "history.jsonl"
    history.add(path, {"speed": 1.0}, {})
    path.write_text(path.read_text().replace(history.machine(), "another"))
    assert history.read(path) == []


def test_memory_that_grows_after_the_start_is_told_from_memory_that_does_not() -> None:
    filled = [60.0 + min(k, 20) for k in range(200)]  # buffers that fill in the first tenth
    assert night.growth(filled) == 0.0
    leak = [80.0 + 0.1 * k for k in range(200)]
    assert night.growth(leak) == pytest.approx(20.0)  # over the whole of it
    assert night.growth([80.0]) != night.growth([80.0])  # too short to tell


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_night_that_is_run_tells_its_own_memory_and_not_that_of_who_asks() -> None:
    held = np.ones(64 << 20)
    found = night.measure(0.02, quiet=True)
    # what is held here would be on top: by itself a night takes 130 MiB, and 309 on a fresh clone, where it
    # compiles the kernels on the way
    assert 40.0 < found["peak_MiB"] < held.nbytes / 2**20
    assert found["cpu_s"] > 0.0 and found["logs_MB"] > 0.0


def test_sizes_of_networks_are_measured_in_turn() -> None:
    found = network.nodes((11, 22), 1, 2)
    assert [row["nodes"] for row in found] == [11, 22]
    assert found[0]["of_first"] == 1.0
    assert all(row["ms_per_node_and_s"] > 0.0 for row in found)


def test_the_table_has_a_row_for_everything_that_is_asked() -> None:
    middle = {"median": 1.0, "noise": 0.1, "least": 0.9}
    way = {"night": {**middle, "median": 8.0}, "plant": middle, "frames_per_s": 1048.0,
           "bare over night": middle, "python-can over night": middle}  # fmt: skip
    start = {"first_run_s": 1.0, "later_run_s": 0.5, "short_run_with_report_s": 1.2}
    figures = {
        "turns": {"plain": way, "compiled": way, "plain over compiled night": middle},
        "instructions": {"plain": 160.0, "compiled": 44.0},
        "nodes": [{"nodes": n, "ms_per_node_and_s": 0.3, "of_first": 1.0, "of_first_noise": 0.1}
                  for n in (11, 64)],
        "long night": {"hours": 10.0, "peak_MiB": 131.0, "MiB_per_hour": 0.2, "cpu_s": 263.0},
        "startup": start | {"version_s": 0.1}
        | {name.replace("_s", "_cpu_s"): value for name, value in start.items()},
        "networks": {}, "served": {}, "stepped": {"plain": {"times_real_time": 42.0}},
    }  # fmt: skip
    rows = show.rows(figures)
    asked = {what.strip(): limit for what, _, limit in rows if limit}
    assert asked["times real time by CPU"] == "≥ 130, aim 300"
    assert asked["a night of 10 hours, run once, compiled: peak memory"] == "≤ 250, aim 120"
    assert asked["over that of 11, in turn"] == "flat"
    others = {"bare loop over it", "python-can over it", "first command until it simulates"}
    assert set(asked) >= others | {"later command until it simulates", "a whole short run with its report"}
    assert show.costs(figures)["million instructions, compiled"] == 44.0
    assert set(show.costs(figures)).isdisjoint(show.headline(figures))


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_the_ticks_of_a_served_network_are_measured_beside_a_loop_that_only_sleeps() -> None:
    found = serving.punctuality(2, native=False)
    assert {"a loop that only sleeps", "plain"} <= set(found)
    for each in found.values():
        assert 0.0 <= each["on_time"] <= 1.0
        assert each["late_999_ms"] <= each["worst_ms"] + 1e-9
        assert each["ticks"] > 0
    rows = show._served(found)
    assert rows[0][2] == "" and rows[2][2] == "≥ 99.9 %"
    assert not any("inf" in text or "nan" in text for row in rows for text in row)


def test_B8_the_factor_of_every_named_network_is_printed() -> None:
    found = named.measure(1, rounds=1)
    assert [each["boards"] for each in found.values()] == [11, 5, 18]
    assert found["lab"]["of_lab"] == 1.0
    assert all(each["factor"] > 0 for each in found.values())
    assert [line[0].split(",")[0] for line in named.lines(found)] == [
        "network lab", "network serial", "network final",
    ]  # fmt: skip


def test_ratios_are_taken_turn_by_turn() -> None:
    """A machine that slows down tenfold meanwhile does not change a ratio of 1.03."""
    slower = [10.0 * 1.1**k for k in range(24)]
    middle, error = dither.ratio([1.03 * each for each in slower], slower)
    assert middle == pytest.approx(1.03)
    assert error < 1e-12
    shaken = [each * (1.13 if k % 2 else 0.93) for k, each in enumerate(slower)]
    middle, error = dither.ratio(shaken, slower)
    assert middle == pytest.approx(1.03)
    assert error > 0.02


@pytest.mark.slow
def test_a_turn_runs_the_paper_s_and_the_proposed_firmware() -> None:
    found = dither.measure(1, None)
    assert set(found) == {"off", "spread", "fine"}
    assert all(len(turns) == 1 and turns[0] > 0.0 for turns in found.values())


@pytest.mark.slow
def test_two_checkouts_are_timed_in_turn_and_do_the_same_work() -> None:
    roots = {"before": checkouts.ROOT, "now": checkouts.ROOT}
    told: list[str] = []
    look = {"a look": ["run", "scenarios/quick-look.yaml", "--no-report"]}
    found = checkouts.measure(roots, look, 1, True, told.append)
    assert {which: len(each) for which, each in found["a look"].items()} == {"before": 1, "now": 1}
    digests = {line.split(" s ")[1] for line in told}
    assert len(told) == 4 and len(digests) == 1 and len(digests.pop()) == 16


def test_a_command_that_ends_badly_is_said_in_one_line() -> None:
    with pytest.raises(checkouts.CommandFailed, match="no-such"):
        checkouts.run(checkouts.ROOT, ["run", "no-such.yaml"], True)
