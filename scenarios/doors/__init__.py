"""The doors of `schmidt serve` and `schmidt host`: one file each, a row each in `table.py`."""
