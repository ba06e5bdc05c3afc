"""Firmware of the focus board: a 10 ms sample interrupt and, while moving, a step interrupt."""

from typing import Final

from boards.core import NOT_ALLOWED, OK, OUT_OF_RANGE, Answer, PacketLine, PeriodicBoard, Place
from boards.core.commands import commands
from boards.focus.config import FCY_HZ, TABLE, FocusConfig, FocusPins
from boards.focus.stepping import Reference, Stepping
from boards.silicon.adc import VoltageAdc
from boards.silicon.qei import Qei, difference
from boards.silicon.stepper import StepperDriver
from bus.protocol import MEASUREMENT_BASE, FocusFlag, Health, Opcode, State, pack_focus

TICK_NS: Final = 10_000_000
_FRAME_TICKS: Final = 5
_HEARTBEAT_TICKS: Final = 100
_REST_NS: Final = 50_000_000
"""Full current after the last step, until the rotor is surely at rest. ASSUMPTION."""
_LOST: Final = 2
"""Half steps between counter and encoder that count as lost steps. ASSUMPTION."""


class FocusBoard(PeriodicBoard):
    """Counts half steps; the encoder checks them, the index and the LVDT give them an origin."""

    def __init__(self, place: Place, pins: FocusPins, config: FocusConfig) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.config = config
        self.qei = Qei(pins.encoder)
        self.adc = VoltageAdc(pins.lvdt)
        self.index_pin = pins.index
        self.driver = StepperDriver(pins.coils)
        self.packets = PacketLine(place, self.clip)
        self.uart = self.packets.uart
        self._identifier = MEASUREMENT_BASE + self.device_type
        self.cpu.lines["step"].body = self._step
        self.commands = self.common_commands() | commands(
            {
                Opcode.FOCUS_STEP: self._command_step,
                Opcode.FOCUS_MOVE_TO: self._go,
                Opcode.FOCUS_HOLD: self._command_hold,
                Opcode.FOCUS_FREE: self._command_free,
                Opcode.FOCUS_REFERENCE: self._command_reference,
            }
        )
        self.reset()

    def reset(self) -> None:
        """After power-up: holding, position unknown."""
        self.stepping = Stepping(self.config)
        self.reference = Reference(self.config)
        self.referenced = False
        self.free = False
        self.driver.rest(self.queue.now_ns)
        self.poscnt = self._origin = self.qei.poscnt(self.queue.now_ns)
        self.packets.clear()
        self._last_move_ns = 0
        self._timer_ns = 0

    def unpowered(self, t_ns: int) -> None:
        """Without supply the shaft is free."""
        self.driver.release(t_ns)

    # --- sample interrupt
    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 10 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        self.poscnt = self.qei.poscnt(t_ns)
        lvdt = self.adc.read(t_ns)
        stepping = self.stepping
        if self.driver.energised and self._rests(t_ns):
            self.driver.rest(end)
        self.packets.take(t_ns, end, (stepping.position, self._counts(), lvdt))
        if not self.ticks % _FRAME_TICKS:
            flags = self._flags(self.index_pin(t_ns))
            data = pack_focus(self.device_type, flags, stepping.position, self._counts(), lvdt, self.clip)
            self.transmit(self._identifier, data, end)
        elif self.ticks % _HEARTBEAT_TICKS == 1:
            self.heartbeat(end)

    def _rests(self, t_ns: int) -> bool:
        """Whether the rotor is surely at rest."""
        return not self.stepping.moving and self.clock_ns(t_ns) - self._last_move_ns > _REST_NS

    def _counts(self) -> int:
        """Encoder counts from the origin, as the 16 bits of the frame."""
        return difference(self.poscnt, self._origin)

    def _flags(self, index: bool) -> int:
        flags = FocusFlag.MOVING if self.stepping.moving else FocusFlag.FREE if self.free else FocusFlag.HOLD
        if self.referenced:
            flags |= FocusFlag.REFERENCED
        if index:
            flags |= FocusFlag.INDEX_SEEN
        return int(flags)

    # --- step interrupt
    def _begin(self, t_ns: int, target: int) -> None:
        self.stepping.target = target
        if not self.stepping.moving:
            self.stepping.moving = True
            self._arm(t_ns)

    def _arm(self, t_ns: int) -> None:
        self._timer_ns = t_ns
        self.queue.at(t_ns, self._timer)

    def _timer(self, t_ns: int) -> None:
        if t_ns == self._timer_ns:
            self.cpu.lines["step"].request(t_ns)

    def _step(self, t_ns: int) -> None:
        stepping, reference = self.stepping, self.reference
        if not stepping.moving or not self.on:
            return
        if reference.active:
            found = reference.look(self.adc.read(t_ns), self.index_pin(t_ns))
            if found is not None:
                self._set_origin(t_ns, found)
                return
        direction, interval_ns = stepping.next()
        if not direction:
            if reference.active:
                reference.give_up()
            return
        self.driver.step(t_ns, direction)
        self._last_move_ns = self.clock_ns(t_ns)
        crystal = self.oscillator
        self._arm(crystal.true_ns(crystal.local_ns(t_ns) + interval_ns))

    def _set_origin(self, t_ns: int, position: int) -> None:
        """The motor stands at `position`, beyond doubt."""
        self.stepping.rebase(position)
        self.poscnt = self.qei.poscnt(t_ns)
        self._origin = self.poscnt - self._expected(position)
        self.referenced = True

    def _expected(self, position: int) -> int:
        """Encoder counts at a position."""
        return position * self.config.counts_per_turn // self.config.half_steps_per_turn

    # --- commands
    def _command_step(self, t_ns: int, steps: int) -> Answer:
        return self._go(t_ns, self.stepping.target + steps)

    def _go(self, t_ns: int, target: int) -> Answer:
        if abs(target) > self.config.travel:
            return OUT_OF_RANGE
        if self.free or self.reference.active:
            return NOT_ALLOWED
        if target != self.stepping.position or self.stepping.moving:
            self._begin(t_ns, target)
        return OK

    def _command_hold(self, t_ns: int) -> Answer:
        """Motor power off: stop, then hold by the free-wheeling diodes."""
        self.reference.active = False
        if self.free:
            self.free = False
            self.driver.rest(t_ns)
        self.stepping.brake()
        return OK

    def _command_free(self, t_ns: int) -> Answer:
        """Control power off: nothing holds the shaft, so the origin cannot be trusted any more."""
        self.stepping.rebase(self.stepping.position)
        self.free = True
        self.referenced = False
        self.driver.release(t_ns)
        return OK

    def _command_reference(self, t_ns: int) -> Answer:
        if self.free or self.stepping.moving:
            return NOT_ALLOWED
        self.referenced = False
        target = self.reference.begin(self.stepping.position, self.adc.read(t_ns), self.index_pin(t_ns))
        self._begin(t_ns, target)
        return OK

    # --- health
    def state(self) -> State:
        """Active while the motor may be stepped."""
        return State.READY if self.free else State.ACTIVE

    def health(self) -> Health:
        """Adds lost steps and a failed search for the index to the common bits."""
        bits = super().health()
        wrong = abs(self._counts() - self._expected(self.stepping.position))
        lost = self.referenced and self._rests(self.queue.now_ns) and wrong > self._expected(_LOST)
        if self.reference.failed or lost:
            bits |= Health.SENSOR
        return bits
