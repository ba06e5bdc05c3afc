"""How one attaches to each door: the words or the URL that `schmidt serve` prints."""

from collections.abc import Sequence

from scenarios.doors.address import AddressError, address
from scenarios.doors.options import OptionError

_WEB = {"--console": "open {url}", "--alpaca": "ASCOM Alpaca at {url}"}


def ports(name: str, lines: int) -> tuple[str, range]:
    """Host and TCP ports of a door by its name, such as `--serial tcp:7000`. lines: RS232 lines there are."""
    option, _, spec = name.partition(" ")
    kind, _, rest = spec.partition(":")
    several = option == "--serial" and kind in ("tcp", "rfc2217")
    if not several and option not in (*_WEB, "--lx200", "--control"):
        return "", range(0)
    count = lines if several else 1
    try:
        host, port = address(rest if several else spec, option, count)
    except AddressError:  # a pseudo-terminal, or reported by the door itself
        return "", range(0)
    return host, range(port, port + count)


def words(name: str, boards: Sequence[str]) -> str:
    """What to do to attach. boards: those with an RS232 line, in their order."""
    option, _, spec = name.partition(" ")
    kind, _, rest = spec.partition(":")
    host, taken = ports(name, len(boards))
    if not taken:
        lines = {"--can": f"python-can: interface={kind}, channel={rest}", "--debug": f"slcan in {spec}"}
        if option == "--serial":
            return ", ".join(f"{rest}/{board}" for board in boards)
        return lines.get(option, spec)
    where = f"[{host}]:{taken[0]}" if ":" in host else f"{host}:{taken[0]}"
    if option in _WEB:
        return _WEB[option].format(url=f"http://{where}/")
    if option == "--control":
        return f"schmidt control status --at {where}"
    if option == "--lx200":
        return f"LX200 over TCP, {where}"
    scheme = "socket" if kind == "tcp" else kind
    return f"{scheme}://{where} is {boards[0]}, and so on to port {taken[-1]}, {boards[-1]}"


def check_ports(names: Sequence[str], lines: int) -> None:
    """Raise OptionError for two doors that want one TCP port."""
    taken: dict[tuple[str, int], str] = {}
    for name in names:
        host, wanted = ports(name, lines)
        for port in wanted:
            other = taken.setdefault((host, port), name)
            if other != name:
                last = ports(other, lines)[1][-1]
                raise OptionError(f"{name}: {other} takes the ports up to {last}; give one of them another")
