"""Motor velocity board (B4): a CP-850 encoder on a motor shaft as digital tachometer."""
