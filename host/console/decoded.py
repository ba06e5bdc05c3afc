"""Frames as a person reads them on the bus page: by the protocol's own database."""

from typing import Any

from host.console.views import SeenFrame


def seen(t_ns: int, sender: str, identifier: int, data: bytes) -> SeenFrame:
    """A frame with its words. t_ns: when its last bit ended, or when the host heard of it."""
    from bus.protocol.database import database

    try:
        said = database().decode_message(identifier, data)
        text = _words(said) if isinstance(said, dict) else ""
    except Exception:  # whatever anybody put on the bus is shown as it is
        text = "not in the protocol"
    return SeenFrame(t_ns * 1e-9, sender, identifier, data, text)


def _words(said: dict[str, Any]) -> str:
    """Signals of a frame; its device is the sender's column already."""
    return ", ".join(f"{name} {value}" for name, value in said.items() if name != "Device")
