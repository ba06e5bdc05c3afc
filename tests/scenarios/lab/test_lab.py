"""`schmidt.Lab`: boards, bus, pins, truth and faults from Python."""

from pathlib import Path
from typing import Any

import can
import matplotlib
import numpy as np
import pytest

import schmidt
from bus.protocol import COMMAND_BASE, Device, Opcode, Result, pack_command
from scenarios.lab.networks import FINAL
from tests.scenarios.conftest import SHORT


def pulling(**options: Any) -> schmidt.Lab:
    lab = schmidt.Lab(**options).run("0.1 s")
    assert lab.ask("AXIS_RA", "POWER", 1).result == lab.ask("AXIS_RA", "OPEN_LOOP", 1500).result == Result.OK
    return lab


def test_time_goes_on_when_one_says_and_only_then() -> None:
    with schmidt.Lab() as lab:
        assert lab.now_s == 0.0 and len(lab.frames()) == 0
        assert lab.run("5 ms").run(0.005).now_s == pytest.approx(0.010)
        before = lab.now_s
        lab.pin("ra.absolute"), lab.frames(), lab.truth("ra")
        assert lab.now_s == before


def test_what_the_board_says_what_it_reads_and_the_truth_agree() -> None:
    lab = pulling(seed=1).run("0.5 s")
    truth, heard = lab.truth("ra"), lab.signals("POSITION_RA_POSITION")
    assert np.diff(truth["t_s"]) == pytest.approx(0.01)
    assert truth["t_s"][-1] == pytest.approx(lab.now_s, abs=0.011)
    steps = np.interp(heard["t_s"], truth["t_s"], np.unwrap(truth["angle"])) * 2**29 / (2 * np.pi)
    moved = truth["rate"].max() * 2**29 / (2 * np.pi)  # steps a second
    assert np.ptp(heard["Position"]) > 0.05 * moved
    assert (
        np.abs((heard["Position"] - steps)[heard["t_s"] > 0.02]).max() < 0.006 * moved
    )  # a frame is 5 ms old
    last = heard["Position"][-1]
    assert last <= lab.pin("ra.absolute") <= last + 0.01 * moved
    assert lab.pin("ra.current_a") > 1.0 > lab.pin("dec.current_a")


def test_frames_are_those_of_the_wire() -> None:
    lab = schmidt.Lab().run("0.3 s")
    frames, own = lab.frames(), lab.frames("FOCUS")
    assert len(frames) == lab.network.wire.frames
    assert set(own["sender"]) == {"FOCUS"} and set(own["identifier"]) <= {0x200 + Device.FOCUS, 0x741}
    assert (np.diff(frames["t_s"]) > 0).all()
    assert all(int(row["data"][:2], 16) == row["identifier"] & 0x7F for row in frames)


def test_a_signal_that_a_frame_does_not_have_is_nan() -> None:
    lab = schmidt.Lab().run("0.1 s")
    lab.ask("AXIS_RA", "GET_PARAMETER", 1)
    (row,) = lab.signals("AXIS_RA_COMMAND")
    assert row["GetParameter_Number"] == 1 and np.isnan(row["Power_On"])


def test_a_python_can_bus_is_on_the_wire() -> None:
    with schmidt.Lab() as lab:
        ping = pack_command(Device.FOCUS, Opcode.PING)
        identifier = COMMAND_BASE + Device.FOCUS
        lab.bus.send(can.Message(arbitration_id=identifier, data=ping, is_extended_id=False))
        lab.run("10 ms")
        heard = []
        while (message := lab.bus.recv(0)) is not None:
            heard.append(message.arbitration_id)
        assert 0x100 + Device.FOCUS in heard
        lab.bus.shutdown()


def test_two_labs_stand_beside_each_other() -> None:
    alone = pulling(seed=3).run("0.2 s").frames()
    one, two, other = (schmidt.Lab(seed=seed) for seed in (3, 3, 4))
    for lab in (one, other, two):
        lab.run("0.1 s")
    for command in (("POWER", 1), ("OPEN_LOOP", 1500)):
        for lab in (two, one, other):
            lab.ask("AXIS_RA", *command)
    for lab in (one, two, other):
        lab.run("0.2 s")
    assert np.array_equal(one.frames(), alone) and np.array_equal(two.frames(), alone)
    assert not np.array_equal(other.frames(), alone)


def test_a_scenario_and_a_network_by_name(tmp_path: Path) -> None:
    assert set(schmidt.Lab("final").boards) == {device.name for device in FINAL}
    (tmp_path / "a.yaml").write_text(SHORT + "faults:\n  - node_off: {node: DISPLAY}\n    at: 20 ms\n")
    lab = schmidt.Lab(tmp_path / "a.yaml", seed=5).run("50 ms")
    (fault,) = lab.faults.evidence
    assert (fault.first_ns, fault.on) == (20_000_000, "supply of DISPLAY")
    with pytest.raises(ValueError, match="DISPLAY does not answer PING"):
        lab.ask("DISPLAY", "PING")


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda lab: lab.ask("AXIS_R", "PING"), "no board 'AXIS_R'"),
        (lambda lab: lab.ask("AXIS_RA", "PINK"), "AXIS_RA: no command 'PINK'; use one of PING"),
        (lambda lab: lab.pin("ra.speed"), r"no sensor 'ra\.speed'; use one of ra\.incremental"),
        (lambda lab: lab.signals("AXIS"), "no message 'AXIS'; use one of AXIS_RA_COMMAND"),
        (lambda lab: lab.run("2"), "no unit"),
        (lambda _lab: schmidt.Lab("labor"), "labor"),
        (lambda _lab: schmidt.Lab(plant="no_preload"), "no_preload"),
    ],
)
def test_what_is_not_there_is_one_line(call: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=reason) as caught:
        call(schmidt.Lab())
    assert "\n" not in str(caught.value)


def test_a_plot_in_a_line(tmp_path: Path) -> None:
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure = schmidt.Lab().run("0.2 s").plot("dec.rate", "AXIS_RA_MOTION.AdcA")
    figure.savefig(tmp_path / "a.png")
    assert [axes.get_ylabel() for axes in figure.axes] == ["dec.rate", "AXIS_RA_MOTION.AdcA"]
    assert [len(axes.lines[0].get_xdata()) for axes in figure.axes] == [20, 20]
    pyplot.close(figure)


def test_the_name_holds_the_lab_and_its_stepped_sister() -> None:
    from scenarios.doors.stepped import Stepped

    assert schmidt.Stepped is Stepped and set(schmidt.__all__) == {"Lab", "Stepped"}
    with pytest.raises(AttributeError, match="no attribute 'Lap'"):
        schmidt.Lap  # noqa: B018
