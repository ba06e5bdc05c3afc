"""QEICON, counters and PIR3 flags of the PIC18F4431 (DS39616D p. 165 f., hardware.md 3.5; mode numbers K)."""

from enum import IntEnum

QERR, UP_DOWN = 0x40, 0x20
"""QEICON: a count was lost, direction."""
QEIM_SHIFT, QEIM_MASK = 2, 7
IC2QEIF, IC3DRIF = 0x04, 0x08
"""PIR3: position match, direction change."""
FILTERED_FCY_DIVIDER = 16
"""Highest quadrature frequency: Fcy / 16."""


class Mode(IntEnum):
    """QEIM."""

    OFF = 0b000
    X2_INDEX = 0b001
    X2_MATCH = 0b010
    X4_INDEX = 0b101
    X4_MATCH = 0b110


X2 = (Mode.X2_INDEX, Mode.X2_MATCH)
BY_INDEX = (Mode.X2_INDEX, Mode.X4_INDEX)
