"""Axis PI controller (B1, B2): dsPIC30F3011 + MCP2515, one per axis."""

from boards.axis.config import AxisConfig, AxisPeers
from boards.axis.firmware import AxisBoard
from boards.axis.pins import AxisPins

__all__ = ["AxisBoard", "AxisConfig", "AxisPeers", "AxisPins"]
