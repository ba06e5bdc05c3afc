"""Focus controller (B5): PIC18F4431 + MCP2515."""

from boards.focus.config import FocusConfig, FocusPins
from boards.focus.firmware import FocusBoard

__all__ = ["FocusBoard", "FocusConfig", "FocusPins"]
