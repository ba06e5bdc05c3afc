"""Broken files of every kind that a user writes: one value put wrong in each of the project's own."""

import copy
import math
import random
import re
import shutil
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple, NoReturn

import yaml

from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from plant.model import load
from scenarios.campaign.plan import load as load_campaign
from scenarios.lab.prepare import prepare
from scenarios.lab.wiring import wire

ROOT = Path(__file__).parents[2]
WRONG: tuple[Any, ...] = (
    math.nan, math.inf, -1, 0, 10**400, -1e300, 1e-320, True, None, "", "x", "1 s", "-1 s", "nan s",
    "1e400 s", "5 parsec", "1e-320 s", "2026-13-01T00:00:00Z", "99:99:99", "é\0", [], [[]], {}, {"a": 1},
    {"value": 1, "unit": "parsec"},
)  # fmt: skip
CELLS = ("nan", "inf", "-1", "1e400", "1e150", "1e200", "", "x", "0x10", "é", "\0", "1;2", '"', "9" * 400)
"""Put into a table's cell."""
_LINES = ("", "#", ",,,,", "# format: axis-log 1", "a,b,c", "\x00\x01\x02", "," * 5000)
"""Put in a table's line's place."""
_HUNG_S = 20.0
"""By the wall, beside other work; the slowest of them takes a second."""
_VAGUE = re.compile(r"\n|cannot convert|must be in|did not converge|math domain|Result too large")
"""What no user can do anything with."""


class Hung(BaseException):
    """Took longer than any input may."""


class Case(NamedTuple):
    """what: the change, for whoever repeats it. text: makes the file's."""

    what: str
    text: Callable[[], bytes]


class Kind(NamedTuple):
    """files: what is made wrong. use: reads one and builds what it says."""

    files: list[Path]
    use: Callable[[Path], object]
    broken: Callable[[Path], Iterator[Case]]


def _places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    pairs = (
        value.items() if isinstance(value, dict) else enumerate(value[:3]) if isinstance(value, list) else ()
    )
    for key, inner in pairs:
        yield (*place, key)
        yield from _places(inner, (*place, key))


def documents(file: Path) -> Iterator[Case]:
    """Every value of a YAML file, replaced by each of WRONG."""
    whole = yaml.safe_load(file.read_text(encoding="utf-8"))
    for place in _places(whole):
        for wrong in WRONG:
            yield Case(f"{file.name}: {place} = {str(wrong)[:30]!r}", partial(_with, whole, place, wrong))


def _with(whole: Any, place: tuple[Any, ...], wrong: Any) -> bytes:
    changed = copy.deepcopy(whole)
    inner = changed
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = wrong
    return yaml.safe_dump(changed, allow_unicode=True).encode()


def tables(file: Path) -> Iterator[Case]:
    """Cells and lines of a log's beginning, replaced; and cut anywhere."""
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()[:400]
    for row in (0, 1, 2, 3, 6, 10, 20, 60, len(lines) - 1):
        for k, _ in enumerate(lines[row].split(",")[:8]):
            for wrong in CELLS:
                cells = lines[row].split(",")
                cells[k] = wrong
                text = "\n".join([*lines[:row], ",".join(cells), *lines[row + 1 :]])
                yield Case(f"{file.name}: row {row}, column {k} = {wrong[:20]!r}", text.encode)
        for wrong in _LINES:
            text = "\n".join([*lines[:row], wrong, *lines[row + 1 :]])
            yield Case(f"{file.name}: row {row} = {wrong[:20]!r}", text.encode)
    whole = "\n".join(lines).encode()
    for end in range(0, len(whole), max(len(whole) // 20, 1)):
        yield Case(f"{file.name}: {end} bytes", partial(bytes, whole[:end]))


KINDS: dict[str, Kind] = {
    "scenario": Kind(sorted(ROOT.glob("scenarios/*.yaml")), lambda file: wire(*prepare(file)), documents),
    "rig": Kind(sorted(ROOT.glob("calibration/rigs/*.yaml")), load_rig, documents),
    "plant": Kind(sorted(ROOT.glob("plant/files/*.yaml")), load, documents),
    "campaign": Kind([ROOT / "scenarios/campaigns/what-fails-first.yaml"], load_campaign, documents),
    "log": Kind(sorted(ROOT.glob("docs/example/*.csv")), lambda file: read_drive([file], None), tables),
}


def try_all(kind: str, count: int, seed: int, folder: Path) -> tuple[Counter[str], list[str]]:
    """So many of a kind at random: how many were accepted or refused in one line, and what neither was."""
    files, use, broken = KINDS[kind]
    cases = [case for file in files for case in broken(file)]
    for beside in ROOT.glob("scenarios/campaigns/short*.yaml"):  # the other campaign's scenario
        shutil.copy(beside, folder)
    file = folder / f"broken{files[0].suffix}"
    told: Counter[str] = Counter()
    wrong: list[str] = []

    def late(_signal: int, _frame: FrameType | None) -> NoReturn:
        raise Hung

    before = signal.signal(signal.SIGALRM, late)
    try:
        for case in random.Random(seed).sample(cases, min(count, len(cases))):
            file.write_bytes(case.text())
            signal.setitimer(signal.ITIMER_REAL, _HUNG_S)
            try:
                use(file)
                told["accepted"] += 1
            except (ValueError, OSError) as error:
                told["refused"] += 1
                if _VAGUE.search(str(error)):
                    wrong.append(f"vague: {case.what}: {error}")
            except Hung:
                wrong.append(f"hung: {case.what}")
            except Exception as error:
                wrong.append(f"internal error: {case.what}: {type(error).__name__}: {error}"[:300])
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
    finally:
        signal.signal(signal.SIGALRM, before)
    return told, wrong


if __name__ == "__main__":
    import sys
    import tempfile

    for name in sys.argv[3:] or KINDS:
        with tempfile.TemporaryDirectory() as made:
            counts, found = try_all(name, int(sys.argv[1]), int(sys.argv[2]), Path(made))
        print(name, dict(counts), len(found), *found, sep="\n  ")
