"""Scales of the axis log (shared with its format) and of the axis. All from the paper unless told."""

from plant.units import ARCSEC as ARCSEC
from plant.units import ARCSEC_PER_TURN

ENCODER_ARCSEC = ARCSEC_PER_TURN / 112_896_000.0
"""arcsec per incremental count: 4.608e6 counts x 735/30 (paper 2.2, 3.2)."""
CONTROL_PERIOD_S = 0.005
"""Sampling time of the controller (paper 3.3)."""
LOG_PERIOD_S = 0.010
"""Sampling time of the log (paper 3.4)."""
COUNT_RATE = ENCODER_ARCSEC / CONTROL_PERIOD_S
"""arcsec/s per count in 5 ms: the velocity quantum, 2.296."""
ADC_A_PER_COUNT = 0.0061
"""A per ADC count: 0.1 ohm, gain 8, 10 bit, 5 V (ASSUMPTION, hardware.md 2.3)."""
EFFORT_SCALE = 3000
"""The effort's unit is 1/3000 of the supply (log format)."""
GEAR_RATIO = 113 / 27 * 123 / 21 * 250 / 17
"""Motor turns per axis turn (paper 2.2)."""
