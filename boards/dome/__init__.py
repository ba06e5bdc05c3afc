"""Dome control (P13): rotation and shutter, closed in bad weather."""
