"""Digital display unit (B6)."""

from boards.display.firmware import DisplayBoard

__all__ = ["DisplayBoard"]
