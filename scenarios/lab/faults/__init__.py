"""What can go wrong, as one table: scenarios, the live call, the schema and the documentation read it."""

from scenarios.lab.faults.kind import FaultError, Kind, Parameter
from scenarios.lab.faults.live import Faults, Running
from scenarios.lab.faults.table import KINDS

__all__ = ["KINDS", "FaultError", "Faults", "Kind", "Parameter", "Running"]
