"""Links by task (H1), and the host program by itself on a served network's cables."""

import threading
from collections.abc import Callable, Iterator
from io import StringIO
from pathlib import Path
from queue import SimpleQueue
from time import monotonic, sleep

import pytest
from rich.console import Console

from bus.can.frame import Frame
from bus.outside.external import SpecError
from bus.protocol import Device, Opcode, pack_command
from bus.protocol.report import pack_report, unpack_report
from host.links.ports import CanPort, LinkTask
from scenarios.doors.cabled_host import CabledHost
from scenarios.doors.hid_unix import UnixDoor
from scenarios.doors.options import HostOptions
from scenarios.lab.networks import devices_in
from scenarios.lab.prepare import chosen
from tests.host.telescope.conftest import Rig


class Flaky:
    """Gives one byte, then breaks."""

    def __init__(self, breaks: bool) -> None:
        self.given = False
        self.breaks = breaks

    def read(self) -> bytes:
        if not self.given:
            self.given = True
            return b"x"
        if self.breaks:
            raise OSError("pulled out")
        sleep(0.01)
        return b""

    def write(self, data: bytes) -> None:
        pass

    def close(self) -> None:
        pass


def until(condition: Callable[[], bool], limit_s: float = 10.0) -> None:
    end = monotonic() + limit_s
    while not condition():
        assert monotonic() < end
        sleep(0.01)


def test_H1_a_broken_link_is_said_once_opened_again_and_stops_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("host.links.ports.RETRY_S", 0.05)
    inbox: SimpleQueue[tuple[str, bytes]] = SimpleQueue()
    said: SimpleQueue[str] = SimpleQueue()
    bad = LinkTask("bad", lambda: Flaky(breaks=True), inbox, said.put)
    good = LinkTask("good", lambda: Flaky(breaks=False), inbox, said.put)
    for task in (bad, good):
        task.start()
    until(lambda: bad.breaks >= 3)
    assert good.is_open and good.breaks == 0
    for task in (bad, good):
        task.close()
    names = [inbox.get()[0] for _ in range(inbox.qsize())]
    assert names.count("good") == 1 and names.count("bad") >= 3
    lines = [said.get() for _ in range(said.qsize())]
    assert "bad: broken: pulled out; tried again every second" in lines and "good: open" in lines
    bad.write(b"x")
    assert bad.lost == 1


def test_a_can_port_carries_commands_and_measurements_as_the_gateway_does() -> None:
    from bus.outside.external import open_bus

    port, other = CanPort("virtual:links"), open_bus("virtual:links")
    try:
        port.write(pack_report([pack_command(Device.AXIS_RA, Opcode.STOP)]))
        message = other.recv(1)
        assert message is not None and message.arbitration_id == 0x080 + Device.AXIS_RA
        message.arbitration_id = 0x200 + Device.AXIS_RA
        message.data[0] = Device.AXIS_RA
        other.send(message)
        assert unpack_report(port.read()) == [Frame(0x211, bytes(message.data))]
    finally:
        port.close()
        other.shutdown()


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Path]:
    """The boards, with their USB as a socket, at real time or as near as this machine comes."""
    rig, path, end = Rig(), tmp_path / "gateway.sock", threading.Event()
    door = UnixDoor(str(path), rig.served)
    door.open()

    def run() -> None:
        while not end.is_set():
            rig.served.run_until(rig.served.now_ns + 10_000_000)
            door.poll(rig.served.now_ns)
            sleep(0.01)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield path
    end.set()
    thread.join()
    door.close()
    rig.host.close()


def test_the_host_by_itself_powers_up_the_boards_beside_a_broken_serial_port(
    served: Path, tmp_path: Path
) -> None:
    text = StringIO()
    missing = f"AXIS_RA={tmp_path / 'missing'}"
    options = HostOptions(usb=f"unix:{served}", serial=(missing,), logs=tmp_path / "logs")
    program = CabledHost(options, Console(file=text))
    assert program.pc.cameras == ()  # there is no sky in this process
    for task in program.tasks:
        task.start()
    telescope = program.pc.telescope
    try:
        program.tick()
        future = None
        end = monotonic() + 60
        while not telescope.snapshot.powered:
            assert monotonic() < end, text.getvalue()
            program.tick()
            sleep(0.05)
            if future is None and telescope.snapshot.ra.steps is not None:
                future = telescope.call(lambda t: t.drive.power_on(check=False))
    finally:
        program.close()
    assert "broken" in text.getvalue()
    assert "POWER 1  ok" in (tmp_path / "logs" / "commands.log").read_text()


@pytest.mark.parametrize(("network", "count"), [(None, 11), ("lab", 11), ("serial", 5), ("final", 18)])
def test_the_host_expects_the_boards_of_the_network_it_is_told(network: str | None, count: int) -> None:
    boards = devices_in(chosen(network_name=network)[0])
    assert len(boards) == count and ("DOME" in [board.name for board in boards]) == (network == "final")


@pytest.mark.parametrize("spec", ["nope", "nope:vcan0", "socketcan:vcan0,fd"])
def test_a_bus_that_cannot_be_meant_is_refused_at_once(tmp_path: Path, spec: str) -> None:
    with pytest.raises(SpecError):
        CabledHost(HostOptions(usb=f"can:{spec}", logs=tmp_path / "logs"), Console(file=StringIO()))
