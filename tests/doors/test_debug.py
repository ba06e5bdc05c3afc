"""`--debug DIR`: the boards' debug ports as pseudo-terminals, driven by pyserial."""

from pathlib import Path

import pytest
import serial

from boards.core.debug import frame_of, line_of
from bus.can import Frame
from bus.protocol import COMMAND_BASE, Device, Opcode, pack_command, unpack_reply
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.making import make_doors
from scenarios.doors.options import ServeOptions
from scenarios.doors.serial_pty import DebugDoor
from scenarios.lab.prepare import chosen
from tests.doors.conftest import Bench


def test_B9_every_board_has_a_debug_port_that_answers(bench: Bench, tmp_path: Path) -> None:
    door = DebugDoor(str(tmp_path / "debug"), bench.served)
    bench.open(door)
    assert {path.name for path in (tmp_path / "debug").iterdir()} == set(bench.served.network.boards)
    for device in (Device.DISPLAY, Device.GATEWAY, Device.MOTOR_RA_A):
        with serial.Serial(str(tmp_path / "debug" / device.name), timeout=0) as port:
            bench.run(2)
            port.write(b"O\r" + line_of(Frame(COMMAND_BASE + device, pack_command(device, Opcode.PING))))
            heard = bytearray()
            reply = f"t{0x100 + device:03X}8".encode()

            def answered(port: serial.Serial = port, heard: bytearray = heard, reply: bytes = reply) -> bool:
                heard.extend(port.read(4096))
                return reply in heard and heard.endswith(b"\r")

            bench.until(answered)
        line = next(line for line in bytes(heard).split(b"\r") if line.startswith(reply))
        frame = frame_of(line)
        assert frame is not None
        assert unpack_reply(frame.data).opcode == Opcode.PING


def test_what_needs_a_gateway_says_so_on_a_network_without_one() -> None:
    served = LiveNetwork(*chosen(network_name="serial"))
    with pytest.raises(ValueError, match="need the gateway"):
        make_doors(ServeOptions(asked={"lx200": ("0",)}), served)
