"""Cables of a network without a gateway, headers of axis logs, and what a tick records, over stubs."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bus.can import Frame
from bus.protocol import COMMAND_BASE
from bus.time import EventQueue
from scenarios.lab import session
from scenarios.lab.networks import SERIAL
from scenarios.lab.session import Cables, Session, log_headers, plugged


def number(value: float) -> Any:
    return SimpleNamespace(si=value)


class Port:
    """A debug port; wrote: what it was told."""

    def __init__(self) -> None:
        self.wrote: list[tuple[int, bytes]] = []
        self.sink: Any = None

    def write(self, t_ns: int, data: bytes) -> None:
        self.wrote.append((t_ns, data))


def test_a_command_goes_to_its_own_board_and_one_for_nobody_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    one, other = Port(), Port()
    ports: Any = {0x11: one, 0x12: other}
    frames = [Frame(COMMAND_BASE + 0x12, b"\1"), Frame(COMMAND_BASE + 0x13, b"\2")]
    monkeypatch.setattr(session, "unpack_commands", lambda report: frames)
    Cables(ports).write(5, bytes(64))
    assert one.wrote == []
    assert other.wrote == [
        (5, f"t{COMMAND_BASE + 0x12:03X}101\r".encode())
    ]  # slcan: t, identifier, length, data


def test_lines_may_come_cut_anywhere_and_each_frame_is_a_report(monkeypatch: pytest.MonkeyPatch) -> None:
    port = Port()
    heard: list[tuple[int, Any]] = []
    link: Any = SimpleNamespace(receive=lambda t_ns, report: heard.append((t_ns, report)))
    monkeypatch.setattr(session, "slot", lambda frame: frame)
    monkeypatch.setattr(session, "pack_report", lambda slots: slots)
    ports: Any = {0x11: port}
    Cables(ports).plug(link, 3)
    assert port.wrote == [(3, b"O\r")]
    for t_ns, data in ((1, b"t2"), (2, b"11101\rt2"), (3, b"12102\r\rnoise\rt213103\r")):
        port.sink(t_ns, data)
    frames = [(2, 0x211, b"\1"), (3, 0x212, b"\2"), (3, 0x213, b"\3")]
    assert [(t_ns, slots[0].identifier, slots[0].data) for t_ns, slots in heard] == frames


@pytest.mark.parametrize(
    ("steps", "loops"),
    [
        ([], ("closed", "closed")),
        ([("open_loop", "ra")], ("open", "closed")),
        ([("open_loop", "ra"), ("set_rate", "ra")], ("closed", "closed")),
        ([("open_loop", "ra"), ("move", "dec")], ("open", "closed")),
        ([("open_loop", "dec"), ("goto", None)], ("closed", "closed")),
        ([("open_loop", "dec"), ("park", None)], ("closed", "closed")),
        ([("open_loop", "dec"), ("wait", None)], ("closed", "open")),
    ],
)
@pytest.mark.parametrize(("plant", "preload"), [("Low preload", "low"), ("HIGH", "high"), ("other", None)])
def test_a_header_says_whether_the_loop_is_open_and_the_preload(
    steps: list[tuple[str, str | None]], loops: tuple[str, str], plant: str, preload: str | None
) -> None:
    made = [
        SimpleNamespace(action=action, arguments={} if axis is None else {"axis": axis})
        for action, axis in steps
    ]
    scenario: Any = SimpleNamespace(
        clock=SimpleNamespace(iso=lambda t_s: f"iso {t_s:g}"), steps=made, name="night", seed=4,
        site=SimpleNamespace(temperature_c=-3.5),
    )  # fmt: skip
    controller, supply = SimpleNamespace(counter_split=number(0.125)), SimpleNamespace(voltage=number(24.0))
    model: Any = SimpleNamespace(name=plant, controller=controller, supply=supply)
    headers = log_headers(scenario, model)
    for axis, loop in zip(("ra", "dec"), loops, strict=True):
        known = {
            "axis": axis, "session": "night seed 4", "loop": loop, "start_utc": "iso 0",
            "counter_torque": "0.12",
            "supply_V": "24", "temperature_C": "-3.5", "note": f"schmidt, plant {plant}",
        }  # fmt: skip
        assert headers[axis] == known | ({} if preload is None else {"preload": preload})


class Desk:
    """A session without a network: only what a tick needs."""

    def __init__(self) -> None:
        self.done: list[str] = []
        self.traces: list[tuple[str, Any]] = []
        made: Any = object.__new__(Session)
        made.scenario = SimpleNamespace(mount="mount")
        made.client = SimpleNamespace(
            now_ns=0,
            tick=lambda t_ns: self.done.append("client"),
            position=lambda device: None,
            focus=lambda: None,
        )
        pointing = SimpleNamespace(errors_arcsec=lambda: None)
        made.programme = SimpleNamespace(tick=lambda t_ns: self.done.append("programme"), pointing=pointing)
        made.plant = SimpleNamespace(focus=SimpleNamespace(position=lambda t_ns: 4.0, encoder=lambda t_ns: 9))
        made.recorder = SimpleNamespace(
            ascii=SimpleNamespace(sensors=lambda t_ns, said: self.done.append(f"status {t_ns}")),
            host=SimpleNamespace(append=lambda rows: self.traces.append(("host", rows))),
            focus=SimpleNamespace(append=lambda rows: self.traces.append(("focus", rows))),
        )
        made.serial = [SimpleNamespace(watch=lambda t_ns: self.done.append("watch"))]
        made.ticked, made.rows, made._rows = None, [], []
        made._status_ns, made._next_status_ns = 100, 0
        queued: list[tuple[int, Any]] = []
        made.network = SimpleNamespace(queue=SimpleNamespace(at=lambda *each: queued.append(each)))
        self.queued, self.session = queued, made


def test_a_tick_works_and_asks_for_the_next_one_50_ms_later(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "readings", lambda client, mount: "read")
    desk = Desk()
    told: list[int] = []
    desk.session._tick(0)
    desk.session.ticked = told.append
    desk.session._tick(99)
    desk.session._tick(100)
    status = [each for each in desk.done if each.startswith("status")]
    assert status == ["status 0", "status 100"] and desk.done[:4] == [
        "programme",
        "client",
        "status 0",
        "watch",
    ]
    assert [t_ns for t_ns, _ in desk.queued] == [50_000_000, 50_000_099, 50_000_100]
    assert told == [99, 100] and desk.session.client.now_ns == 100


def test_what_a_host_has_not_heard_is_no_number() -> None:
    desk = Desk()
    desk.session._record(2_000_000_000)
    (row, focus), *_ = desk.session._rows
    assert row[0] == 2.0 and np.isnan(row[1:]).all() and len(row) == 6 and focus == (2.0, 4.0, 9.0)
    place = SimpleNamespace(position=7)
    desk.session.client.position, desk.session.client.focus = lambda device: place, lambda: place
    desk.session.programme.pointing.errors_arcsec = lambda: (0.5, -0.5)
    desk.session._record(3_000_000_000)
    assert desk.session._rows[1][0] == (3.0, 7, 7, 0.5, -0.5, 7)


def test_rows_go_to_their_traces_and_are_kept_while_somebody_records() -> None:
    desk = Desk()
    desk.session.flush_traces()
    assert desk.traces == []
    rows = [((1.0, 2.0), (3.0,)), ((4.0, 5.0), (6.0,))]
    desk.session.begin_traces(rows)
    assert [(name, each.tolist()) for name, each in desk.traces] == [
        ("host", [[1.0, 2.0], [4.0, 5.0]]), ("focus", [[3.0], [6.0]]),
    ]  # fmt: skip
    assert desk.session.rows == [] and desk.session._rows == []
    desk.session.ticked = lambda t_ns: None
    desk.session.begin_traces(rows)
    assert desk.session.rows == rows


def test_a_network_without_a_gateway_is_heard_by_its_debug_ports() -> None:
    started: list[str] = []
    port = Port()
    network: Any = SimpleNamespace(
        boards={"A": SimpleNamespace(device_type=0x11)}, debug={"A": port}, queue=SimpleNamespace(now_ns=8),
        voices={"A": SimpleNamespace(start_alone=lambda: started.append("A"))},
    )  # fmt: skip
    plugged(network)
    assert port.wrote == [(8, b"O\r")] and started == ["A"]
    hid = SimpleNamespace(write=lambda *_: None, to_host=None)
    network = SimpleNamespace(boards={"GATEWAY": None}, hid=hid)
    assert plugged(network).receive == hid.to_host


@pytest.mark.parametrize("chained", [False, True])
def test_a_session_is_host_and_network_on_one_queue(chained: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The safety chain is heard where there is one; status is logged from the beginning on."""
    heard: list[Any] = []
    queue = EventQueue()
    uarts = {device.name: SimpleNamespace(sink=None) for device in SERIAL}
    chain = SimpleNamespace(told=None) if chained else None
    network = SimpleNamespace(
        plant="plant", wire=SimpleNamespace(tap=heard.append), uarts=uarts, chain=chain, queue=queue,
        devices=(),
    )  # fmt: skip

    class Recorded:
        """Files that are not there."""

        can, ascii = SimpleNamespace(take="taken"), "ascii"

        def __init__(self, *_: Any) -> None: ...

        def link(self, device: Any) -> Any:
            return SimpleNamespace(device=device, receive=f"to {device.name}")

    parts = {
        "powered": network, "plugged": "link", "Client": SimpleNamespace(), "Eye": "eye",
        "Programme": SimpleNamespace(), "log_headers": {},
    }  # fmt: skip
    for name, part in parts.items():
        monkeypatch.setattr(session, name, lambda *_, part=part: part)
    monkeypatch.setattr(session, "Recorder", Recorded)
    faults = SimpleNamespace(schedule=heard.append)
    monkeypatch.setattr(session, "Faults", lambda network, seed: faults)
    scenario: Any = SimpleNamespace(seed=3, faults="faults", status_period_s=2.0)
    nothing: Any = None
    made: Any = Session(scenario, nothing, nothing)
    assert heard == ["taken", "faults"] and (made._status_ns, made._next_status_ns) == (2_000_000_000, 0)
    assert all(uart.sink == f"to {name}" for name, uart in uarts.items())
    assert chain is None or chain.told == made.chain_says
    ticks: list[int] = []
    assert made.ticked is None and made.rows == [] and queue.now_ns == 0
    made.work = ticks.append
    made.advance(99_000_000)
    assert ticks == [50_000_000]


def test_a_tick_leaves_a_row_which_an_advance_hands_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "readings", lambda client, mount: "read")
    desk = Desk()
    desk.session.work(1_000_000_000)
    assert len(desk.session._rows) == 1
    desk.session.network = SimpleNamespace(queue=EventQueue())
    desk.session.advance(5)
    assert [name for name, _ in desk.traces] == ["host", "focus"] and not desk.session._rows


def test_the_chain_is_told_in_the_error_log() -> None:
    desk, told = Desk(), list[Any]()
    desk.session.recorder.ascii.error = lambda *line: told.append(line)
    desk.session.chain_says(7, "button pressed")
    assert told == [(7, "CHAIN", "button pressed")]


def test_a_session_goes_on_with_another_network() -> None:
    desk, adopted = Desk(), list[Any]()
    desk.session.recorder.adopt = adopted.append
    desk.session.eye, desk.session.link = SimpleNamespace(), SimpleNamespace()
    other: Any = SimpleNamespace(plant="other", hid=SimpleNamespace(write="write"))
    desk.session.adopt(other)
    assert adopted == ["other"] and desk.session.plant == desk.session.eye.plant == "other"
    assert desk.session.network is other and desk.session.link._send == "write"
