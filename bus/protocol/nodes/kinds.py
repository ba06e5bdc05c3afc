"""The boards that only the network `final` has (B8, P10, P13). Everything here is an ASSUMPTION: the paper
names the boards and nothing more.

Device types 0x23, 0x24 and 0x71..0x73 were reserved for them. That weather and power come twice makes the
network the paper's "over sixteen".
"""

from pathlib import Path

from bus.protocol.names import Device
from bus.protocol.nodes.kind import Kind, ParameterRow

_HERE = Path(__file__).parent

AUXILIARY = Kind(
    "AUXILIARY",
    {"AUXILIARY_RA": 0x23, "AUXILIARY_DEC": 0x24},
    _HERE / "auxiliary.dbc",
)
DOME = Kind(
    "DOME",
    {"DOME": 0x71},
    _HERE / "dome.dbc",
    (
        ParameterRow(1, "tolerance_centidegrees", 10, 1000, 50),
        ParameterRow(2, "close_in_bad_weather", 0, 1, 1),
    ),
)
WEATHER = Kind(
    "WEATHER",
    {"WEATHER_MAST": 0x72, "WEATHER_DOME": 0x74},
    _HERE / "weather.dbc",
    (
        ParameterRow(1, "wind_limit_cm_s", 0, 6000, 1500),
        ParameterRow(2, "humidity_limit_permille", 0, 1000, 900),
        ParameterRow(3, "hold_s", 0, 3600, 300),
    ),
)
POWER = Kind(
    "POWER",
    {"POWER_DRIVES": 0x73, "POWER_ROOM": 0x75},
    _HERE / "power.dbc",
    (
        ParameterRow(1, "undervoltage_mv", 0, 30000, 20000),
        ParameterRow(2, "overcurrent_ma", 0, 60000, 30000),
    ),
)
KINDS = (AUXILIARY, DOME, WEATHER, POWER)
DEVICES = (*Device, *(device for kind in KINDS for device in kind.devices()))
"""All boards that come along, the lab's first."""
