"""Axis PI controller (B1, B2): dsPIC30F3011 + MCP2515, one per axis."""
