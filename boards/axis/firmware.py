"""Firmware of the axis board: the 5 ms interrupt, telemetry every 10 ms, packets every 250 ms."""

from typing import Final

from boards.axis.commands import axis_commands, axis_parameters
from boards.axis.config import FCY_HZ, TABLE, TICK_NS, AxisConfig, AxisPeers, AxisPins
from boards.axis.limits import SoftLimits
from boards.axis.motion import POINTING, Motion
from boards.axis.observer import Observer
from boards.axis.output import FineOutput, fine_parameters, observer_parameters
from boards.axis.pi import CounterTorque, IncrementalPi
from boards.axis.profile import UNITS_PER_STEP
from boards.axis.tachometer import RemoteAuxiliary, RemoteTachometer
from boards.axis.watch import EncoderWatch
from boards.core import PacketLine, PeriodicBoard, Place
from boards.silicon.adc import CurrentAdc
from boards.silicon.can import FULL_MASK
from boards.silicon.pwm import MotorPwm
from boards.silicon.qei import Qei, difference
from bus.protocol import (
    COMMAND_BASE,
    MEASUREMENT_BASE,
    SUMMARY_BASE,
    AxisMode,
    Health,
    MotionFlag,
    State,
    pack_motion,
    pack_target,
)
from bus.protocol.serial import NO_SETPOINT

_EFFORT_SCALE: Final = 3000
"""Effort on the wire and in the logs is in 1/3000 of the supply, whatever the PWM's own resolution."""
_TARGET_TICKS: Final = 50
_HEARTBEAT_TICKS: Final = 200
_POWERED, _MOVING, _LIMIT, _FAULT = (
    int(flag) << 4
    for flag in (MotionFlag.POWERED, MotionFlag.MOVING, MotionFlag.SOFT_LIMIT, MotionFlag.FAULT)
)
"""Above the mode, in the frame's second byte."""


