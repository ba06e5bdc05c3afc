"""What a snapshot may name: classes of what is emulated, and the few functions that it is put together by.

Nothing here opens a file, a socket or a program, and no function is admitted for being the project's own.
"""

from pathlib import Path
from types import BuiltinFunctionType, FunctionType
from typing import Any, Final

import yaml

from scenarios.lab.nodes import MODULE
from scenarios.native.modules import PACKAGE

_TABLE: Final = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
_OURS: Final = (*_TABLE["ours"], MODULE)
_INNER: Final = (*_TABLE["inner"], MODULE)
_NOT: Final = tuple(_TABLE["not"])
_LIBRARIES: Final = tuple(_TABLE["libraries"])
_HELPERS: Final[dict[str, list[str]]] = _TABLE["helpers"]
_STANDARD: Final[dict[str, list[str]]] = _TABLE["standard"]
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
