"""What Microchip's CAN controllers (MCP2515, ECAN) have in common: buffers, filters, bit timing."""

from boards.silicon.microchip_can.acceptance import Acceptance, Hit
from boards.silicon.microchip_can.bittiming import BitTimes, decode
from boards.silicon.microchip_can.message import frame_of, image_of

__all__ = ["Acceptance", "BitTimes", "Hit", "decode", "frame_of", "image_of"]
