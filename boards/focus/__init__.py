"""Focus controller (B5): PIC18F4431 + MCP2515."""
