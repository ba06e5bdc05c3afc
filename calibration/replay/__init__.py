"""The closed loop run again along a held-out run: with the declared model, and with the corrected plant."""
