"""Inside the guest: programs of others on the served network, on real drivers. Prints one line a check.

Usage: attach.py CONTROL_PORT. The boards are on vcan0 and on a /dev/hidrawN; exit status 0 when all is well.
"""

import json
import socket
import subprocess
import sys
import time
from pathlib import Path

import can
import hidraw  # hidapi on the kernel's hidraw; its module `hid` would go through libusb

VENDOR, PRODUCT = 0x04D8, 0x003F
FOCUS, DISPLAY = 0x41, 0x51
PING = bytes((FOCUS, 1, 0, 0, 0, 0, 0, 0))
WALL_S = 60.0
"""The longest wait. The guest's processor is emulated: simulated milliseconds take long."""
QUIET_S = 2.0
"""Without a frame for this long the bus stands still; running it brings some twenty a second even here."""


def say(text: str) -> None:
    print(f"attach: {text}", flush=True)


def control(line: str) -> str:
    with socket.create_connection(("127.0.0.1", int(sys.argv[1])), WALL_S) as connection:
        connection.settimeout(WALL_S)
        connection.sendall(line.encode() + b"\n")
        return connection.makefile().readline().strip()


def answer(bus: can.BusABC, device: int, wall_s: float = WALL_S) -> can.Message | None:
    end = time.monotonic() + wall_s
    while time.monotonic() < end:
        message = bus.recv(1.0)
        if message is not None and message.arbitration_id == 0x100 + device:
            return message
    return None


def heard_until_quiet(bus: can.BusABC) -> list[int]:
    end, heard = time.monotonic() + WALL_S, []
    while (message := bus.recv(QUIET_S)) is not None:
        heard.append(message.arbitration_id)
        assert time.monotonic() < end, f"frames go on while it is paused: {heard[-5:]}"
    return heard


def status() -> dict[str, object]:
    return dict(json.loads(control("status").removeprefix("ok ")))


def candump_and_cansend() -> None:
    command = ["candump", "-n", "1", f"vcan0,{0x100 + FOCUS:X}:7FF"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
        end = time.monotonic() + WALL_S
        while listener.poll() is None and time.monotonic() < end:  # candump may not listen yet: ask again
            subprocess.run(["cansend", "vcan0", f"{0x080 + FOCUS:03X}#{PING.hex()}"], check=True)
            time.sleep(2)
        listener.kill()
        out, _ = listener.communicate()
    assert "141   [8]  41 01 00" in out, out
    say("cansend commanded the focus board, candump saw its answer")


def two_clients() -> None:
    with (
        can.Bus(interface="socketcan", channel="vcan0") as one,
        can.Bus(interface="socketcan", channel="vcan0") as two,
    ):
        for bus, device in ((one, FOCUS), (two, DISPLAY)):
            data = bytes((device, 1, 0, 0, 0, 0, 0, 0))
            bus.send(can.Message(arbitration_id=0x080 + device, data=data, is_extended_id=False))
        assert answer(one, DISPLAY) and answer(two, FOCUS), "a client missed the other's answer"
    say("two python-can clients command, and each sees the other's answer")


def pause_and_resume() -> None:
    with can.Bus(interface="socketcan", channel="vcan0") as bus:
        assert control("pause") == "ok paused"
        heard_until_quiet(bus)  # what was under way when it stopped
        stopped_at = status()["simulated_s"]
        for _ in range(3):
            bus.send(can.Message(arbitration_id=0x080 + FOCUS, data=PING, is_extended_id=False))
        assert (heard := heard_until_quiet(bus)) == [], f"frames while it is paused: {heard[:5]}"
        assert status()["simulated_s"] == stopped_at
        assert control("resume") == "ok running"
        assert all(answer(bus, FOCUS) for _ in range(3)), "a frame sent while paused is lost"
    say("paused nothing moves; what was sent meanwhile is answered after it goes on")


def gateway_path() -> bytes:
    found = hidraw.enumerate(VENDOR, PRODUCT)
    assert len(found) == 1, found
    say(f"hidapi found {found[0]['product_string']!r} at {found[0]['path'].decode()}")
    return bytes(found[0]["path"])


def hid_program(path: bytes) -> None:
    device = hidraw.device()
    device.open_path(path)
    end, replies = time.monotonic() + WALL_S, 0
    device.write(b"\0" + PING.ljust(64, b"\0"))
    while time.monotonic() < end and not replies:
        report = bytes(device.read(64, 5000))
        assert len(report) in (0, 64)
        slots = [report[i : i + 8] for i in range(0, len(report), 8)]
        replies += sum(slot[0] == FOCUS | 0x80 and slot[1] == 1 and slot[2] == 0 for slot in slots)
    device.close()
    assert replies, "no answer over hidraw"
    say("a hidapi program drives the gateway through hidraw")


def killed(path: bytes) -> None:
    for command in (["candump", "vcan0"], ["cat", path.decode()]):
        with subprocess.Popen(command, stdout=subprocess.PIPE) as client:
            assert client.stdout is not None
            assert client.stdout.read(16), f"{command} hears nothing"  # it is attached
            client.kill()
    with can.Bus(interface="socketcan", channel="vcan0") as bus:
        bus.send(can.Message(arbitration_id=0x080 + FOCUS, data=PING, is_extended_id=False))
        assert answer(bus, FOCUS), "the bus is dead after a client was killed"
    hid_program(path)
    say("clients killed with -9 leave the others served")


def main() -> None:
    candump_and_cansend()
    two_clients()
    pause_and_resume()
    path = gateway_path()
    assert Path(path.decode()).name.startswith("hidraw")
    hid_program(path)
    killed(path)
    boards = status()["boards"]
    assert isinstance(boards, dict) and all(boards.values()), boards
    say("all checks passed")


if __name__ == "__main__":
    main()
