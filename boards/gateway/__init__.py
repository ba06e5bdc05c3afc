"""USB-to-CAN gateway (B7): PIC18F4550 + MCP2515."""

from boards.gateway.firmware import GatewayBoard

__all__ = ["GatewayBoard"]
