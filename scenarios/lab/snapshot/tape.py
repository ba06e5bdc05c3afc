"""What the host of a run has heard since the start.

Its programme is made of generators, which nothing can take apart: it lives again by hearing the same.
"""

from collections.abc import Callable
from typing import Any

from scenarios.lab.session import Session

Heard = list[tuple[str, tuple[Any, ...]]]
"""(what, arguments), in order: "usb", "tick", "truth", "chain", SEEN, or the name of a board on RS232."""
SEEN = "seen"


class Ear:
    """Between the network and who listens: notes what it hands on."""

    def __init__(self, heard: Heard, kind: str, call: Callable[..., None]) -> None:
        self._heard, self._kind, self._call = heard, kind, call

    def __call__(self, *arguments: Any) -> None:
        """Note it, and hand it on."""
        self._heard.append((self._kind, arguments))
        self._call(*arguments)


class Tape:
    """Records a session from its very start."""

    def __init__(self, session: Session, heard: Heard) -> None:
        self.heard = heard
        self.ears = {kind: Ear(self.heard, kind, call) for kind, call in listeners(session).items()}
        network = session.network
        network.hid.to_host = self.ears["usb"]
        for link in session.serial:
            network.uarts[link.device.name].sink = self.ears[link.device.name]
        session.plant._sink = self.ears["truth"]
        if network.chain is not None:
            network.chain.told = self.ears["chain"]
        session.ticked = self.tick
        session.eye.told = self.seen

    def tick(self, t_ns: int) -> None:
        """The host's clock."""
        self.heard.append(("tick", (t_ns,)))

    def seen(self, hour_angle_rad: float, declination_rad: float) -> None:
        """An offset of a star in the field."""
        self.heard.append((SEEN, (hour_angle_rad, declination_rad)))


def listeners(session: Session) -> dict[str, Callable[..., None]]:
    """Who hears what comes out of a network."""
    calls: dict[str, Callable[..., None]] = {
        "usb": session.link.receive,
        "truth": session.recorder.take_truth,
        "chain": session.chain_says,
    }
    return calls | {link.device.name: link.receive for link in session.serial}
