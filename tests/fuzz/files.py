"""Attacks on readers of files: candump logs, axis logs, guide logs."""

import math
import tempfile
from collections.abc import Callable
from functools import partial
from math import isfinite
from pathlib import Path
from random import Random

from bus.can.candump import line
from bus.can.frame import check
from calibration.errors import CalibrationInputError
from calibration.inputs.logs import read_drive
from calibration.inputs.run import Run
from scenarios.lab.muted import read
from tests.calibration.logs import tiny_log
from tests.calibration.test_readers import GUIDE
from tests.fuzz import near
from tests.fuzz.inputs import MEMORY
from tests.fuzz.left import counted

Found = dict[str, int]


def _candump(path: Path, text: bytes) -> None:
    """A frame that is read is one CAN can carry, and writes the line it was read from."""
    frames = list(read(path))
    lines = [each for each in text.decode("ascii", "replace").splitlines() if not _is_error(each)]
    for logged, given in zip(frames, lines, strict=True):
        check(logged.frame)
        stamp, _, body = given.split(" ")
        again = line(logged.t_ns, logged.frame).split(" ")
        if again[2] != body + ("0" if body.endswith("R") else ""):
            raise AssertionError(f"{given!r} was read as {again!r}")
        if float(stamp[1:-1]) != float(again[0][1:-1]):
            raise AssertionError(f"{given!r} was read as {again!r}")


def _is_error(text: str) -> bool:
    """An error frame: no frame of any board, passed over."""
    name = text.split(" ")[2].split("#")[0]
    return len(name) == 8 and bool(int(name, 16) & 0x2000_0000)


def _axis(path: Path, text: bytes) -> None:
    """Rows that are read are the rows of the file, number by number."""
    (run,) = read_drive([path], None).runs
    lines = text.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    start = next(k for k, each in enumerate(lines) if each.strip() and not each.startswith("#"))
    names = [name.strip().strip('"') for name in lines[start].split(",")]
    rows = [each.split(",") for each in lines[start + 1 :] if each.strip()]
    if rows and (len(rows[-1]) != len(names) or not rows[-1][0].strip()):
        rows.pop()  # cut off while it was written
    for name, values in run.raw.items():
        told = [_number(row[names.index(name)]) for row in rows]
        same = [a == b or (math.isnan(a) and math.isnan(b)) for a, b in zip(told, values, strict=True)]
        if not all(same):
            raise AssertionError(f"column {name} was changed")
    _finite(run)


def _number(field: str) -> float:
    """A field's number by the format's grammar: plain decimals, nothing, or nan."""
    field = field.strip().strip('"').strip()
    if not field or field in ("nan", "NaN"):
        return math.nan
    if not set(field) <= set("0123456789+-.eE"):
        raise AssertionError(f"{field!r} was taken for a number")
    return float(field)


def _finite(run: Run) -> None:
    for name, values in run.columns.items():
        if len(values) != run.rows or any(map(math.isinf, values.tolist())):
            raise AssertionError(f"column {name}: {len(values)} values of {run.rows}, or infinite ones")


def _guide(path: Path, _text: bytes) -> None:
    """Sections whose columns are as long as each other, and a start that can be asked for."""
    for run in read_drive([path], None).runs:
        _finite(run)
        assert run.start_s is None or isfinite(run.start_s)


def _files(
    what: Callable[[Path, bytes], None], make: Callable[[Random], bytes], count: int, random: Random
) -> Found:
    found = {"accepted": 0, "refused": 0}
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        path = Path(folder) / "x.log"
        for _ in counted(count):
            text = make(random)
            path.write_bytes(text)
            try:
                what(path, text)
                found["accepted"] += 1
            except (CalibrationInputError, ValueError) as error:
                if "\n" in str(error) or not str(error).startswith(str(path)):
                    raise AssertionError(f"a refusal of its own kind: {str(error)!r}") from None
                found["refused"] += 1
    return found


candump = partial(_files, _candump, near.candump)
axis_logs = partial(_files, _axis, lambda random: near.mangled(random, tiny_log(8), near.AXIS_PIECES))
guide_logs = partial(_files, _guide, lambda random: near.mangled(random, GUIDE, near.GUIDE_PIECES))
