"""The decision: selection, equivalence classes, negative controls, verdict."""
