"""The network on a table: boards, bus and plant wired, what goes wrong with them, snapshots."""
