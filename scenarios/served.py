"""The network as it stands before anybody commands it: what `serve` and the conformance checks work on."""

import datetime as dt
from pathlib import Path

from host.sky.observed import Clock
from scenarios.model import Scenario
from scenarios.network import Network, build, config_from

_UNUSED = Clock(dt.datetime(2000, 1, 1, tzinfo=dt.UTC))
"""Nothing here looks at the sky, so the date is of no account."""


def network(scenario_file: Path | None = None, seed: int | None = None, plant: str | None = None) -> Network:
    """Plant, boards and bus of a scenario, or of the lab network when None, parked and powered up.

    The scenario's network, plant, mount, seed and faults count; its steps are not run: whoever is on the bus
    commands. Raises ValueError subclasses with one line for what cannot be used.
    """
    from plant.plant import Plant
    from scenarios import faults
    from scenarios.plants import plant_model
    from scenarios.run import prepare
    from scenarios.session import soft_limits, start_steps

    if scenario_file is None:
        scenario = Scenario(Path("lab"), "lab", "", _UNUSED, (), seed=1 if seed is None else seed)
        from scenarios.load import DEFAULT_PLANT

        model = plant_model({"file": plant or DEFAULT_PLANT}, Path())
    else:
        scenario, model = prepare(scenario_file, seed, plant)
    pins = Plant(model, scenario.seed, start_steps(scenario))
    faults.stick_sensors(pins, scenario.faults)
    config = config_from(scenario.network, soft_limits(scenario))
    made = build(config, pins, scenario.seed)
    faults.apply(made, scenario.faults, scenario.seed)
    return made
