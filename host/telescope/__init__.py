"""The typed telescope client: what doors, consoles and programs command the telescope by."""

from host.sky.tracks import DriveRate
from host.sky.visibility import Observatory
from host.telescope.desk import AsyncDesk
from host.telescope.jobs import Activity, Job, Reason, Refused
from host.telescope.state import AxisState, BoardState, Snapshot
from host.telescope.telescope import Telescope

__all__ = [
    "Activity", "AsyncDesk", "AxisState", "BoardState", "DriveRate", "Job", "Observatory",
    "Reason", "Refused", "Snapshot", "Telescope",
]  # fmt: skip
