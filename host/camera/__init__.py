"""Cameras at the telescope: the sky where the true axes look, as a detector records it."""
