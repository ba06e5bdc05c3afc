"""USB-to-CAN gateway (B7): PIC18F4550 + MCP2515."""
