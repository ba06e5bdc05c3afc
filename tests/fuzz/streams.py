"""Attacks on what needs no running network: serial packets, the debug port, log files.

Whatever is accepted must say what the input says (nothing changes silently), and a stream that is fed byte by
byte must come out as the one that is fed whole.
"""

from random import Random

from boards.core.debug import frame_of
from bus.protocol import COMMAND_BASE, Device, Opcode
from bus.protocol.serial import SYNC, Packet, PacketDecoder, pack_packet
from tests.boards.core.test_debug import Desk
from tests.fuzz import near
from tests.fuzz.left import counted

Said = tuple[list[Packet], int, int]
_FRESH = 500
"""Inputs until a debug port gets a new board."""


def _decoded(pieces: list[bytes]) -> Said:
    decoder = PacketDecoder()
    found = [packet for piece in pieces for packet in decoder.feed(piece)]
    return found, decoder.crc_errors, decoder.skipped_bytes


def packets(count: int, random: Random) -> dict[str, int]:
    """RS232 packets, torn, joined and with wrong bytes: what is decoded stands in the stream, in order."""
    found = {"accepted": 0, "refused": 0}
    for _ in counted(count):
        stream = near.packets(random)
        whole = _decoded([stream])
        if whole != _decoded([stream[at : at + 1] for at in range(len(stream))]):
            raise AssertionError(f"byte by byte it is another outcome: {stream.hex()}")
        at = 0
        for packet in whole[0]:
            again = pack_packet(*packet)
            at = stream.index(again, at) + len(again)
        gone = sum(len(pack_packet(*packet)) for packet in whole[0]) + whole[2]
        if stream[gone:] and not stream[gone:].startswith(SYNC[: len(stream) - gone]):
            raise AssertionError(f"{len(stream) - gone} bytes wait that begin no packet: {stream.hex()}")
        found["accepted" if whole[0] else "refused"] += 1
    return found


def _lines(said: bytes) -> tuple[list[bytes], list[bytes]]:
    """Answers to lines, and replies to commands: a frame of its own may come between any two answers."""
    ends = said.replace(b"\a", b"\a\r").split(b"\r")
    replies = [each for each in ends if each.startswith(b"t1")]
    return [each for each in ends if not each.startswith(b"t")], replies


def debug(count: int, random: Random) -> dict[str, int]:
    """Bytes on a board's debug port, whole and byte by byte: the same answers, replies and losses."""
    found = {"accepted": 0, "refused": 0}
    whole, bytewise = Desk(), Desk()
    for number in counted(count):
        if number % _FRESH == 0:
            whole, bytewise = Desk(), Desk()
        data = near.slcan(random, Device.DISPLAY)
        one = whole.say(data, 60)
        for at in range(len(data)):
            bytewise.port.write(bytewise.queue.now_ns, data[at : at + 1])
        other = bytewise.say(b"", 60)
        if _lines(one) != _lines(other) or whole.port.lost != bytewise.port.lost:
            raise AssertionError(f"{data!r}: whole {one!r}, byte by byte {other!r}")
        if whole.board.inbox or not whole.board.on:
            raise AssertionError(f"{data!r}: the board is stuck")
        found["refused" if b"\a" in one or not one else "accepted"] += 1
    if b"z" not in whole.say(
        b"\rO\r" + near.COMMAND % (COMMAND_BASE + Device.DISPLAY, Device.DISPLAY, Opcode.PING)
    ):
        raise AssertionError("the board answers no more")
    return found


def slcan(count: int, random: Random) -> dict[str, int]:
    """Single lines of a debug port: a frame is what the line's digits are, or there is none."""
    found = {"accepted": 0, "refused": 0}
    for _ in counted(count):
        line = near.slcan_line(random, Device.DISPLAY)
        frame = frame_of(line)
        if frame is not None:
            again = f"t{frame.identifier:03X}{len(frame.data)}{frame.data.hex()}".encode()
            if again.upper() != line.upper() or frame.identifier > 0x7FF:
                raise AssertionError(f"{line!r} was taken for {again!r}")
        found["refused" if frame is None else "accepted"] += 1
    return found
