"""Where PHD2 told the star to be: dithers and new lock positions of a section."""

from __future__ import annotations

import re
from bisect import bisect_left
from dataclasses import dataclass
from math import hypot

_PX = r"([+-]?(?:[0-9]{1,9}(?:\.[0-9]*)?|\.[0-9]+))(?![0-9.])"
_DITHER = re.compile(rf"DITHER by {_PX}, {_PX}")
_LOCK = re.compile(rf"[Ll]ock pos(?:ition)?\s*=\s*{_PX}, {_PX}")
SAME_PX = 0.01  # a lock position that is written again, to PHD2's last digits


@dataclass(frozen=True)
class Moves:
    """Where the star was told to be: dithers so far (px along the axes), jumps of unknown size; by line."""

    lines: list[int]
    ra: list[float]
    dec: list[float]
    jumps: list[int]

    def before(self, line: int) -> tuple[float, float, int]:
        """Sums of all dithers above this line, and how many jumps there were."""
        k = bisect_left(self.lines, line)
        return (self.ra[k - 1], self.dec[k - 1], self.jumps[k - 1]) if k else (0.0, 0.0, 0)


def moves_of(head: str, events: list[tuple[int, str]]) -> Moves:
    """Dithers and new lock positions of one section; PHD2 writes the old lock position before a dither."""
    at = _LOCK.search(head)
    lock = (float(at[1]), float(at[2])) if at else None
    moves = Moves([], [], [], [])
    ra = dec = 0.0
    jumps = 0
    for line, event in events:
        dither, new = _DITHER.search(event), _LOCK.search(event)
        if not dither and not ("SET LOCK" in event or "DITHER" in event):
            continue
        place = (float(new[1]), float(new[2])) if new else None
        if dither:
            ra, dec = ra + float(dither[1]), dec + float(dither[2])
        elif place is None or lock is None or hypot(place[0] - lock[0], place[1] - lock[1]) > SAME_PX:
            jumps += 1
        lock = place or lock
        moves.lines.append(line)
        moves.ra.append(ra)
        moves.dec.append(dec)
        moves.jumps.append(jumps)
    return moves
