"""The four ASCII logs (H6): user commands, device status, sensor data, errors."""

from collections.abc import Callable
from pathlib import Path

from host.logs.files import LineFile

NAMES = ("commands", "status", "sensors", "errors")
_HEADERS = {
    "commands": "# utc  t_s  node  command  result",
    "status": "# utc  t_s  device  status",
    "sensors": "# utc  t_s  sensor=value …",
    "errors": "# utc  t_s  where  what",
}


class AsciiLogs:
    """Four files in one folder; every line starts with UTC and the simulated time in seconds."""

    def __init__(
        self, folder: Path, utc: Callable[[float], str], make: Callable[[Path], LineFile] | None = None
    ) -> None:
        """utc: text for a time in s. make: opens one file, such as `rotation.rotating`; None: one that
        grows."""
        self._utc = utc
        make = make or _growing
        self._files = {name: make(folder / f"{name}.log") for name in NAMES}
        for name, file in self._files.items():
            file.write(_HEADERS[name] + "\n")

    def command(self, t_ns: int, node: str, text: str, result: str) -> None:
        """A command of the user and what came of it."""
        self._write("commands", t_ns, f"{node}  {text}  {result}")

    def status(self, t_ns: int, device: str, text: str) -> None:
        """What a device says about itself, or what the programme is doing."""
        self._write("status", t_ns, f"{device}  {text}")

    def sensors(self, t_ns: int, text: str) -> None:
        """A line of readings."""
        self._write("sensors", t_ns, text)

    def error(self, t_ns: int, where: str, text: str) -> None:
        """Something that went wrong."""
        self._write("errors", t_ns, f"{where}  {text}")

    @property
    def error_entries(self) -> int:
        """Lines in the error log so far, without its header."""
        return self._files["errors"].lines - 1

    def files(self) -> list[LineFile]:
        """The four files."""
        return list(self._files.values())

    def close(self) -> None:
        """Bring all four to disk and close them."""
        for file in self._files.values():
            file.close()

    def flush(self) -> None:
        """Bring all four to disk."""
        for file in self._files.values():
            file.flush()

    def _write(self, name: str, t_ns: int, text: str) -> None:
        t_s = t_ns / 1e9
        self._files[name].write(f"{self._utc(t_s)}  {t_s:.3f}  {text}\n")


def _growing(path: Path) -> LineFile:
    return LineFile(path, buffer_bytes=1 << 13)
