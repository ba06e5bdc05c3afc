"""A multicast group is one bus, whoever else uses its port on this machine."""

import errno
import os
from contextlib import ExitStack

import can
import pytest

from bus.outside.external import SpecError, open_bus
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode, pack_command
from scenarios.doors.can import CanDoor
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.lab.prepare import chosen

IPV4 = ("239.74.163.21", "239.74.163.22")
IPV6 = ("ff15:7079:7468:6f6e:6465:6d6f:6d63:6121", "ff15:7079:7468:6f6e:6465:6d6f:6d63:6122")
DEVICE = Device.POSITION_RA
HEARD_S = 0.2
"""Wall time within which a datagram on one machine has arrived."""


def specs(groups: tuple[str, str]) -> list[str]:
    port = 20_000 + os.getpid() % 20_000
    return [f"udp_multicast:{group},port={port}" for group in groups]


def opened(stack: ExitStack, spec: str) -> can.BusABC:
    try:
        return stack.enter_context(open_bus(spec))
    except SpecError as error:
        pytest.skip(f"no multicast here: {error}")


@pytest.mark.parametrize("groups", [IPV4, IPV6], ids=["ipv4", "ipv6"])
def test_a_frame_of_one_group_is_not_heard_in_another(groups: tuple[str, str]) -> None:
    one, other = specs(groups)
    said = can.Message(arbitration_id=0x123, data=b"x", is_extended_id=False)
    with ExitStack() as stack:
        sender, same, foreign = (opened(stack, spec) for spec in (one, one, other))
        try:
            sender.send(said)
        except can.CanError as error:
            pytest.skip(f"no multicast here: {error}")
        if same.recv(5.0) is None:
            pytest.skip("multicast does not come back here")
        assert foreign.recv(HEARD_S) is None


def test_one_ping_beside_two_networks_has_one_reply() -> None:
    one, other = specs(IPV4)
    served = [LiveNetwork(*chosen()) for _ in range(2)]
    doors = [CanDoor(spec, 0, each) for spec, each in zip((one, other), served, strict=True)]
    with ExitStack() as stack:
        client = opened(stack, one)
        for door in doors:
            door.open()
            stack.callback(door.close)
        client.send(
            can.Message(
                arbitration_id=COMMAND_BASE + DEVICE,
                data=pack_command(DEVICE, Opcode.PING),
                is_extended_id=False,
            )
        )
        replies = 0
        for _ in range(30):
            message = client.recv(HEARD_S / 30)
            for door, each in zip(doors, served, strict=True):
                door.poll(each.now_ns)
                each.run_until(each.now_ns + 1_000_000)
            while message is not None:
                replies += message.arbitration_id == REPLY_BASE + DEVICE
                message = client.recv(0)
        entered = [door.fence.frames_in for door in doors if door.fence is not None]
        if entered == [0, 0]:
            pytest.skip("multicast does not come back here")
    assert replies == 1
    assert entered == [1, 0]


@pytest.mark.parametrize(
    ("code", "remedy"),
    [
        (errno.EAFNOSUPPORT, "udp_multicast:239.74.163.2"),
        (errno.ENODEV, "sudo ip link add dev vcan7 type vcan && sudo ip link set vcan7 up"),
        (errno.ENETDOWN, "sudo ip link set vcan7 up"),
    ],
)
def test_a_channel_that_linux_refuses_says_what_to_try(
    monkeypatch: pytest.MonkeyPatch, code: int, remedy: str
) -> None:
    def refused(**_: object) -> None:
        try:
            raise OSError(code, os.strerror(code))
        except OSError as error:  # as python-can hands it on
            raise can.CanInitializationError("no channel") from error

    monkeypatch.setattr(can, "Bus", refused)
    with pytest.raises(SpecError) as caught:
        open_bus("socketcan:vcan7")
    assert str(caught.value).endswith(f"; try: {remedy}") or f"; try: {remedy}," in str(caught.value)
