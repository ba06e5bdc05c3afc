"""`take` and `restore`: the whole graph of a network, from the queue's calls to the plant's arrays.

What lies outside (the host, its files, taps) has names: it is not taken, and is put in its place again.
"""

import io
import pickle
import sys
import threading
from collections.abc import Callable, Mapping
from functools import cache
from hashlib import sha256
from importlib import import_module
from types import CellType, FunctionType
from typing import Any

import numpy as np

from boards.c.library import FirmwareError
from scenarios.lab.snapshot import admitted, code
from scenarios.lab.snapshot.code import Nobody
from scenarios.native.finder import compiled
from scenarios.native.modules import PACKAGE, ROOMS, ROOT

_LOCKS: dict[type, Callable[[], Any]] = {
    type(make()): make for make in (threading.Lock, threading.RLock, threading.Condition)
}
"""`canopen` has some; between two slices nobody holds them or waits."""
_CANOPEN, _NO_NETWORK = "canopen.network", "no CANopen network"
_PLAIN = "snapshots need the plain source: run with SCHMIDT_PURE=1 (the same bits, slower)"
_MAGIC = b"schmidt snapshot 1\n"


class SnapshotError(ValueError):
    """A snapshot that cannot be taken or used; one line."""


@cache
def source_digest() -> str:
    """SHA-256 over the rooms' sources: functions and fields are found by their place in them."""
    digest = sha256()
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def _view(array: np.ndarray[Any, Any]) -> Any:
    """The plant's view of its world: flat, of floats, on the same memory."""
    return memoryview(array.reshape(-1).data).cast("B").cast("d")


def _array(shape: tuple[int, ...], kind: str, data: bytes) -> np.ndarray[Any, Any]:
    """An array that owns its memory, so that a view names it as its base (numpy's own makes a view)."""
    made = np.empty(shape, kind)
    made.reshape(-1)[:] = np.frombuffer(data, kind)
    return made


def _method(value: Any, name: str) -> Any:
    """A bound method of an object that may be in a snapshot."""
    if not admitted.has_method(type(value), name):
        raise SnapshotError(f"snapshot: {name} has no business in one")
    return getattr(value, name)


def _function(module: str, number: int, cells: tuple[CellType, ...]) -> FunctionType:
    """A function inside a function of the boards', the bus', the plant's or the faults'."""
    if not admitted.has_inner(module.removeprefix(PACKAGE)):
        raise SnapshotError(f"snapshot: a function of {module} has no business in one")
    return code.function(module, number, cells)


class _Pickler(pickle.Pickler):
    def __init__(self, file: io.BytesIO, outside: Mapping[str, Any], outsiders: tuple[type, ...]) -> None:
        super().__init__(file, protocol=5)
        self._names = {id(value): name for name, value in outside.items()}
        if _CANOPEN in sys.modules:  # puts there, where no network is yet, what raises whatever it is asked
            self._names[id(sys.modules[_CANOPEN]._UNINITIALIZED_NETWORK)] = _NO_NETWORK
        self._outsiders = outsiders

    def persistent_id(self, value: Any) -> str | None:
        return self._names.get(id(value))

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, self._outsiders):
            return Nobody, ()
        if isinstance(value, FunctionType):
            return self._named(value) if code.importable(value) else self._function(value)
        if type(value) in _LOCKS:
            return _LOCKS[type(value)], ()
        if isinstance(value, CellType):
            try:
                contents = value.cell_contents
            except ValueError:
                return code.cell, ()
            return code.cell, (), (contents,), None, None, code.fill
        if type(value) is np.ndarray and not value.dtype.hasobject and value.dtype.names is None:
            return _array, (value.shape, value.dtype.str, value.tobytes())
        if isinstance(value, memoryview):
            whole: Any = value.obj
            return _view, (whole if whole.base is None else whole.base,)
        return NotImplemented

    @staticmethod
    def _named(value: FunctionType) -> Any:
        module, name = value.__module__, value.__qualname__
        if not admitted.is_class_or_helper(value, module.removeprefix(PACKAGE), name):
            raise SnapshotError(
                f"{module}.{name} has no business in a snapshot (scenarios/lab/snapshot/admitted.py)"
            )
        return NotImplemented

    @staticmethod
    def _function(value: FunctionType) -> Any:
        try:
            module, number = code.place(value)
        except ValueError:
            name = f"{value.__module__}.{value.__qualname__}"
            raise SnapshotError(f"{name} was made outside the sources: no snapshot can hold it") from None
        state = (value.__defaults__, value.__kwdefaults__, dict(value.__dict__), value.__qualname__)
        return code.function, (module, number, value.__closure__ or ()), state, None, None, code.finish


class _Unpickler(pickle.Unpickler):
    def __init__(self, file: io.BytesIO, outside: Mapping[str, Any], refused: tuple[str, ...]) -> None:
        super().__init__(file)
        self._outside = outside
        self._refused = refused

    def persistent_load(self, name: Any) -> Any:
        if name == _NO_NETWORK:
            return import_module(_CANOPEN)._UNINITIALIZED_NETWORK
        if name not in self._outside:
            raise SnapshotError(f"snapshot: it wants {name!r}, which is not here")
        return self._outside[name]

    def find_class(self, module: str, name: str) -> Any:
        if module.startswith(self._refused):
            raise SnapshotError(f"snapshot: {module}.{name} is in it")
        found = super().find_class(module, name) if admitted.may_be_named(module, name) else None
        if (module, name) == ("builtins", "getattr"):
            return _method
        if (module, name) == (code.__name__, code.function.__name__):
            return _function
        if found is None or not admitted.is_class_or_helper(found, module.removeprefix(PACKAGE), name):
            raise SnapshotError(f"snapshot: {module}.{name} has no business in one")
        return found


def take(what: Any, outside: Mapping[str, Any] | None = None, outsiders: tuple[type, ...] = ()) -> bytes:
    """Everything that can be reached from `what`, between two slices of simulated time.

    outside: what is not taken, by name. outsiders: classes whose objects are not taken either; there will be
    nobody in their place. Raises SnapshotError, also when the compiled library is in use: its instances
    cannot be taken apart. SCHMIDT_PURE=1 runs the same source plain, to the same bits.
    """
    if compiled():
        raise SnapshotError(_PLAIN)
    file = io.BytesIO()
    try:
        _Pickler(file, outside or {}, outsiders).dump(what)
    except (TypeError, AttributeError, pickle.PicklingError) as error:
        raise SnapshotError(f"snapshot: {error}") from None
    return _MAGIC + source_digest().encode() + b"\n" + file.getvalue()


def restore(data: bytes, outside: Mapping[str, Any] | None = None, refused: tuple[str, ...] = ()) -> Any:
    """What was taken, on its own.

    refused: modules that must not be in it. Raises SnapshotError for bytes that are no snapshot, or one of
    other sources.
    """
    if not data.startswith(_MAGIC):
        raise SnapshotError("this is no snapshot of schmidt's")
    digest, _, body = data[len(_MAGIC) :].partition(b"\n")
    if digest.decode(errors="replace") != source_digest():
        raise SnapshotError("snapshot: made by other sources than these; run the scenario again instead")
    if compiled():
        raise SnapshotError(_PLAIN)
    try:
        return _Unpickler(io.BytesIO(body), outside or {}, refused).load()
    except SnapshotError:
        raise
    except FirmwareError as error:
        raise SnapshotError(f"snapshot: {error}") from None
    except Exception:  # a pickle that was cut or changed raises nearly anything
        raise SnapshotError("snapshot: damaged; take it again") from None
