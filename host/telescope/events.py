"""The night as an observer would write it down: what has changed, in words. The wire has its own log."""

from collections import deque
from collections.abc import Iterable

from bus.protocol.nodes import DOME, WEATHER
from host.telescope.alarms import Alarm
from host.telescope.jobs import Activity
from host.telescope.state import Snapshot
from host.telescope.telescope import Telescope

KEPT = 300
"""Events kept for the pages: some hours of a busy night. ASSUMPTION."""
_TELL = ("HOST", "FOCUS", "LX200")
"""Who says in the journal why something was not done; boards' answers are the wire's."""


class Events:
    """kept: (t_s, words), oldest first. Looks at the telescope, and tells what is not as it was."""

    def __init__(self) -> None:
        self.kept: deque[tuple[float, str]] = deque(maxlen=KEPT)
        self._was: dict[str, str] = {}
        self._told = 0

    def take(self, telescope: Telescope, alarms: Iterable[Alarm]) -> None:
        """What is the case now."""
        t_s = telescope.snapshot.t_s
        states = of_telescope(telescope)
        states |= {
            alarm.what: f"{alarm.severity.name}: {alarm.what}" for alarm in alarms if not alarm.until_s
        }
        self.kept.extend((t_s, text) for key, text in states.items() if self._was.get(key) != text)
        self.kept.extend((t_s, f"Over: {key}") for key in self._was if key not in states)
        self._was = states
        for entry in telescope.journal.since(self._told):
            self._told = entry.number
            if entry.kind == "error" and entry.where.startswith(_TELL):
                self.kept.append((entry.t_s, f"Not done: {entry.text}"))


def of_telescope(telescope: Telescope) -> dict[str, str]:
    """What is the case, by subject."""
    now, house = telescope.snapshot, telescope.house
    found = {
        "motors": "Motors on" if now.powered else "Motors off", "axes": _axes(now),
        "lock": "Consoles locked" if now.locked else "Consoles unlocked",
    }  # fmt: skip
    if (focus := now.focus) is not None:
        found["focus"] = "Focus moves" if focus.moving else f"Focus at {focus.half_steps:+d} half steps"
    dome = house.reading("DOME") if house.boards(DOME) else None
    if dome is not None:
        ends = "open" if dome["Opened"] else "closed" if dome["Closed"] else "between its ends"
        found["shutter"] = "Shutter moves" if dome["ShutterMoving"] else f"Shutter {ends}"
        found["slaved"] = "Dome follows the telescope" if house.slaved else "Dome stays where it is"
    if house.expected(WEATHER):
        found["weather"] = (
            f"Weather unsafe: {'; '.join(house.unsafe())}" if house.unsafe() else "Weather safe"
        )
    return found


def _axes(now: Snapshot) -> str:
    if now.parked:
        return "Parked"
    going = now.activity in (Activity.SLEWING.value, Activity.TRACKING.value)
    return now.activity.capitalize() + (f" {now.target}" if going and now.target not in ("", "here") else "")
