"""What can go wrong, as one table: scenarios, the live call, the schema and the documentation read it."""

from scenarios.faults.kind import FaultError, Kind, Parameter
from scenarios.faults.live import Faults, Running
from scenarios.faults.table import KINDS

__all__ = ["KINDS", "FaultError", "Faults", "Kind", "Parameter", "Running"]
