"""`python -m tests.coverage`: lines that the tests executed, by room, lowest share first (`make coverage`).

Kernels that numba compiles count as not executed: the interpreter never sees their lines.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import coverage

ROOT = Path(__file__).parents[1]
ROOMS = 20
"""Rooms printed; the whole list is longer than a screen."""


def room(path: PurePosixPath) -> str:
    """Room of a file, by its path in the repository: the first two folders."""
    return "/".join(path.parent.parts[:2])


def by_room(data: coverage.Coverage) -> dict[str, tuple[int, int]]:
    """Room to its lines and those of them that no test executed."""
    counts: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for file in data.get_data().measured_files():
        _, lines, _, missed, _ = data.analysis2(file)
        count = counts[room(PurePosixPath(Path(file).relative_to(ROOT).as_posix()))]
        count[0] += len(lines)
        count[1] += len(missed)
    return {name: (lines, missed) for name, (lines, missed) in counts.items()}


def table(rooms: dict[str, tuple[int, int]], most: int = ROOMS) -> str:
    """Rooms with the lowest share first, and the whole."""
    share = {name: 1 - missed / max(1, lines) for name, (lines, missed) in rooms.items()}
    rows = [
        f"{share[name]:6.1%}  {missed:5d} of {lines:5d} lines not executed  {name}"
        for name, (lines, missed) in sorted(rooms.items(), key=lambda item: share[item[0]])[:most]
    ]
    lines, missed = (sum(count[i] for count in rooms.values()) for i in (0, 1))
    return "\n".join(
        [*rows, f"{1 - missed / max(1, lines):6.1%}  {missed:5d} of {lines:5d} lines not executed  in all"]
    )


def main() -> int:
    """Print the table from the data of the last run."""
    import coverage

    data = coverage.Coverage(config_file=str(ROOT / "pyproject.toml"))
    data.load()
    rooms = by_room(data)
    if not rooms:
        print("no coverage data; run make coverage")
        return 1
    print(table(rooms))
    return 0


if __name__ == "__main__":
    sys.exit(main())
