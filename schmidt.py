"""The emulator from Python: `schmidt.Lab` and `schmidt.Stepped` (docs/guides/from-python.md)."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scenarios.doors.stepped import Stepped
    from scenarios.lab.lab import Lab

__all__ = ["Lab", "Stepped"]


def __getattr__(name: str) -> Any:
    """When it is asked for: the command line starts without."""
    if name not in __all__:
        raise AttributeError(f"module 'schmidt' has no attribute {name!r}")
    from scenarios.doors.stepped import Stepped
    from scenarios.lab.lab import Lab

    return {"Lab": Lab, "Stepped": Stepped}[name]


if __name__ == "__main__":
    from scenarios.cli import main

    main()
