"""Chips at register level, for drivers and firmware of others. Our boards run on `boards.silicon`."""
