"""Which modules are compiled: the one list."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
"""Where the rooms lie: the checkout, or site-packages."""
PACKAGE = __name__.removesuffix("scenarios.native.modules")
"""What stands before the rooms' names: nothing in a checkout, `schmidt.` in a wheel."""
ROOMS = ("bus", "boards", "plant", "host", "scenarios")
"""What a run is made of."""
FOLDERS = ("bus/time", "bus/can", "bus/protocol", "boards")
"""Everything in these, and below."""
FILES = (
    "host/client.py",
    "host/link.py",
    "host/logs/axis.py",
    "host/logs/sensors.py",
    "host/procedures/pointing.py",
    "host/serial_link.py",
    "plant/axis.py",
    "plant/focus.py",
    "plant/grid.py",
    "plant/plant.py",
)
"""And these: what is called for every tick and frame."""
PLAIN = (
    "bus/protocol/command_layouts.py",
    "bus/protocol/nodes/",
    "boards/chips/",
    "boards/c/",
    "boards/avr/",
    "boards/canopen/",
    "boards/auxiliary/firmware.py",
    "boards/dome/firmware.py",
    "boards/power/firmware.py",
    "boards/weather/firmware.py",
)
"""What takes an `Opcode` as an int and asks for its layout: mypyc unboxes it to a bare number.
Declarations, which are read once: a frozen record of the library cannot be pickled.
No night runs on the chips at register level, and mypyc refuses one of them.
Classes that derive from those of a package that is not compiled stay plain, too.
So do classes that inherit `DeclaredBoard`'s constructor. There mypyc calls it twice (two ports on the wire).
A compiled class that plain code derives from says so (`mypyc_attr`): Python forbids it of all others."""
_PLACE = "__file__"
"""A module that looks for files beside itself stays plain: compiled, it lies elsewhere."""


def selected(root: Path = ROOT) -> list[str]:
    """Paths of the modules to compile, relative to `root`, in order."""
    found = {path for folder in FOLDERS for path in (root / folder).rglob("*.py")}
    found |= {root / file for file in FILES}
    return sorted(
        path.relative_to(root).as_posix()
        for path in found
        if path.is_file()
        and path.name != "__init__.py"
        and not path.relative_to(root).as_posix().startswith(PLAIN)
        and _PLACE not in path.read_text(encoding="utf-8")
    )
