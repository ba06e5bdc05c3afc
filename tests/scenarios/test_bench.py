"""The bench: its yardstick does the network's work, and its history tells a fall from noise."""

from pathlib import Path

import pytest

from plant.model import load
from plant.plant import Plant
from scenarios.bench import dither, history, named, serving, show
from scenarios.bench.bare import BareLoop


def test_the_bare_loop_has_the_networks_ticks_and_frames() -> None:
    """Frames and timer ticks a second of the lab network by its periods (ARCHITECTURE.md, the protocol)."""
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


def test_benches_of_another_machine_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "history.jsonl"
    history.add(path, {"speed": 1.0}, {})
    path.write_text(path.read_text().replace(history.machine(), "another"))
    assert history.read(path) == []


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
