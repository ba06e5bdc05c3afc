"""The doors of `schmidt serve`, as its options ask for them, and the words by which one attaches to each."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from scenarios.doors.clients import address
from scenarios.doors.door import Door
from scenarios.doors.host_door import HostProcess
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.options import ServeOptions
from scenarios.doors.table import ON_HOST, ON_NETWORK, DoorKind, asked, doors_on, named


class Attached(NamedTuple):
    """words: what to do to attach. host, ports: of a door on TCP."""

    words: str
    host: str = ""
    ports: range = range(0)


def attached(name: str, boards: Sequence[str]) -> Attached:
    """By a door's name, such as `--serial tcp:7000`. boards: those with an RS232 line, in their order."""
    option, _, spec = name.partition(" (")[0].partition(" ")  # without what the door has added
    word, _, rest = spec.partition(":")
    kinds: tuple[DoorKind, ...] = (*ON_NETWORK, *ON_HOST)
    forms = next(kind.attach for kind in kinds if f"--{kind.name}" == option)
    form = forms.get(word, forms.get("", "{spec}"))
    given = {"spec": spec, "word": word, "rest": rest}
    if "{at}" not in form:
        return Attached(form.format(**given, lines=", ".join(f"{rest}/{board}" for board in boards)))
    several = "{last}" in form
    count = len(boards) if several else 1
    try:
        host, port = address(rest if several else spec, option, count)
    except ValueError:  # reported by the door itself
        return Attached(spec)
    at = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
    last = f"port {port + count - 1}, {boards[-1]}"
    return Attached(form.format(**given, at=at, first=boards[0], last=last), host, range(port, port + count))


def check_ports(names: Sequence[str], boards: Sequence[str]) -> None:
    """Raise ValueError for two doors that want one TCP port."""
    taken: dict[tuple[str, int], str] = {}
    for name in names:
        _, host, ports = attached(name, boards)
        for port in ports:
            other = taken.setdefault((host, port), name)
            if other != name:
                last = attached(other, boards).ports[-1]
                raise ValueError(f"{name}: {other} takes the ports up to {last}; give one of them another")


def check(options: ServeOptions) -> None:
    """Raise ValueError unless there is a door at all, and one to step by."""
    if not any(options.asked.values()):
        doors = named((*ON_NETWORK, *ON_HOST), "or")
        raise ValueError(f"serve needs a door: {doors} (see schmidt serve -h)")
    for option, given in (("--stars", options.stars), ("--frames", options.frames)):
        if given is not None and not options.asked.get("alpaca"):
            raise ValueError(f"{option} needs --alpaca, which has the cameras")
    if options.logs is not None and not any(asked(ON_HOST, options)):
        raise ValueError(f"--logs is the host's: it needs {named(ON_HOST, 'or')}")
    if options.clock == "steps" and not options.asked.get("control"):
        raise ValueError("--clock steps needs --control: nobody else could step")


def make_doors(options: ServeOptions, live: LiveNetwork, say: Callable[[str], None] = print) -> list[Door]:
    """The doors, closed. Their nodes on the wire are there from now on, in this order. say: takes lines for
    the user.

    The host comes first of its own, in a process of its own: what stands on it is opened over there.
    """
    doors = doors_on(ON_NETWORK, options, live)
    wanted = [(f"--{kind.name}", each.spec) for kind, each in asked(ON_HOST, options)]
    check_ports([*(door.name for door in doors), *map(" ".join, wanted)], list(live.lines.uarts))
    if not wanted:
        return doors
    if "GATEWAY" not in live.network.boards:
        raise ValueError(f"{named(ON_HOST, 'and')} need the gateway: take --network lab or final")
    for option, spec in wanted:
        if not spec.startswith("pty:"):
            address(spec, option)  # said before anything is started
    return [*doors, HostProcess(live, options, say)]
