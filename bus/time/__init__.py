"""Time: one integer count of nanoseconds, one event queue, free-running crystals, seeded randomness."""

from bus.time.oscillator import Oscillator
from bus.time.queue import EventQueue, PastEventError
from bus.time.randomness import generator

__all__ = ["EventQueue", "Oscillator", "PastEventError", "generator"]
