"""A scenario made ready to be wired: read, changed by the command line, checked against network and sky."""

from __future__ import annotations

import copy
import dataclasses
import datetime as dt
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.sky.observed import Clock
from plant.yamltext import nearest
from scenarios.language.configure import completed, with_firmware
from scenarios.language.document import Document, ScenarioError, read
from scenarios.language.load import DEFAULT_PLANT, convert
from scenarios.language.model import Scenario, check_targets
from scenarios.language.validate import schema

if TYPE_CHECKING:
    from boards.core.declared import DeclaredBoard
    from plant.model import PlantModel


SCENARIOS = Path(__file__).parents[1]
"""Those that come with schmidt, by name: `quick-look`."""
CAMPAIGNS = SCENARIOS / "campaigns"


def located(given: Path, folder: Path = SCENARIOS) -> Path:
    """The file that is meant: the one of this path, or else the one of this name in `folder`.

    A path with a suffix or a folder in it is never a name. Raises ScenarioError for a name that nothing has.
    """
    try:
        there = given.exists()
    except (OSError, ValueError):  # a path that no system takes; reading it says why
        return given
    if there or given.suffix or len(given.parts) != 1:
        return given
    own = {file.stem: file for file in sorted(folder.glob("*.yaml"))}
    found = own.get(given.name.replace("_", "-"))
    if found is None:
        raise ScenarioError(f"{given}: no such file, and none of schmidt's own; {nearest(given.name, own)}")
    return found


UNDATED = Clock(dt.datetime(2000, 1, 1, tzinfo=dt.UTC))
"""The lab network has no date: boards do not look at the sky, and a host takes today's."""
_NEEDS = {"display": "DISPLAY", "dome": "DOME", "focus": "FOCUS"}
"""Board by action; every network has the axes."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Changes:
    """What a command line says instead of the scenario; None: nothing.

    isolated: firmware in C in processes of its own. speed: times real time.
    status_period_s: of the status and sensor logs. plant, firmware, network: by name.
    """

    seed: int | None = None
    plant: str | None = None
    speed: float | None = None
    status_period_s: float | None = None
    firmware: str | None = None
    network: str | None = None
    isolated: bool = False

    def to(self, scenario: Scenario) -> Scenario:
        """The scenario with them; the firmware is a step and comes when the steps are checked."""
        names = ("seed", "speed", "status_period_s")
        changed = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        plant = {} if self.plant is None else {"file": self.plant}
        network: dict[str, Any] = {} if self.network is None else {"name": self.network}
        network |= {"isolated": True} if self.isolated else {}
        return dataclasses.replace(
            scenario, plant=scenario.plant | plant, network=scenario.network | network, **changed
        )


def load(source: Path | Document) -> Scenario:
    """The scenario of a file (or the name of one of schmidt's), or of what stands in it.

    Relative names are looked for beside its `file`. Raises `ScenarioError` with one line of what and where.
    """
    document = source if isinstance(source, Document) else read(located(source))
    return convert(document, language_of(document))


def language_of(document: Document) -> dict[str, Any]:
    """The language, with the names of the boards that the document brings along; raises `ScenarioError`."""
    network = document.data.get("network") if isinstance(document.data, Mapping) else None
    files = network.get("boards") if isinstance(network, Mapping) else None
    if not isinstance(files, list) or not all(isinstance(file, str) for file in files):
        return schema()
    from scenarios.lab.nodes import load_board

    boards: list[type[DeclaredBoard]] = []
    for index, file in enumerate(files):
        try:
            boards.append(load_board(document.file.parent / file, boards))
        except ValueError as error:
            where = document.where(("network", "boards", index))
            raise ScenarioError(f"{where}: network.boards: {error}") from None
    names = [name for board in boards for name in board.KIND.nodes]
    language = copy.deepcopy(schema())
    nodes = language["properties"]["network"]["properties"]["nodes"]["properties"]
    language["$defs"]["node"]["enum"] += [name for name in names if name not in nodes]
    nodes |= {name: {"$ref": "#/$defs/settings"} for name in names}
    return language


def prepare(source: Path | Document, changes: Changes | None = None) -> tuple[Scenario, PlantModel]:
    """Load a scenario, apply the command line's changes, check all that can be checked without running."""
    from scenarios.language.plants import plant_model

    changes = changes or Changes()
    scenario = changes.to(load(source))
    check_targets(scenario)
    check_boards(scenario)
    if changes.firmware is not None:
        scenario = with_firmware(scenario, changes.firmware)
    try:
        model = plant_model(scenario.plant, scenario.file.parent)
    except ScenarioError as error:
        raise ScenarioError(f"{scenario.file}: {error}" if changes.plant is None else str(error)) from None
    return completed(scenario, model), model


def check_boards(scenario: Scenario) -> None:
    """Raise `ScenarioError` for the first step or fault that speaks of a board which is not there."""
    from scenarios.lab.networks import devices_in

    names = [device.name for device in devices_in(scenario)]
    wanted = [(step.where, _NEEDS[step.action]) for step in scenario.steps if step.action in _NEEDS]
    said = [(each.where, each.arguments) for each in scenario.steps]
    said += [(each.where, each.arguments) for each in scenario.faults]
    wanted += [(where, arguments["node"]) for where, arguments in said if "node" in arguments]
    network = scenario.network.get("name", "lab")
    for where, board in wanted:
        if board not in names:
            raise ScenarioError(f"{where}: the network '{network}' has no board {board}")


def chosen(
    scenario_file: Path | None = None,
    seed: int | None = None,
    plant: str | None = None,
    network_name: str | None = None,
) -> tuple[Scenario, PlantModel]:
    """Scenario and plant of a file, or of a network by name (None: the scenario's, or `lab`).

    Raises ValueError subclasses with one line for what cannot be used.
    """
    from scenarios.language.plants import plant_model

    changes = Changes(seed=seed, plant=plant, network=network_name)
    if scenario_file is not None:
        return prepare(scenario_file, changes)
    name = network_name or "lab"
    bare = Scenario(
        file=Path(name), name=name, clock=UNDATED, network={"name": name}, plant={"file": DEFAULT_PLANT}
    )
    scenario = changes.to(bare)
    return scenario, plant_model(scenario.plant, Path())
