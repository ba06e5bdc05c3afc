"""Axis PI controller (B1, B2): dsPIC30F3011 + MCP2515, one per axis."""

from boards.axis.config import AxisConfig, AxisPeers, AxisPins
from boards.axis.firmware import AxisBoard

__all__ = ["AxisBoard", "AxisConfig", "AxisPeers", "AxisPins"]
