"""A node of a few lines that a CANopen master finds nothing wrong with, with places for ways to be wrong."""

from collections.abc import Callable, Iterator

import can

from tests.conformance.scripted import Coming, board, frame

Spoil = Callable[[str], str | None]
RESET, STOP, START, SYNC = "82 00", "02 00", "01 00", 0x080
ABORTS = {
    "40 00 50 00 00 00 00 00": 0x06020000,  # object does not exist
    "40 18 10 09 00 00 00 00": 0x06090011,  # sub-index does not exist
    "23 00 10 00 00 00 00 00": 0x06010002,  # write a read only object
    "23 17 10 00 00 00 00 00": 0x06070010,  # length does not match
    "e0 00 10 00 00 00 00 00": 0x05040001,  # command specifier not valid
    "60 00 00 00 00 00 00 00": 0x05040001,
    "2f 03 18 02 f5 00 00 00": 0x06090030,  # value range exceeded
    "23 00 1a 01 20 00 00 10": 0x08000022,  # not because of the device state
    "23 10 10 01 01 00 00 00": 0x08000020,  # cannot be stored
}
"""Requests and their abort codes (CiA 301, table 22)."""


class Node:
    """beats: what follows an NMT command, by its bytes: seconds after it, identifier without node, data.

    spoil: what becomes of an SDO's answer, by its request; None is none.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.beats = {
            RESET: [(0.0, 0x700, "00"), *((each, 0x700, "7f") for each in (1.0, 2.0, 3.0))],
            STOP: [(0.5, 0x700, "04"), (1.5, 0x700, "04")],
            START: [(0.75, 0x700, "05"), (0.75, 0x380, "51 f7"), (0.75, 0x200, "")],
        }
        self.spoil: dict[str, Callable[[str], str | None]] = {}
        self.short = False
        self.event = True
        self.per_sync = 1
        self.ping = board(number)

    def __call__(self, message: can.Message) -> Coming:
        data = bytes(message.data).hex(" ")
        if message.arbitration_id == 0x000:
            for after_s, base, said in self.beats[data]:
                yield after_s, frame(base + self.number, bytes.fromhex(said))
        elif message.arbitration_id == SYNC and not self.event:
            yield from ((0.0, frame(0x380 + self.number, b"\x51\xf7")) for _ in range(self.per_sync))
        elif message.arbitration_id == 0x600 + self.number:
            yield from self.serve(data)
        else:
            yield from self.ping(message)

    def serve(self, request: str) -> Iterator[tuple[float, can.Message]]:
        if len(request) == 23 or self.short:
            sound = self.sound(request)
            said = self.spoil[request](sound) if request in self.spoil else sound
            if said is not None:
                yield 0.0, frame(0x580 + self.number, bytes.fromhex(said))
        if request[:11] == "2f 03 18 02" and request not in ABORTS:
            self.event = request[12:14] == "ff"
            yield 1.0, frame(0x380 + self.number, b"\x51\xf7")  # once, as it becomes valid

    def sound(self, request: str) -> str:
        if request in ABORTS:
            return f"80 {request[3:11]} {ABORTS[request].to_bytes(4, 'little').hex(' ')}"
        if request[:2] == "2f":
            return f"60 {request[3:11]} 00 00 00 00"
        if request[3:11] == "17 10 00":
            return "4b 17 10 00 e8 03 05 07"  # 1000 ms; two bytes more that mean nothing
        return f"43 {request[3:11]} 11 22 33 44"
