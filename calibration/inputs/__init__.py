"""From files to records: a declaration of the drive, and columns with unit, clock, quantum, gaps and
wraps."""
