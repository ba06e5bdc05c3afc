"""Many runs of one scenario: planned, run anywhere, gathered in one table, looked at together."""
