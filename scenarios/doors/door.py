"""What every door of a served network is: something that opens, is polled, closes, and may open again."""

from typing import Protocol


def counted(*told: tuple[int, str]) -> str:
    """Counts in words, `3 clients, 2 refused`, without what there was none of."""
    return ", ".join(f"{count} {what}" for count, what in told if count)


class DoorError(OSError):
    """A door that cannot be opened, or is broken; one line. It is reported and tried again."""


class Door(Protocol):
    """A way in from outside. `schmidt serve` holds any number and knows nothing else of them.

    Everything is called from one thread, between two slices of simulated time. What enters goes through
    `Entry` (or a `UsbPlug`, which does so), never straight into the network: there it is stamped and
    recorded.
    """

    name: str
    """As the user wrote it, for reports: `--can socketcan:vcan0`."""

    def open(self) -> None:
        """Bind, attach, connect. Raises OSError, ValueError or can.CanError with the reason it cannot."""

    def poll(self, now_ns: int) -> None:
        """Take what has arrived, hand out what has happened until `now_ns` (simulated). Never blocks.

        Raises OSError or can.CanError when the door is broken: it is closed, reported, and opened again
        later. A client that misbehaves is the door's own business.
        """

    def close(self) -> None:
        """Let go of everything; twice does nothing, and so does closing what never opened."""

    def state(self) -> str:
        """Words for the end: clients, counts, what was refused. Empty: nobody was there."""
