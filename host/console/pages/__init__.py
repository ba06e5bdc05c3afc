"""One file per console."""
