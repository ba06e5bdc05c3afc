"""The network as it stands before anybody commands it: what `run`, `serve` and the checks work on."""

from pathlib import Path

from bus.time import generator
from bus.units import ARCSEC_PER_RAD
from host.procedures.manual import AXES
from host.sky.mount import STEP_ARCSEC
from plant.air import with_air
from plant.model import PlantModel
from plant.plant import Plant
from plant.stops import with_stops
from scenarios.lab.blowing import Blowing, in_the_wind
from scenarios.lab.chain import SWITCHES, chained
from scenarios.lab.faults.live import Faults
from scenarios.lab.network import Network, build
from scenarios.lab.networks import config_from
from scenarios.lab.prepare import chosen
from scenarios.language.document import ScenarioError
from scenarios.language.model import Scenario

_FOCUS_START = 5  # The focus is found at most this many electrical periods from the middle. ASSUMPTION.
_HALF_STEPS_PER_PERIOD = 8  # The rotor rests where the phase that the board starts with holds it.
_STEP_RAD = STEP_ARCSEC / ARCSEC_PER_RAD


def powered(scenario: Scenario, model: PlantModel) -> Network:
    """Plant, boards, bus and safety chain of a scenario, parked and powered up; nothing goes wrong yet.

    Its steps are not run: whoever is on the bus commands.
    """
    scales = {axis: getattr(scenario.mount, axis) for axis in AXES}
    limits = {axis: (scale.low_steps, scale.high_steps) for axis, scale in scales.items()}
    soft_rad = {axis: (low * _STEP_RAD, high * _STEP_RAD) for axis, (low, high) in limits.items()}
    wind_from = scenario.network.get("wind_from")
    built = model if wind_from is None else in_the_wind(model)
    built = with_air(with_stops(built, soft_rad), scenario.site.temperature_c)
    pins = Plant(built, scenario.seed, start_steps(scenario))
    config = config_from(scenario.network, limits, scenario.file.parent)
    try:
        made = build(config, pins, scenario.seed, scenario.site.humidity)
    except ValueError as error:
        raise ScenarioError(f"{scenario.file}: {error}") from None
    made.chain = chained(made, soft_rad, scenario.network.get("chain", SWITCHES))
    if wind_from is not None:
        made.blowing = Blowing(made, wind_from / ARCSEC_PER_RAD)
    return made


def wired(scenario: Scenario, model: PlantModel) -> tuple[Network, Faults]:
    """The same and the scenario's faults, which come at their times."""
    made = powered(scenario, model)
    faults = Faults(made, scenario.seed)
    faults.schedule(scenario.faults)
    return made, faults


def wire(scenario: Scenario, model: PlantModel) -> Network:
    """`wired`, for who wants no further faults."""
    return wired(scenario, model)[0]


def network(scenario_file: Path | None = None, network_name: str | None = None) -> Network:
    """The network of a scenario, or one by its name."""
    return wire(*chosen(scenario_file, network_name=network_name))


def start_steps(scenario: Scenario) -> dict[str, float]:
    """Where the telescope stands at first: parked unless the scenario says where; the focus, by the seed."""
    mount = scenario.mount
    periods = int(generator(scenario.seed, "focus.start").integers(-_FOCUS_START, _FOCUS_START + 1))
    return {
        "ra": mount.ra.steps(scenario.start_rad.get("hour_angle", mount.park_hour_angle_rad)),
        "dec": mount.dec.steps(scenario.start_rad.get("declination", mount.park_declination_rad)),
        "focus": float(periods * _HALF_STEPS_PER_PERIOD),
    }
