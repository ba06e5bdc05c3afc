"""The network as it stands before anybody commands it: what `serve` and the conformance checks work on."""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import TYPE_CHECKING

from host.sky.observed import Clock
from scenarios.model import Scenario
from scenarios.network import Network, build
from scenarios.networks import config_from

if TYPE_CHECKING:
    from plant.model import PlantModel
    from scenarios.faults import Faults

UNDATED = Clock(dt.datetime(2000, 1, 1, tzinfo=dt.UTC))
"""The lab network has no date: boards do not look at the sky, and a host takes today's."""


def chosen(
    scenario_file: Path | None = None,
    seed: int | None = None,
    plant: str | None = None,
    network_name: str | None = None,
) -> tuple[Scenario, PlantModel]:
    """Scenario and plant of a file, or of a network by name (None: the scenario's, or `lab`).

    Raises ValueError subclasses with one line for what cannot be used.
    """
    from scenarios.load import DEFAULT_PLANT
    from scenarios.plants import plant_model
    from scenarios.run import prepare

    if scenario_file is not None:
        return prepare(scenario_file, seed, plant, network=network_name)
    name = network_name or "lab"
    on_it = {"name": name}
    scenario = Scenario(Path(name), name, "", UNDATED, (), network=on_it, seed=1 if seed is None else seed)
    return scenario, plant_model({"file": plant or DEFAULT_PLANT}, Path())


def wire(scenario: Scenario, model: PlantModel) -> Network:
    """`wired`, for who wants no further faults."""
    return wired(scenario, model)[0]


def wired(scenario: Scenario, model: PlantModel) -> tuple[Network, Faults]:
    """Plant, boards and bus of a scenario, parked and powered up, and its faults.

    Its steps are not run: whoever is on the bus commands.
    """
    from plant.plant import Plant
    from scenarios.faults import Faults
    from scenarios.session import soft_limits, start_steps

    pins = Plant(model, scenario.seed, start_steps(scenario))
    config = config_from(scenario.network, soft_limits(scenario), scenario.file.parent)
    made = build(config, pins, scenario.seed)
    faults = Faults(made, scenario.seed)
    faults.schedule(scenario.faults)
    return made, faults


def network(
    scenario_file: Path | None = None,
    seed: int | None = None,
    plant: str | None = None,
    network_name: str | None = None,
) -> Network:
    """Both in one: what the checks in this process work on."""
    return wire(*chosen(scenario_file, seed, plant, network_name))
