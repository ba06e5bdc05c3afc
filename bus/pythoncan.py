"""`can.Bus(interface="schmidt")`: the name at which python-can's entry point finds the interface."""

from bus.outside.pythoncan import SchmidtBus

__all__ = ["SchmidtBus"]
