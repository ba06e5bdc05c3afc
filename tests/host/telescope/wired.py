"""A telescope client whose boards are the test: they answer at once, and stand where they are put."""

import datetime as dt
import math
from collections.abc import Callable
from typing import Any

from bus.protocol import (
    AxisMode,
    Device,
    MotionFlag,
    Opcode,
    pack_focus,
    pack_motion,
    pack_position,
    pack_reply,
    pack_target,
)
from bus.protocol.command_layouts import unpack_command
from bus.protocol.report import unpack_commands
from host.client import TICK_NS, Client
from host.link import HidLink
from host.logs.journal import Journal
from host.sky.mount import limits_mount
from host.sky.observed import Clock
from host.sky.site import NAINITAL
from host.sky.visibility import Observatory
from host.telescope import Job, Telescope

DEVICES = (
    Device.AXIS_RA, Device.AXIS_DEC, Device.POSITION_RA, Device.POSITION_DEC, Device.FOCUS,
)  # fmt: skip
AXES = (Device.AXIS_RA, Device.AXIS_DEC)
NIGHT = Clock(dt.datetime(2026, 2, 10, 14, 0, tzinfo=dt.UTC))
CENTRE = 1 << 28


class Wired:
    """told: commands as (device, opcode, arguments), in order. results: what a command is answered with."""

    def __init__(self) -> None:
        self.told: list[tuple[Any, ...]] = []
        self.results: dict[Any, tuple[int, int]] = {}
        self.silent: set[Device] = set()
        self.link = HidLink(self._sent)
        self.journal = Journal(None)
        self.client = Client(self.link, self.journal, DEVICES)
        mount = limits_mount(math.radians(80), math.radians(-45), math.radians(85), NAINITAL.latitude_rad)
        self.observatory = Observatory(NAINITAL, NIGHT, mount)
        self.telescope = Telescope(self.client, self.observatory, self.journal)
        self.steps = list(mount.park_steps)
        self.flags = [MotionFlag(0), MotionFlag(0)]
        self.modes = [AxisMode.OFF, AxisMode.OFF]
        self.velocity = [0, 0]
        self.distance = [0, 0]
        self.follows: Callable[[], None] = lambda: None

    def _sent(self, t_ns: int, report: bytes) -> None:
        for frame in unpack_commands(report):
            device, opcode, arguments = unpack_command(frame.data)
            self.told.append((Device(device), Opcode(opcode), *arguments))
            if Device(device) not in self.silent:
                result, value = self.results.get(Opcode(opcode), (0, 0))
                assert self.link.on_reply is not None
                self.link.on_reply(t_ns, pack_reply(device, opcode, result, 0, value))
            if opcode == Opcode.POWER:
                self.flags[AXES.index(Device(device))] = MotionFlag(MotionFlag.POWERED * arguments[0])

    def frames(self) -> None:
        """What the boards measure now."""
        link, t_ns = self.link, self.client.now_ns + TICK_NS
        link.heard_ns = {int(device): t_ns for device in DEVICES if device not in self.silent}
        for k, axis in enumerate(AXES):
            encoder = (Device.POSITION_RA, Device.POSITION_DEC)[k]
            link.measurements[axis] = pack_motion(
                axis, int(self.modes[k]) | int(self.flags[k]) << 4, self.velocity[k], 0, (0, 0)
            )
            link.measurements[encoder] = pack_position(encoder, 0, self.steps[k], 0, 0)
            link.measured_ns[encoder] = link.measured_ns[axis] = t_ns
            link.summaries[axis] = pack_target(axis, 0, 0, self.distance[k])

    def focus(self, position: int, flags: int = 0) -> None:
        self.link.measurements[Device.FOCUS] = pack_focus(Device.FOCUS, flags, position, 0, 512)

    def tick(self, count: int = 1) -> None:
        """50 ms each."""
        for _ in range(count):
            self.follows()
            self.frames()
            self.telescope.tick(self.client.now_ns + TICK_NS)

    def do(self, act: Callable[[Telescope], Any]) -> Any:
        future = self.telescope.call(act)
        self.tick()
        return future.result(0)

    def ended(self, job: Job[Any], ticks: int = 400) -> Any:
        """Value of a job, or what it raised."""
        for _ in range(ticks):
            if not job.running:
                break
            self.tick()
        return job.finished.result(0)

    def since(self) -> list[tuple[Any, ...]]:
        """Commands since the last look."""
        told, self.told = self.told, []
        return told

    def said(self, kind: str) -> list[str]:
        """Texts of the journal."""
        return [each.text for each in self.journal.entries if each.kind == kind]


def awake() -> Wired:
    """Powered, and not parked."""
    made = Wired()
    made.tick()
    made.ended(made.do(lambda t: t.drive.power_on()))
    made.since()
    return made
