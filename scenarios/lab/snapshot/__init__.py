"""A running network as bytes, and bytes as a running network."""

from scenarios.lab.snapshot.freeze import SnapshotError, restore, take

__all__ = ["SnapshotError", "restore", "take"]
