"""The decision: gate, forward selection with out-of-run scores, equivalence classes, negative controls,
verdict."""
