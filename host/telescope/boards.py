"""Looking after the boards: health, parameters, soft limits, display (H2)."""

from collections.abc import Generator

from bus.protocol import AxisParameter, Device, Health, Opcode
from host.client import Client, ClientError
from host.sky.mount import STEPS_PER_TURN
from host.telescope.jobs import Activity, Job, Side
from host.telescope.observatory import Observatory
from host.telescope.refused import Reason, Refused
from host.telescope.state import AXES


class Boards:
    """Asks and sets what belongs to single boards; each command is a `Job` beside the others."""

    def __init__(self, client: Client, observatory: Observatory, side: Side) -> None:
        self._client = client
        self._observatory = observatory
        self._side = side

    def check(self) -> Job[dict[Device, Health | None]]:
        """Health bits of every board, None for one that does not answer."""
        return self._side.start(Job("health check", self._check(), Activity.IDLE))

    def get(self, device: Device, parameter: int) -> Job[int]:
        """Value of a parameter."""
        return self._side.start(Job(f"get {parameter}", self._get(device, parameter), Activity.IDLE))

    def set(self, device: Device, parameter: int, value: int) -> Job[int]:
        """Set a parameter; the job ends with the value the board has taken."""
        procedure = self._set(device, parameter, value)
        return self._side.start(Job(f"set {parameter}", procedure, Activity.IDLE))

    def set_soft_limits(self, axis: str, low_rad: float, high_rad: float) -> Job[None]:
        """Soft limits of `ra` (hour angle, positive west) or `dec`, on both boards of the axis."""
        scale = getattr(self._observatory.mount, axis)
        low, high = scale.steps(low_rad), scale.steps(high_rad)
        if not 0 <= low < high < STEPS_PER_TURN:
            raise Refused(Reason.VALUE, "soft limits: low must be below high, both within the encoder's turn")
        return self._side.start(Job("soft limits", self._limits(axis, low, high), Activity.IDLE))

    def brightness(self, percent: int) -> Job[None]:
        """Brightness of the display, 0 to 100 %."""
        return self._side.start(Job("brightness", self._brightness(percent), Activity.IDLE))

    def _check(self) -> Generator[None, None, dict[Device, Health | None]]:
        answers: dict[Device, Health | None] = {}
        for device in self._client.devices:
            try:
                reply = yield from self._client.ask(device, Opcode.PING)
            except ClientError:
                answers[device] = None
                self._client.health.pop(device, None)
            else:
                answers[device] = Health(reply.value)
        return answers

    def _get(self, device: Device, parameter: int) -> Generator[None, None, int]:
        reply = yield from self._client.ask(device, Opcode.GET_PARAMETER, parameter)
        return reply.value

    def _set(self, device: Device, parameter: int, value: int) -> Generator[None, None, int]:
        yield from self._client.ask(device, Opcode.SET_PARAMETER, parameter, value)
        return (yield from self._get(device, parameter))

    def _limits(self, axis: str, low: int, high: int) -> Generator[None, None, None]:
        for device in AXES[axis][:2]:
            for parameter, value in (
                (AxisParameter.LIMIT_LOW_STEPS, low),
                (AxisParameter.LIMIT_HIGH_STEPS, high),
            ):
                yield from self._client.ask(device, Opcode.SET_PARAMETER, parameter, value)
        self._observatory.limit(axis, low, high)

    def _brightness(self, percent: int) -> Generator[None, None, None]:
        yield from self._client.ask(Device.DISPLAY, Opcode.BRIGHTNESS, percent)
