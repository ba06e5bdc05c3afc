"""Firmware of a weather station: one WEATHER frame a second. The part and its cycles are ASSUMPTIONS.

Sensors sit on the 10-bit ADC, 0..5 V for the ranges below (ASSUMPTION: what such transmitters commonly have).
"""

from collections.abc import Mapping

from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol import Health
from bus.protocol.nodes import WEATHER

_ADC_TOP = 1023
_TEMPERATURE_C = (-40.0, 60.0)
_HUMIDITY_PERCENT = (0.0, 100.0)
_WIND_M_S = (0.0, 75.0)
_SECOND_NS = 1_000_000_000
_NEVER_NS = -(1 << 61)


class WeatherBoard(DeclaredBoard):
    """Bad weather counts for parameter 3 seconds after it is over."""

    KIND = WEATHER
    TABLE = (
        # 200 us: three conversions, scaling; 60 us: SPI, dispatch, SPI
        Source("sample", priority=2, latency_cycles=12, cost_cycles=2000),
        Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
    )
    PINS = (
        Pin("temperature", default=10.0, unit="degC"),
        Pin("humidity", default=50.0, unit="%"),
        Pin("wind", default=2.0, unit="m/s"),
        Pin("rain", default=0.0, unit="drops on the sensor, 0 or 1"),
    )

    def reset(self) -> None:
        """After power-up the weather is as it is now."""
        super().reset()
        self.bad_ns = _NEVER_NS
        self.at_rail = False

    def measure(self, t_ns: int) -> Mapping[str, float]:
        """Once a second."""
        self.at_rail = False
        temperature = self._convert("temperature", t_ns, *_TEMPERATURE_C)
        humidity = self._convert("humidity", t_ns, *_HUMIDITY_PERCENT)
        wind = self._convert("wind", t_ns, *_WIND_M_S)
        rain = self.read("rain", t_ns) >= 0.5
        windy = wind * 100 > self.values["wind_limit_cm_s"].value
        humid = humidity * 10 > self.values["humidity_limit_permille"].value
        now_ns = self.clock_ns(t_ns)
        if rain or windy or humid:
            self.bad_ns = now_ns
        unsafe = now_ns - self.bad_ns <= self.values["hold_s"].value * _SECOND_NS
        return {
            "Rain": rain, "Windy": windy, "Humid": humid, "Unsafe": unsafe,
            "Temperature": temperature, "Humidity": humidity, "Wind": wind,
        }  # fmt: skip

    def _convert(self, pin: str, t_ns: int, low: float, high: float) -> float:
        """The ADC's reading in the sensor's unit; an input beyond the range stops at the rail."""
        counts = round((self.read(pin, t_ns) - low) / (high - low) * _ADC_TOP)
        if not 0 <= counts <= _ADC_TOP:
            self.at_rail = True
            counts = min(max(counts, 0), _ADC_TOP)
        return low + counts * (high - low) / _ADC_TOP

    def health(self) -> Health:
        """Adds a sensor at its rail: a broken wire looks like that."""
        return super().health() | (Health.SENSOR if self.at_rail else Health(0))
