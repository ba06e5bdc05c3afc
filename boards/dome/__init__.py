"""Dome control (P13): rotation and shutter, closed in bad weather."""

from boards.dome.firmware import DomeBoard

__all__ = ["DomeBoard"]
