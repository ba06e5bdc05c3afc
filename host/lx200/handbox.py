"""What an LX200 remembers besides the telescope: local time, frequency, site names."""

import datetime as dt

from host.sky.observed import Clock
from host.telescope import DriveRate

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
