"""The doors of `schmidt serve`, as its options ask for them."""

from collections.abc import Callable

from scenarios.doors.address import address
from scenarios.doors.attach import check_ports
from scenarios.doors.door import Door
from scenarios.doors.host_door import HostedDoor, HostProcess
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.options import DoorOptions, OptionError, ServeOptions
from scenarios.doors.table import ON_HOST, ON_NETWORK, asked, doors_on, named


def check(options: DoorOptions) -> None:
    """Raise OptionError unless there is a door at all, and one to step by."""
    if not any(options.asked.values()):
        raise OptionError(
            f"serve needs a door: {named((*ON_NETWORK, *ON_HOST), 'or')} (see schmidt serve -h)"
        )
    for option, given in (("--stars", options.stars), ("--frames", options.frames)):
        if given is not None and not options.asked.get("alpaca"):
            raise OptionError(f"{option} needs --alpaca, which has the cameras")
    if isinstance(options, ServeOptions) and options.clock == "steps" and not options.asked.get("control"):
        raise OptionError("--clock steps needs --control: nobody else could step")


def make_doors(options: DoorOptions, live: LiveNetwork, say: Callable[[str], None] = print) -> list[Door]:
    """The doors, closed. Their nodes on the wire are there from now on, in this order. say: takes lines for
    the user.

    The host comes first of its own, in a process of its own: what stands on it is opened over there.
    """
    doors = doors_on(ON_NETWORK, options, live)
    names = [f"--{kind.name} {each.spec}" for kind, each in asked(ON_HOST, options)]
    check_ports([*(door.name for door in doors), *names], list(live.lines.uarts))
    wanted = [(f"--{kind.name}", each.spec) for kind, each in asked(ON_HOST, options)]
    if not wanted:
        return doors
    if "GATEWAY" not in live.network.boards:
        raise OptionError(f"{named(ON_HOST, 'and')} need the gateway: take --network lab or final")
    for option, spec in wanted:
        if not spec.startswith("pty:"):
            address(spec, option)  # said before anything is started
    host = HostProcess(live, options, say)
    return [*doors, host, *(HostedDoor(host, k, " ".join(each)) for k, each in enumerate(wanted, 1))]
