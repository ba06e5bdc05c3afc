"""Closes the loop with measured data: what a declared model leaves of a log, and which effect it is."""
