"""Firmware of a power board: eight relays in the supplies, a POWER frame every 250 ms. All an ASSUMPTION.

The relays are normally closed: a power board that fails leaves the telescope as it is. Which boards hang on
which relay is wiring (`scenarios/lab/nodes.py`).
"""

from collections.abc import Mapping

from boards.core import Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol import Health
from bus.protocol.nodes import POWER

_ALL_ON = 0xFF
_LSB_V = 40.0 / 1023
"""10-bit ADC behind a divider."""
_LSB_A = 40.0 / 1023
"""10-bit ADC behind a Hall sensor."""


class PowerBoard(DeclaredBoard):
    """A relay's pin is driven only when it changes."""

    KIND = POWER
    TABLE = (
        # 100 us: two conversions, compare; 60 us: SPI, dispatch, SPI
        Source("sample", priority=2, latency_cycles=12, cost_cycles=1000),
        Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
    )
    PINS = (Pin("voltage", "supply.voltage"), Pin("current", "supply.current"), Pin("relay", "supply.relay"))

    def reset(self) -> None:
        """After power-up every relay is at rest: closed."""
        super().reset()
        self.relays = _ALL_ON
        self.wrong = False

    def unpowered(self, t_ns: int) -> None:
        """Without supply the relays fall back: closed."""
        for channel in range(1, 9):
            self._switch(t_ns, channel, True)

    def measure(self, t_ns: int) -> Mapping[str, float]:
        """Every 250 ms."""
        voltage = round(self.read("voltage", t_ns) / _LSB_V) * _LSB_V
        current = round(self.read("current", t_ns) / _LSB_A) * _LSB_A
        under = voltage * 1000 < self.values["undervoltage_mv"].value
        over = current * 1000 > self.values["overcurrent_ma"].value
        self.wrong = under or over
        return {
            "UnderVoltage": under, "OverCurrent": over, "Relays": self.relays,
            "Voltage": voltage, "Current": current,
        }  # fmt: skip

    def relay(self, t_ns: int, channel: int, on: int) -> None:
        """Command RELAY."""
        self._switch(t_ns, channel, bool(on))

    def _switch(self, t_ns: int, channel: int, on: bool) -> None:
        bit = 1 << (channel - 1)
        if bool(self.relays & bit) != on:
            self.relays ^= bit
            self.pins["relay"](t_ns, channel, on)

    def health(self) -> Health:
        """Adds a supply out of its limits."""
        return super().health() | (Health.FAULT if self.wrong else Health(0))