class AxisBoard(PeriodicBoard):
    """dsPIC30F3011 + MCP2515, one per axis."""

    def __init__(self, place: Place, pins: AxisPins, config: AxisConfig, peers: AxisPeers) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.config = config
        self.qei = Qei(pins.encoder)
        self.pwm = MotorPwm(pins.drive, config.pwm_steps, config.pwm_hz)
        self.adc = CurrentAdc(pins.current)
        self.packets = PacketLine(place, self.clip)
        self.uart = self.packets.uart
        self.pi = IncrementalPi(round(config.kp * 4096), round(config.ki * 4096), config.pwm_steps)
        self.motion = Motion(config, self.pi)
        self.limits = SoftLimits(self.motion)
        self.tach_a = RemoteTachometer(config.frame_ns)
        self.tach_b = RemoteTachometer(config.frame_ns)
        self.counter = CounterTorque(config.counter_split, config.split_fade_counts)
        self.watch = EncoderWatch()
        self._identifier = MEASUREMENT_BASE + self.device_type
        self.auxiliary = RemoteAuxiliary(config.frame_ns)
        remote = {
            MEASUREMENT_BASE + peers.position: self.motion.take_position,
            MEASUREMENT_BASE + peers.motor_a: self.tach_a.take,
            MEASUREMENT_BASE + peers.motor_b: self.tach_b.take,
        }
        if peers.auxiliary is not None:  # the last of the four filters that go with the second mask
            remote[MEASUREMENT_BASE + peers.auxiliary] = self.auxiliary.take
        self.mail.update(remote)
        self.can.accept((FULL_MASK, [COMMAND_BASE + self.device_type]), (FULL_MASK, list(remote)))
        self.commands = self.common_commands() | axis_commands(self)
        self.fine: FineOutput | None = None
        """Set while parameter 12 or 13 is: duties finer than a PWM step, compensation."""
        self.observer = Observer()
        self.output = FineOutput(self.cpu, self.pwm, self.pi, self.counter, self.motion)
        self.output.changed = self._output_changed
        self.set_parameters(
            [
                *axis_parameters(self.motion, self.counter),
                *fine_parameters(self.output, self.motion),
                *observer_parameters(self.observer, self.output),
            ]
        )
        self.reset()

    def reset(self) -> None:
        """After power-up: off."""
        self.motion.off()
        self.motion.forget()
        self.tach_a.forget()
        self.tach_b.forget()
        self.auxiliary.forget()
        self.counter.start()
        self.observer.start()
        self.effort = 0
        self.effort_command: int | None = 0
        self.velocity = 0
        self.fault = False
        self.poscnt = self.qei.poscnt(self.queue.now_ns)
        self.watch.forget()
        self.packets.clear()

    def unpowered(self, t_ns: int) -> None:
        """The gates fall without supply."""
        self.pwm.write(t_ns, 0, 0)

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 5 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        poscnt = self.qei.poscnt(t_ns)
        self.velocity = velocity = difference(poscnt, self.poscnt)
        self.poscnt = poscnt
        self.watch.counts += velocity
        motion = self.motion
        setpoint = motion.setpoint(t_ns - self.epoch_ns, velocity)
        effort = self.effort_command
        counter = self.counter
        observer = self.observer
        aim = observer.aim(motion.steady, setpoint, velocity) if observer.on else setpoint
        if effort is None:
            effort = self.pi.step(aim, velocity)
        elif observer.on:
            self.pi.replace(effort << 16)
        if observer.on:
            effort = observer.step(self.pi, velocity)
        if self.fine is not None:
            effort = self.fine.drive(end, end - self.epoch_ns, velocity, setpoint, self.effort_command)
        else:
            counter.follow(effort, velocity)
            if effort >= 0:
                self.pwm.write(end, effort, counter.register)
            else:
                self.pwm.write(end, counter.register, -effort)
        self.effort = effort
        if self.ticks & 1:
            self._slow(t_ns, end)
        else:
            self._telemetry(t_ns, end, setpoint)

    def _output_changed(self) -> None:
        self.cost_ns = self.cpu.top.cost_ns
        self.fine = self.output if self.output.active else None

    def command_effort(self, effort: int | None) -> None:
        """Fixed effort in PWM steps, or None: the loop decides."""
        if effort is None and self.effort_command is not None:
            self.pi.start(self.effort_command, self.motion.setpoint_q16, self.velocity)
        self.effort_command = effort

    def powered(self) -> bool:
        """Whether the motors are under control."""
        return self.motion.mode is not AxisMode.OFF

    def _telemetry(self, t_ns: int, end_ns: int, setpoint: int) -> None:
        """Every 10 ms: MOTION frame and a sample of the packet."""
        motion = self.motion
        velocity = self.velocity
        limits = self.limits
        now = t_ns - self.epoch_ns
        if limits.hit(velocity) or (motion.mode in POINTING and not motion.fresh(now)):
            self.stop()
        mode = motion.mode
        status = mode | _POWERED if mode else 0
        if velocity:
            status |= _MOVING
        if limits.reached:
            status |= _LIMIT
        if self.fault:
            status |= _FAULT
        effort = self.effort * _EFFORT_SCALE // self.pwm.steps
        adc_a = self.adc.read(t_ns, 0)
        adc_b = self.adc.read(t_ns, 1)
        data = pack_motion(self.device_type, status, velocity, effort, (adc_a, adc_b), self.clip)
        self.transmit(self._identifier, data, end_ns)
        if mode == AxisMode.OPEN_LOOP:
            setpoint = NO_SETPOINT
        position = motion.measured(now, velocity) // UNITS_PER_STEP & 0x1FFF_FFFF
        tach_a, tach_b = self.tach_a.sample(now), self.tach_b.sample(now)
        aux = self.auxiliary.sample(now)
        sample = (effort, position, velocity, adc_a, adc_b, tach_a, tach_b, aux, setpoint)
        self.packets.take(t_ns, end_ns, sample)

    def _slow(self, t_ns: int, end_ns: int) -> None:
        """The ticks between: TARGET every 250 ms, heartbeat every second, spread so that three buffers do."""
        ticks = self.ticks
        if ticks % _TARGET_TICKS == 1:
            motion = self.motion
            now = t_ns - self.epoch_ns
            if not motion.fresh(now):
                self.watch.forget()
            elif self.watch.disagree(motion.measured(now, self.velocity)) and self.powered():
                self.trip()
            distance = motion.distance_steps(now, self.velocity)
            data = pack_target(self.device_type, motion.selected, motion.settled, distance, self.clip)
            self.refresh(SUMMARY_BASE + self.device_type, data, end_ns)
        elif ticks % _HEARTBEAT_TICKS == 3:
            self.heartbeat(end_ns)

    def trip(self) -> None:
        """Latch a fault and take the power off the motors; POWER clears it."""
        self.fault = True
        self.switch(False)

    def stop(self) -> None:
        """Brake to rest and stay there, in the velocity loop."""
        if self.powered():
            self.command_effort(None)
            self.motion.run(AxisMode.STOP, 0)
            self.motion.selected = 0

    def switch(self, on: bool) -> None:
        """Motors on, at rest in the velocity loop, or off."""
        if not on:
            self.motion.off()
            self.command_effort(0)
        elif not self.powered():
            self.fault = False
            self.command_effort(None)
            self.motion.run(AxisMode.STOP, 0)

    def state(self) -> State:
        """State byte of the heartbeat."""
        if self.fault:
            return State.FAULT
        return State.ACTIVE if self.powered() else State.READY

    def health(self) -> Health:
        """Adds position data, soft limit and fault to the common bits."""
        bits = super().health()
        if not self.motion.fresh(self.clock_ns(self.queue.now_ns)):
            bits |= Health.STALE
        if self.limits.reached:
            bits |= Health.LIMIT
        if self.fault:
            bits |= Health.FAULT | Health.SENSOR
        return bits
