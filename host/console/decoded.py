"""Frames as a person reads them on the bus page: by the protocol's own database."""


def words(identifier: int, data: bytes) -> str:
    """Signals of a frame; its device is the sender's column already."""
    from bus.protocol.database import database

    try:
        said = database().decode_message(identifier, data)
    except Exception:  # whatever anybody put on the bus is shown as it is
        return "not in the protocol"
    pairs = said.items() if isinstance(said, dict) else ()
    return ", ".join(f"{name} {value}" for name, value in pairs if name != "Device")
