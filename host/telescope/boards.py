"""Looking after the boards: health, parameters (H2)."""

from collections.abc import Generator

from bus.protocol import Device, Health, Opcode
from host.client import Client, ClientError
from host.telescope.jobs import Activity, Job, Side


class Boards:
    """Asks and sets what belongs to single boards; each command is a `Job` beside the others."""

    def __init__(self, client: Client, side: Side) -> None:
        self._client = client
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
