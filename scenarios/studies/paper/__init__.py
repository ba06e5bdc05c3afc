"""The paper's experiments E1 to E10: emulated, measured as the authors did, set beside their figures."""
