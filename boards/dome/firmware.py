"""Firmware of the dome board: motors on or off, a DOME frame every 100 ms. All an ASSUMPTION.

A weather station that says unsafe, or has said nothing for 10 s, closes the shutter (parameter 2: not). A
network without weather stations has no bad weather: the wait begins with the first frame heard.
"""

from collections.abc import Mapping

from boards.core import NOT_ALLOWED, Answer, Source
from boards.core.declared import DeclaredBoard, Pin
from bus.protocol import MEASUREMENT_BASE, Health, State
from bus.protocol.nodes import DOME, WEATHER, FrameCodec, messages_of

_SILENCE_NS = 10_000_000_000
_TURN = 36000
"""Hundredths of a degree."""
_COUNTS = 3600
"""Of the encoder on the rail, per turn."""


class DomeBoard(DeclaredBoard):
    """Turns the shorter way; the motor has one speed and stops within the tolerance, parameter 1."""

    KIND = DOME
    TABLE = (
        # 150 us: counter, switches, compare; 60 us: SPI, dispatch, SPI
        Source("sample", priority=2, latency_cycles=12, cost_cycles=1500),
        Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
    )
    PINS = tuple(Pin(name, f"dome.{name}") for name in ("encoder", "shutter", "turn", "slide"))

    def reset(self) -> None:
        """After power-up: nothing moves, no station heard."""
        super().reset()
        self.target = self.azimuth = 0
        self.direction = self.sliding = 0
        self.seeking = False
        self.share = 0.0
        self.heard: dict[int, int] = {}
        self.unsafe: dict[int, bool] = {}
        self.stations = {each.frame_id: FrameCodec(each) for each in messages_of(WEATHER) if _station(each)}
        self.listen(dict.fromkeys(self.stations, self._weather))

    def unpowered(self, t_ns: int) -> None:
        """Contactors drop out."""
        self._turn(t_ns, 0)
        self._slide(t_ns, 0)

    def _weather(self, now_ns: int, data: bytes) -> None:
        identifier = MEASUREMENT_BASE + data[0]
        self.heard[identifier] = now_ns
        self.unsafe[identifier] = bool(self.stations[identifier].unpack(data)["Unsafe"])

    def bad_weather(self, t_ns: int) -> bool:
        """Some station says so, or fell silent."""
        return any(self.unsafe.values()) or self._silent(t_ns)

    def _silent(self, t_ns: int) -> bool:
        now_ns = self.clock_ns(t_ns)
        return any(now_ns - each > _SILENCE_NS for each in self.heard.values())

    def measure(self, t_ns: int) -> Mapping[str, float]:
        """Every 100 ms: compare and switch."""
        self.azimuth = int(self.read("encoder", t_ns)) % _COUNTS * (_TURN // _COUNTS)
        self.share = self.read("shutter", t_ns)
        bad = self.bad_weather(t_ns)
        end_ns = t_ns + self.cost_ns
        if bad and self.values["close_in_bad_weather"].value and self.share > 0:
            self._slide(end_ns, -1)
        if (self.sliding > 0 and self.share >= 1) or (self.sliding < 0 and self.share <= 0):
            self._slide(end_ns, 0)
        if self.seeking:
            self._seek(end_ns)
        return {
            "Moving": self.direction != 0, "ShutterMoving": self.sliding != 0, "Opened": self.share >= 1,
            "Closed": self.share <= 0, "BadWeather": bad, "Azimuth": self.azimuth / 100,
            "Target": self.target / 100, "Shutter": 100 * self.share,
        }  # fmt: skip

    def _seek(self, t_ns: int) -> None:
        away = (self.target - self.azimuth + _TURN // 2) % _TURN - _TURN // 2
        self.seeking = abs(away) > self.values["tolerance_centidegrees"].value
        self._turn(t_ns, (1 if away > 0 else -1) if self.seeking else 0)

    def _turn(self, t_ns: int, direction: int) -> None:
        if direction != self.direction:
            self.direction = direction
            self.pins["turn"](t_ns, direction)

    def _slide(self, t_ns: int, direction: int) -> None:
        if direction != self.sliding:
            self.sliding = direction
            self.pins["slide"](t_ns, direction)

    def dome_goto(self, _t_ns: int, azimuth: int) -> None:
        """Command DOME_GOTO, hundredths of a degree."""
        self.target = azimuth
        self.seeking = True

    def dome_shutter(self, t_ns: int, opened: int) -> Answer | None:
        """Command DOME_SHUTTER."""
        if opened and self.bad_weather(t_ns) and self.values["close_in_bad_weather"].value:
            return NOT_ALLOWED
        self._slide(t_ns, 1 if opened else -1)
        return None

    def dome_stop(self, t_ns: int) -> None:
        """Command DOME_STOP."""
        self.seeking = False
        self._turn(t_ns, 0)
        self._slide(t_ns, 0)

    def state(self) -> State:
        """Active while something moves."""
        return State.ACTIVE if self.direction or self.sliding else State.READY

    def health(self) -> Health:
        """Adds a station that fell silent."""
        return super().health() | (Health.STALE if self._silent(self.queue.now_ns) else Health(0))


def _station(message: object) -> bool:
    return str(getattr(message, "name", "")).endswith("_WEATHER")
