"""What is wrong, how badly, since when; and the night as an observer would write it down."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final

from bus.protocol import FocusFlag, State
from bus.protocol.nodes import DOME, WEATHER
from host.client import SILENCE_NS
from host.telescope.house import House
from host.telescope.jobs import Activity
from host.telescope.state import Snapshot
from host.telescope.telescope import Telescope

SILENCE_S: Final = SILENCE_NS * 1e-9
_DISTURBED: Final = 96
_PASSIVE: Final = 128
"""Transmit error counters: heavily disturbed (CAN 2.0, part A, section 7), passive (ISO 11898-1)."""
_BUSY: Final = 0.5
_FULL: Final = 0.9
"""Shares of the last second. The lab's network needs a fifth of 1 Mbit/s. ASSUMPTION."""


class Severity(IntEnum):
    """warning: look at it before long. alarm: look at it now."""

    WARNING = 1
    ALARM = 2


@dataclass(frozen=True, slots=True)
class Alarm:
    """since_s: when it came, simulated seconds. until_s: when it went, None while it stands."""

    what: str
    severity: Severity
    since_s: float
    until_s: float | None = None
    acknowledged: bool = False


class Alarms:
    """standing: by what they say, the worst and then the newest first."""

    def __init__(self) -> None:
        self._known: dict[str, Alarm] = {}
        self._overruns: dict[str, int] = {}

    @property
    def standing(self) -> tuple[Alarm, ...]:
        """What has not gone and been acknowledged."""
        return tuple(sorted(self._known.values(), key=lambda alarm: (-alarm.severity, -alarm.since_s)))

    def take(self, t_s: float, found: Mapping[str, Severity]) -> None:
        """What is wrong at `t_s`."""
        for what, severity in found.items():
            known = self._known.get(what)
            if known is None or known.until_s is not None:
                self._known[what] = Alarm(what, severity, t_s)
            elif known.severity != severity:  # worse is news again
                seen = known.acknowledged and severity < known.severity
                self._known[what] = replace(known, severity=severity, acknowledged=seen)
        for what, known in list(self._known.items()):
            if what in found:
                continue
            if known.acknowledged:
                del self._known[what]
            elif known.until_s is None:
                self._known[what] = replace(known, until_s=t_s)

    def acknowledge(self) -> None:
        """Somebody has seen them all: what has gone goes."""
        self._known = {
            what: replace(alarm, acknowledged=True)
            for what, alarm in self._known.items()
            if alarm.until_s is None
        }

    def of_telescope(self, now: Snapshot) -> dict[str, Severity]:
        """What a snapshot shows."""
        found: dict[str, Severity] = {}
        for name, axis in (("RA", now.ra), ("Dec", now.dec)):
            if axis.fault:
                found[f"{name}: FAULT, the motors are off"] = Severity.ALARM
            if axis.soft_limit:
                found[f"{name} is at its soft limit"] = Severity.WARNING
        for device in now.stale:
            found[f"{device.name}: no measurement"] = Severity.ALARM
        for board in now.boards:
            name = board.device.name
            if not board.alive:
                if now.t_s > SILENCE_S:  # heartbeats come every second
                    found[f"{name} is silent"] = Severity.ALARM
                continue
            if board.state == State.FAULT:
                found[f"{name}: FAULT"] = Severity.ALARM
            if board.tec > _DISTURBED:
                passive = board.tec >= _PASSIVE
                found[f"{name}: errors on the bus"] = Severity.ALARM if passive else Severity.WARNING
            if board.overruns > self._overruns.setdefault(name, board.overruns):
                found[f"{name} loses interrupts"] = Severity.WARNING
            self._overruns[name] = board.overruns
        return found


def of_bus(load: float, running: list[tuple[int, str]]) -> dict[str, Severity]:
    """What the bus shows: its load in the last second, faults that somebody has made."""
    found = {}
    if load >= _BUSY:
        found["the bus is loaded"] = Severity.ALARM if load >= _FULL else Severity.WARNING
    for number, words in running:
        found[f"fault {number} runs: {words.partition(',')[0]}"] = Severity.WARNING
    return found


def of_house(house: House) -> dict[str, Severity]:
    """What the weather does to a dome: an alarm while the shutter is not shut."""
    dome = house.reading("DOME")
    opened = dome is not None and not dome["Closed"]
    return dict.fromkeys(house.unsafe(), Severity.ALARM if opened else Severity.WARNING)


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
        found["focus"] = (
            "Focus moves" if focus.flags & FocusFlag.MOVING else f"Focus at {focus.position:+d} half steps"
        )
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
