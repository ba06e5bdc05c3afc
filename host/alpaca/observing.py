"""IObservingConditionsV2 and ISafetyMonitorV3: the weather stations, and whether the dome may be open."""

import math

from bus.protocol.nodes import WEATHER
from host.alpaca.device import CONSTANTS, Device, Member, does, stated, table, unknown, zero
from host.alpaca.requests import INVALID_VALUE, AlpacaError, Parameters, not_implemented

_WET_MM_H = 1.0
"""The sensor tells wet from dry; ASCOM: any positive rate means wet."""
_MAGNUS = (17.62, 243.12)
"""Of the dew point over water, the second in °C: WMO-No. 8 (2018), annex 4.B."""
_SENSORS = {
    "DewPoint": "computed from temperature and humidity",
    "Humidity": "relative humidity at the mast, 0 to 100 %",
    "RainRate": "drops on the sensor at the mast: 0 or 1 mm/h",
    "Temperature": "air at the mast, °C",
    "WindSpeed": "at the mast, mean of a second, m/s",
}


def dew_point_c(air_c: float, humidity: float) -> float:
    """Magnus' formula; humidity: share of saturation, above 0."""
    a, b = _MAGNUS
    g = math.log(humidity) + a * air_c / (b + air_c)
    return b * g / (a - g)


class ObservingConditionsDevice(Device):
    """The first station of the network: the mast's. Values are those of the moment."""

    kind = "observingconditions"
    interface_version = 2
    description = "Weather station on the mast"
    unique_id = "8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d0004"

    def state(self) -> dict[str, object]:
        """Operational properties."""
        now = self.desk.telescope.house.fresh(self._station)
        if now is None:
            raise unknown()
        return {
            "DewPoint": dew_point_c(now["Temperature"], max(now["Humidity"], 0.1) / 100),
            "Humidity": now["Humidity"], "RainRate": _WET_MM_H if now["Rain"] else 0.0,
            "Temperature": now["Temperature"], "WindSpeed": now["Wind"],
        }  # fmt: skip

    @property
    def age_s(self) -> float:
        """Of all its values; they come in one frame."""
        return self.now.t_s - self.desk.telescope.house.heard_s(self._station)

    @property
    def _station(self) -> str:
        return self.desk.telescope.house.expected(WEATHER)[0]


class SafetyMonitorDevice(Device):
    """Safe when every station is heard and says so. Without a connection it is not."""

    kind = "safetymonitor"
    interface_version = 3
    description = "What the weather stations say of an open dome"
    unique_id = "8ad6c6f4-0b0e-4f0b-9c52-5c1d5f1d0005"

    def state(self) -> dict[str, object]:
        """Operational properties."""
        return {"IsSafe": self.connected and not self.desk.telescope.house.unsafe()}


def _sensor(given: Parameters) -> str:
    name = given.text("SensorName").lower()
    if name in map(str.lower, CONSTANTS["observingconditions"]["missing"]):
        not_implemented(name)
    found = {sensor.lower(): sensor for sensor in _SENSORS}.get(name)
    if found is None:
        raise AlpacaError(INVALID_VALUE, f"no sensor {name[:40]!r}; there are {', '.join(_SENSORS)}")
    return found


def _since(device: ObservingConditionsDevice, given: Parameters) -> float:
    if given.text("SensorName"):
        _sensor(given)
    device.state()
    return device.age_s


ObservingConditionsDevice.members = table(
    "observingconditions",
    *(Member(name, stated(name)) for name in _SENSORS),
    zero("AveragePeriod", Parameters.number),
    Member("Refresh", put=does(lambda _device, _: None)),  # the station sends by itself, once a second
    Member("SensorDescription", lambda _device, given: _SENSORS[_sensor(given)]),
    Member("TimeSinceLastUpdate", _since),
)
SafetyMonitorDevice.members = table("safetymonitor", Member("IsSafe", stated("IsSafe"), always=True))
