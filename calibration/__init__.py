"""Closes the loop with measured data: what is left of a log after the declared model, and which effect it
is."""
