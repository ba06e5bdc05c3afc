"""The dome: turn the slit, open or close the shutter, and wait until it is there (H7)."""

import math
from functools import cache
from typing import Final

from bus.protocol import Opcode
from bus.protocol.nodes import DOME, KINDS, FrameCodec, Kind, arguments_of, messages_of
from host.client import Client, Procedure

BOARD: Final = DOME.device("DOME")
NEAR_DEG: Final = 1.0
"""The board stops within 0.5° of its target; as much again for a frame's age."""
_DONE_S: Final = 300.0
"""Half a turn, or the whole way of the shutter, takes a minute or two. ASSUMPTION: twice that."""


@cache
def codecs() -> dict[str, FrameCodec]:
    """Of the measurement frames of declared boards, by board name."""
    found = [FrameCodec(m) for kind in KINDS for m in messages_of(kind) if 0x200 <= m.frame_id < 0x280]
    names = {int(device): device.name for kind in KINDS for device in kind.devices()}
    return {names[codec.identifier & 0x7F]: codec for codec in found}


def reading(client: Client, board: str) -> dict[str, float] | None:
    """Signals of a declared board's last measurement frame in their units; None: none has come."""
    codec = codecs().get(board)
    data = None if codec is None else client.link.measurements.get(codec.identifier & 0x7F)
    return None if codec is None or data is None else codec.unpack(data)


def opcode(kind: Kind, name: str) -> Opcode:
    """The number of a command of a kind of board."""
    return next(each for each in arguments_of(kind) if each.name == name)


def centidegrees(azimuth_deg: float) -> int:
    """The argument of DOME_GOTO."""
    return round(azimuth_deg * 100) % 36000


def turn(client: Client, azimuth_deg: float) -> Procedure:
    """Turn the slit to an azimuth; raises ClientError when it does not come."""
    yield from client.ask(BOARD, opcode(DOME, "DOME_GOTO"), centidegrees(azimuth_deg))

    def there() -> bool:
        now = reading(client, BOARD.name)
        return (
            now is not None
            and not now["Moving"]
            and abs(math.remainder(azimuth_deg - now["Azimuth"], 360)) <= NEAR_DEG
        )

    yield from client.until(f"{BOARD.name}: at azimuth {azimuth_deg:g}°", there, _DONE_S)


def shutter(client: Client, opened: bool) -> Procedure:
    """Open or close it; raises ClientError, in bad weather at once."""
    yield from client.ask(BOARD, opcode(DOME, "DOME_SHUTTER"), int(opened))
    word = "Opened" if opened else "Closed"

    def there() -> bool:
        now = reading(client, BOARD.name)
        return now is not None and bool(now[word])

    yield from client.until(f"{BOARD.name}: {word.lower()}", there, _DONE_S)
