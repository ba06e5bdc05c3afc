"""What a snapshot may name: classes of what is emulated, and the few functions that it is put together by.

Nothing here opens a file, a socket or a program, and no function is admitted for being the project's own.
"""

from types import BuiltinFunctionType, FunctionType
from typing import Any, Final

from scenarios.lab.nodes import MODULE
from scenarios.native.modules import PACKAGE

_OURS: Final = (
    "boards.", "bus.can.", "bus.protocol.", "bus.time.", "bus.outside.node", "host.sky.", "plant.",
    "scenarios.lab.blowing", "scenarios.lab.chain", "scenarios.lab.faults.", "scenarios.lab.network",
    "scenarios.lab.nodes", "scenarios.lab.snapshot.",
    "scenarios.doors.usb", "scenarios.language.model", MODULE,
)  # fmt: skip
"""Modules whose classes may be in one. MODULE: boards of a user's own, which the scenario loads first."""
_NOT: Final = ("boards.avr.", "boards.c.library", "boards.c.isolated", "plant.fmu.")
"""These begin programs. A file of C is built anew, as a user's own board in Python is run."""
_INNER: Final = ("boards.", "bus.can.", "plant.", "scenarios.lab.faults.", "scenarios.doors.lines", MODULE)
"""Modules whose functions inside functions may be."""
_LIBRARIES: Final = ("canopen.", "numpy.random.", "cantools.")
_HELPERS: Final = {
    "boards.c.isolated": {"unbuilt"},
    "boards.core.interrupts": {"_no_routine"},
    "boards.core.commands": {"_nothing"},
    "boards.silicon.hid": {"_nobody", "_always"},
    "bus.protocol.saturate": {"nobody"},
    "scenarios.lab.faults.layers": {"chained", "turned"},
    "scenarios.lab.snapshot.code": {"cell", "fill", "finish", "function"},
    "scenarios.lab.snapshot.freeze": {"_array", "_view"},
    "numpy.random._pickle": {"__bit_generator_ctor", "__generator_ctor"},
    "numpy.random.bit_generator": {"__pyx_unpickle_SeedSequence"},
}
"""Functions, by module."""
_STANDARD: Final = {
    "builtins": {"set", "frozenset", "bytearray", "complex", "range", "slice"},
    "collections": {"deque", "Counter", "OrderedDict", "defaultdict"},
    "functools": {"partial"},
    "pathlib": {"PosixPath", "WindowsPath", "Path"},
    "datetime": {"datetime", "timezone", "timedelta"},
    "copyreg": {"__newobj__", "_reconstructor"},
    "_codecs": {"encode"},
    "threading": {"Condition", "RLock"},
    "_thread": {"allocate_lock", "RLock"},
    "logging": {"getLogger"},
    "queue": {"Queue"},
    "struct": {"Struct"},
    "numpy": {"ndarray", "dtype"},
    "numpy.core.multiarray": {"scalar", "_reconstruct"},
    "numpy._core.multiarray": {"scalar", "_reconstruct"},
}
"""What of the standard library, and of numpy's own, one is made of."""
_METHOD: Final = ("builtins", "getattr")
"""Named for bound methods, and replaced by what looks at its arguments."""
_HOST: Final = ("scenarios.lab.session", "_tick")
"""The host of a run, which is not taken, is called by what is."""


def _ours(module: str) -> bool:
    return module.startswith(_OURS) and not module.startswith(_NOT)


def may_be_named(module: str, name: str) -> bool:
    """Whether to import `module` at all."""
    plain = module.removeprefix(PACKAGE)
    special = (module, name) == _METHOD or name in _STANDARD.get(module, ())
    return special or plain in _HELPERS or _ours(plain) or module.startswith(_LIBRARIES)


def is_class_or_helper(found: Any, module: str, name: str) -> bool:
    """Whether `found`, which `module` calls `name`, is a class of its own, or one of the helpers."""
    if name in _STANDARD.get(module, ()) or name in _HELPERS.get(module, ()):
        return True
    if isinstance(found, FunctionType | BuiltinFunctionType):
        return module.startswith(MODULE) and found.__module__ == module
    own = isinstance(found, type) and found.__module__.removeprefix(PACKAGE) == module
    return own and (_ours(module) or module.startswith(_LIBRARIES))


def has_method(kind: type, name: str) -> bool:
    """Whether a bound method of an object of class `kind` may be in a snapshot."""
    module = kind.__module__.removeprefix(PACKAGE)
    if name.startswith("__") or kind is type:
        return False
    called = module.startswith("canopen.") and name.startswith("on_")
    called |= (module, name) == _HOST
    return called or module == "collections" or _ours(module)


def has_inner(module: str) -> bool:
    """Whether functions inside the functions of `module` may be."""
    return module.startswith(_INNER) and not module.startswith(_NOT)
