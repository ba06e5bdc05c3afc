"""Focus controller (B5): PIC18F4431 + MCP2515."""

from boards.focus.config import FocusConfig
from boards.focus.firmware import FocusBoard
from boards.focus.pins import FocusPins

__all__ = ["FocusBoard", "FocusConfig", "FocusPins"]
