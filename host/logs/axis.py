"""The axis log, version 1: what an axis board sends over RS232, one row per 10 ms sample."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from bus.protocol.serial import NO_SETPOINT, SAMPLE_NS, STAMP_UNIT_NS, AxisSample, Packet
from host.logs.files import LineFile
from host.rates import COUNT_ARCSEC, LOOP_S

COLUMNS: Final = (
    "t",
    "setpoint",
    "effort",
    "position",
    "velocity",
    "adc_a",
    "adc_b",
    "tach_a",
    "tach_b",
    "aux",
)
REQUIRED: Final = ("axis", "session", "loop", "start_utc")
OPTIONAL: Final = ("preload", "counter_torque", "supply_V", "temperature_C", "note")
KEYS: Final = REQUIRED + OPTIONAL
_SETPOINT_ARCSEC_S: Final = COUNT_ARCSEC / LOOP_S / 65536
_STAMP_S: Final = STAMP_UNIT_NS * 1e-9
_SAMPLE_S: Final = SAMPLE_NS * 1e-9
_LINE: Final = "%.6f,%.6f" + 8 * ",%d" + "\n"
_OPEN_LINE: Final = "%.6f," + 8 * ",%d" + "\n"
_WRAP: Final = 1 << 32

Row = tuple[float, AxisSample]
"""Board time in seconds and its sample."""
Numbers = tuple[float, tuple[int, ...]]
"""The same without the names of the columns."""
Distortion = Callable[[list[Row]], list[Row]]
"""What a log effect makes of the rows of one packet."""


class AxisLog:
    """One axis' log file. header: values of the format's keys; unknown keys and missing ones are refused."""

    def __init__(self, path: Path, header: dict[str, str], distort: Distortion | None = None) -> None:
        missing = [key for key in REQUIRED if key not in header]
        unknown = [key for key in header if key not in KEYS]
        if missing or unknown:
            raise ValueError(f"axis log header: missing {missing}, unknown {unknown}")
        self.rows = 0
        self.file = LineFile(path)
        self._distort = distort
        self._turns = 0
        self._last_stamp = -1
        lines = ["# format: axis-log 1", f"# axis: {header['axis']}", "# sample_period_s: 0.010"]
        lines += [f"# {key}: {header[key]}" for key in KEYS[1:] if key in header]
        self.file.write("\n".join([*lines, ",".join(COLUMNS), ""]))

    def packet(self, _t_ns: int, packet: Packet) -> None:
        """Append the 25 samples of a packet; the board's stamp is carried over its wrap."""
        if packet.stamp < self._last_stamp - _WRAP // 2:
            self._turns += 1
        self._last_stamp = packet.stamp
        start = (packet.stamp + self._turns * _WRAP) * _STAMP_S
        rows: list[Numbers] = [(start + index * _SAMPLE_S, row) for index, row in enumerate(packet.rows)]
        if self._distort is not None:
            rows = [*self._distort([(t, AxisSample(*row)) for t, row in rows])]
        self.rows += len(rows)
        if rows:
            self.file.write(_lines(rows))


def _lines(rows: list[Numbers]) -> str:
    """The rows of a packet as text. In one piece: there are two hundred rows a second."""
    lines = []
    for t, sample in rows:
        setpoint = sample[8]
        if setpoint == NO_SETPOINT:
            lines.append(_OPEN_LINE % (t, *sample[:8]))
        else:
            lines.append(_LINE % (t, setpoint * _SETPOINT_ARCSEC_S, *sample[:8]))
    return "".join(lines)
