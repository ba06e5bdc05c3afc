"""One LX200 client: its target, its key speed and its precision. Commands in, answers out.

Bytes become commands however they were cut: split, joined, doubled, with rubbish between them.
"""

import datetime as dt
import re
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass
from typing import Any

from bus.protocol import SpeedClass
from host.sky.observed import Clock, Place
from host.telescope import AsyncDesk, DriveRate, Refused, Snapshot, Telescope

FREQUENCIES = {DriveRate.SIDEREAL: 60.1, DriveRate.SOLAR: 60.0, DriveRate.LUNAR: 57.9, DriveRate.KING: 60.1}
"""Hz, as Meade's manual gives them; the drive's own rates are DriveRate's."""
UTC_OFFSET_H = -5.5
"""Hours to add to local time for UTC: India, where the telescope stands."""


class Handbox:
    """Clock and site of the hand box.

    A client may set the time. It is kept and read back, running on. The sky stays the telescope's own
    (its clock is the emulation's, or the PC's), and so does where it points.
    """

    def __init__(self, clock: Clock, site_name: str) -> None:
        self.precise = True
        """As the last `:U#` of any client left it: what the next one begins with."""
        self.utc_offset_h = UTC_OFFSET_H
        self.frequency_hz = FREQUENCIES[DriveRate.SIDEREAL]
        self.site_names = [site_name, "Site 2", "Site 3", "Site 4"]
        self._clock = clock
        self._local_ahead = dt.timedelta(hours=-UTC_OFFSET_H)

    def local(self, t_s: float) -> dt.datetime:
        """Local date and time at a time of the telescope."""
        return self._utc(t_s) + self._local_ahead

    def set_time(self, t_s: float, time: dt.time) -> None:
        """It is this time of the day."""
        self._local_ahead = dt.datetime.combine(self.local(t_s).date(), time) - self._utc(t_s)

    def set_date(self, t_s: float, date: dt.date) -> None:
        """It is this day."""
        self._local_ahead = dt.datetime.combine(date, self.local(t_s).time()) - self._utc(t_s)

    def _utc(self, t_s: float) -> dt.datetime:
        start = self._clock.start_utc.astimezone(dt.UTC).replace(tzinfo=None)
        return start + dt.timedelta(seconds=t_s)


ACK = "\x06"
"""Asks for the alignment mode; a command of one byte."""
_LONGEST = 40
"""Longest command kept, in characters: `:SM` with a site's name is the longest there is."""


_COMMAND = re.compile(f"{ACK}|:((?:(?!:[A-Za-z])[^#{ACK}]){{1,{_LONGEST}}})#")


class Parser:
    """Fed byte by byte or whole, the commands are the same.

    A command is what stands between `:` and `#`, as Latin-1 text (the degree sign is 0xDF). What stands
    outside is dropped. A colon and a letter begin a command anew, since within one a colon is followed by a
    digit. A command that was torn off costs itself only.
    """

    def __init__(self) -> None:
        self._rest = ""

    def feed(self, data: bytes) -> list[str]:
        """Commands that became complete, without `:` and `#`; `ACK` for the byte 0x06."""
        text, commands, end = self._rest + data.decode("latin-1"), [], 0
        for found in _COMMAND.finditer(text):
            commands.append(found[1] or ACK)
            end = found.end()
        self._rest = text[end:][-_LONGEST - 1 :]
        return commands


Handler = Callable[["Session", str], Coroutine[Any, Any, str]]


@dataclass(eq=False)
class Session:
    """What belongs to one client, so that two at once do not get into each other's way.

    plain: handlers of commands that are these letters and nothing else. taking: handlers by the letters
    before an argument. unknown: commands nobody knows, so far.
    """

    desk: AsyncDesk
    box: Handbox
    plain: Mapping[str, Handler]
    taking: Mapping[str, Handler]
    name: str
    speed: SpeedClass = SpeedClass.SLEW
    focus_slow: bool = False
    target_ra_rad: float | None = None
    target_dec_rad: float | None = None
    target_az_rad: float | None = None
    target_alt_rad: float | None = None
    unknown: int = 0

    def __post_init__(self) -> None:
        self.precise = self.box.precise
        self._parser = Parser()

    async def feed(self, data: bytes) -> bytes:
        """Answers to what became complete with these bytes, in one piece; empty where there is none."""
        answers = [await self.answer(command) for command in self._parser.feed(data)]
        return "".join(answers).encode("latin-1", "replace")

    async def answer(self, command: str) -> str:
        """Carry out one command; what cannot be answered yet has no answer, and a line in the error log."""
        try:
            return await self._carry_out(command)
        except Refused as refusal:
            self.say(str(refusal))
            return ""

    async def _carry_out(self, command: str) -> str:
        if command == ACK:
            return "P"
        if command in self.plain:
            return await self.plain[command](self, "")
        for length in (2, 1):
            if command[:length] in self.taking:
                return await self.taking[command[:length]](self, command[length:])
        self.unknown += 1
        return ""

    # --- what handlers use ---
    @property
    def now(self) -> Snapshot:
        """The telescope at the last tick."""
        return self.desk.now

    @property
    def telescope(self) -> Telescope:
        """For what may be read from any thread."""
        return self.desk.telescope

    def target(self) -> Place:
        """What `:Sr` and `:Sd` have set; raises ValueError before both were."""
        if self.target_ra_rad is None or self.target_dec_rad is None:
            raise ValueError("no target has been set")
        return Place(self.target_ra_rad, self.target_dec_rad)

    async def act(self, act: Callable[[Telescope], object]) -> Refused | None:
        """A command; its refusal goes into the log, too, as many have no answer."""
        try:
            await self.desk.do(act)
        except Refused as refusal:
            self.say(str(refusal))
            return refusal
        return None

    def say(self, text: str) -> None:
        """A line in the error log."""
        now_ns = round(self.now.t_s * 1e9)
        self.telescope.call(lambda t: t.journal.error(now_ns, f"LX200 {self.name}", text))
