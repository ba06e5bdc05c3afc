"""`schmidt conformance [SCENARIO] [--network NAME] [--can BUS] [--board TYPE:ID]`: the checks."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from bus.conformance import Settings, board_of, parse
from bus.conformance.cli import check, conformance_command
from bus.conformance.result import CheckResult
from bus.outside.pythoncan import SchmidtBus
from bus.protocol.nodes import DEVICES, documented
from scenarios.lab.networks import devices_in
from scenarios.lab.prepare import chosen
from scenarios.lab.wiring import wire
from scenarios.progress import Show, shown


def command(
    spec: str | None,
    json_path: Path | None = None,
    boards: Sequence[str] = (),
    settings: Settings | None = None,
    scenario_file: Path | None = None,
    network_name: str | None = None,
) -> int:
    """Check the bus that `spec` names, or (None) a network in this process; returns the exit status.

    boards: TYPE:ID each; none named: those of scenario_file or network_name, the lab network's when neither
    is given.
    """
    settings = settings or Settings()
    scenario, model = chosen(scenario_file, network_name=network_name)
    devices = devices_in(scenario)
    known = (*DEVICES, *devices)
    dbc = documented(known)
    named = [parse(board, known) for board in boards] or [board_of(device) for device in devices]
    with shown("conformance", 1 + len(named)) as show:
        settings = replace(settings, each=_told([board.name for board in named], show))
        if spec is not None:
            return conformance_command(spec, json_path, named, settings, dbc)
        if settings.canopen:
            scenario = replace(scenario, network={**scenario.network, "canopen": True})
        with SchmidtBus(wire(scenario, model).wire) as bus:
            return check(bus, json_path, replace(settings, stamps_s=0.0), named, dbc)


def _told(boards: Sequence[str], show: Show) -> Callable[[CheckResult], None]:
    """Tell `show` how many boards are done, from the results in their order; listening counts as one."""
    done = 0

    def each(result: CheckResult) -> None:
        nonlocal done
        name, _, command = result.subject.partition(" ")
        if command and name in boards:  # frames, which are listened to first, are a single word
            done = max(done, 1 + boards.index(name))
        show(done, f"{result.check}: {result.subject}")

    return each
