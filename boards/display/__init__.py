"""Digital display unit (B6)."""
