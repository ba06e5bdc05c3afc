"""The paper's experiments E1 to E10: run on the emulator, measured as the authors measured, set beside their
figures."""
