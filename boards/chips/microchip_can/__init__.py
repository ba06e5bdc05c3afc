"""What Microchip's CAN controllers (MCP2515, ECAN) have in common: buffers, filters, bit timing."""

from boards.chips.microchip_can.bittiming import decode

__all__ = ["decode"]
