"""USB full-speed HID endpoint pair of the PIC18F4550: 64-byte reports, polled by the host every 1 ms."""

from collections.abc import Callable
from typing import Final

REPORT_BYTES: Final = 64
FRAME_NS: Final = 1_000_000
"""USB start of frame, bInterval = 1 (USB 2.0: full-speed interrupt endpoints, hardware.md 3.5)."""


class HidEndpoint:
    """Between the gateway's firmware and the PC.

    to_host: called with (t_ns, report) at the frame that carries it; set by the PC's side.
    from_host: called by the PC's side with (t_ns, report); set by the firmware.
    ready: whether the firmware takes a report now, or lets the endpoint NAK; set by the firmware.
    """

    def __init__(self) -> None:
        self.to_host: Callable[[int, bytes], None] | None = None
        self.from_host: Callable[[int, bytes], None] = _nobody
        self.ready: Callable[[], bool] = _always

    def write(self, t_ns: int, report: bytes) -> None:
        """The PC hands over an output report at `t_ns` (now). Raises ValueError unless it has 64 bytes."""
        if len(report) != REPORT_BYTES:
            raise ValueError(f"HID report has {len(report)} bytes, the endpoint takes {REPORT_BYTES}")
        self.from_host(t_ns, report)


def _nobody(_t_ns: int, _report: bytes) -> None:
    """Reports before the firmware has started are lost."""


def _always() -> bool:
    """An endpoint whose firmware does not say is never busy."""
    return True


def next_frame_ns(t_ns: int) -> int:
    """Time of the first start of frame after `t_ns`."""
    return (t_ns // FRAME_NS + 1) * FRAME_NS
