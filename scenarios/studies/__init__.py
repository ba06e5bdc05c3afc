"""Studies on the emulator: the paper's experiments, and how well 15 arcsec/s is held."""
