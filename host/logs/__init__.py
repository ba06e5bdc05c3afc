"""What the PC writes to disk: four ASCII logs, one axis log per axis, traces. All of it streams."""
