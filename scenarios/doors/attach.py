"""How one attaches to each door: the words that `schmidt serve` prints, and the TCP ports it takes."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from scenarios.doors.address import AddressError, address
from scenarios.doors.options import OptionError
from scenarios.doors.table import ON_HOST, ON_NETWORK, DoorKind


class Attached(NamedTuple):
    """words: what to do to attach. host, ports: of a door on TCP."""

    words: str
    host: str = ""
    ports: range = range(0)


def attached(name: str, boards: Sequence[str]) -> Attached:
    """By a door's name, such as `--serial tcp:7000`. boards: those with an RS232 line, in their order."""
    option, _, spec = name.partition(" (")[0].partition(" ")  # without what the door has added
    word, _, rest = spec.partition(":")
    kinds: tuple[DoorKind[Any], ...] = (*ON_NETWORK, *ON_HOST)
    forms = next(kind.attach for kind in kinds if f"--{kind.name}" == option)
    form = forms.get(word, forms.get("", "{spec}"))
    given = {"spec": spec, "word": word, "rest": rest}
    if "{at}" not in form:
        return Attached(form.format(**given, lines=", ".join(f"{rest}/{board}" for board in boards)))
    several = "{last}" in form
    count = len(boards) if several else 1
    try:
        host, port = address(rest if several else spec, option, count)
    except AddressError:  # reported by the door itself
        return Attached(spec)
    at = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
    last = f"port {port + count - 1}, {boards[-1]}"
    return Attached(form.format(**given, at=at, first=boards[0], last=last), host, range(port, port + count))


def check_ports(names: Sequence[str], boards: Sequence[str]) -> None:
    """Raise OptionError for two doors that want one TCP port."""
    taken: dict[tuple[str, int], str] = {}
    for name in names:
        _, host, ports = attached(name, boards)
        for port in ports:
            other = taken.setdefault((host, port), name)
            if other != name:
                last = attached(other, boards).ports[-1]
                raise OptionError(f"{name}: {other} takes the ports up to {last}; give one of them another")
