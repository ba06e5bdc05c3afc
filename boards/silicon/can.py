"""The CAN controller as the firmware sees it: filters, three transmit buffers, receive interrupt.

Two masks and six filters as in the MCP2515 (the PIC18F4480's ECAN in legacy mode has the same set). Filters 0
and 1 go with mask 0, filters 2..5 with mask 1 (hardware.md 3.2). The chips to the register are in
`boards/chips`.
"""

from collections.abc import Callable, Sequence
from typing import Final

from bus.can import Frame, Port

FULL_MASK: Final = 0x7FF
_FILTERS: Final = (2, 4)
"""Filters that go with each mask."""


class CanController:
    """One node's controller on `port`.

    send: the port's own `send(frame, ready_ns) -> bool`, False when all three transmit buffers are full.
    """

    def __init__(self, port: Port, on_receive: Callable[[int, Frame], None]) -> None:
        self.port = port
        self.send: Callable[[Frame, int], bool] = port.send
        port.on_receive = on_receive

    def accept(self, *groups: tuple[int, Sequence[int]]) -> None:
        """Program the masks and filters: up to two (mask, codes) groups of at most two and four codes.

        Raises ValueError for what the chip cannot hold.
        """
        if len(groups) > len(_FILTERS):
            raise ValueError(f"CAN controller has {len(_FILTERS)} masks, {len(groups)} asked for")
        ordered = sorted(groups, key=lambda group: len(group[1]))
        limits = _FILTERS if len(groups) == len(_FILTERS) else _FILTERS[-1:]
        for (mask, codes), limit in zip(ordered, limits, strict=False):
            if len(codes) > limit:
                raise ValueError(
                    f"CAN controller has {limit} filters for mask {mask:#05x}, {len(codes)} asked for"
                )
        self.port.accept([(mask, code) for mask, codes in groups for code in codes])
