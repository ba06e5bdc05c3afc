"""The air about the telescope: one temperature for plant, sky, weather stations and focus."""

from dataclasses import replace

from plant.parts import Environment, Number, PlantModel

EXPANSION_M_PER_K = 6e-6
"""Of the place of best focus: 12e-6 1/K of a steel tube (ASSUMPTION) over 0.5 m, the focal length (paper)."""
IN_FOCUS_C = 10.0
"""degC, at which the middle of the focus' travel is in focus. ASSUMPTION: a mild night."""


def with_air(model: PlantModel, temperature_c: float) -> PlantModel:
    """The model in air of this temperature at the start; how it warms stays the plant file's."""
    start = Number(temperature_c, "degC", "scenario: site.temperature")
    return replace(model, environment=replace(model.environment, temperature=start))


class Air:
    """As a weather station measures it, by the names of its pins."""

    def __init__(self, model: PlantModel, humidity: float) -> None:
        self._environment, self._percent = model.environment, 100.0 * humidity

    def temperature(self, t_ns: int) -> float:
        """Degrees Celsius at a time of the run."""
        return _celsius(self._environment, t_ns)

    def humidity(self, _t_ns: int) -> float:
        """Relative, per cent."""
        return self._percent


def best_focus_m(model: PlantModel, t_ns: int) -> float:
    """Place of best focus from the middle of the travel: a warm tube is longer."""
    return EXPANSION_M_PER_K * (_celsius(model.environment, t_ns) - IN_FOCUS_C)


def _celsius(air: Environment, t_ns: int) -> float:
    return air.temperature.si + air.warming.si * t_ns * 1e-9
