"""Power control (B8): eight relays, supply voltage and current."""

from boards.power.firmware import PowerBoard

__all__ = ["PowerBoard"]
