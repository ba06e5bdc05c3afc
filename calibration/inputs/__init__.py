"""From files to runs: the declaration of a drive, and columns with unit, clock, quantum, gaps and wraps."""
