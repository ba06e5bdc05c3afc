"""MCP2515, stand-alone CAN controller behind SPI: register level (DS20001801; hardware.md 3.2)."""

from boards.chips.mcp2515.chip import Mcp2515

__all__ = ["Mcp2515"]
