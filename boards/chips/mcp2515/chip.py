"""MCP2515: modes, interrupts, registers, and its place between SPI and the bus (DS20001801)."""

from collections.abc import Callable

from boards.chips.mcp2515 import registers as at
from boards.chips.mcp2515.bittiming import BitTimes, decode
from boards.chips.mcp2515.receive import Receiver
from boards.chips.mcp2515.registers import Interrupt, Mode, error_flags
from boards.chips.mcp2515.spi import SpiPort
from boards.chips.mcp2515.transmit import Transmitter
from bus.can import Frame, Port
from bus.can.length import frame_bits
from bus.time import EventQueue

FOSC_HZ = 16_000_000
"""Crystal. ASSUMPTION: the paper names none."""
_TX_FLAGS = (Interrupt.TX0, Interrupt.TX1, Interrupt.TX2)


class Mcp2515:
    """A controller on `port`, whose crystal has `fosc_hz`; SPI is at once, at the queue's present time.

    interrupt: called with (t_ns, asserted) when the INT pin changes. errata: the transmit request that is
    still selected when its frame is through sends the frame twice (DS80179G).
    """

    def __init__(
        self, queue: EventQueue, port: Port, fosc_hz: int = FOSC_HZ, *, errata: bool = False
    ) -> None:
        self.port = port
        self.interrupt: Callable[[int, bool], None] | None = None
        self._queue = queue
        self._errata = errata
        self._memory = bytearray(at.SIZE)
        self._rts_pins = 7
        self._requested = 0
        self._flags = 0
        self._asserted = False
        self.mode = Mode.CONFIGURATION
        self._fosc_hz = fosc_hz
        self.times: BitTimes
        self.receiver = Receiver(self._memory)
        self.transmitter = Transmitter(self._memory, self._offer, port.withdraw)
        self.spi = SpiPort(self)
        port.watcher = self
        port.on_receive = self._received
        port.on_sent = self._sent
        self.reset()

    # --- pins ---------------------------------------------------------------------------------------
    def transfer(self, data: bytes) -> bytes:
        """One SPI transaction with its chip select; as many bytes come back as go in."""
        return self.spi.transfer(data)

    @property
    def interrupt_pin(self) -> bool:
        """INT asserted (low)."""
        return bool(self._memory[at.CANINTF] & self._memory[at.CANINTE])

    def buffer_full_pin(self, buffer: int) -> bool | None:
        """Level of RXnBF; None: high impedance."""
        control = self._memory[at.BFPCTRL]
        if not control >> (2 + buffer) & 1:
            return None
        if control >> buffer & 1:
            return not self._memory[at.CANINTF] >> buffer & 1
        return bool(control >> (4 + buffer) & 1)

    def drive_rts_pin(self, buffer: int, level: bool) -> None:
        """TXnRTS: a falling edge requests a transmission where TXRTSCTRL allows it."""
        bit = 1 << buffer
        fell = self._rts_pins & bit and not level
        self._rts_pins = self._rts_pins & ~bit | (bit if level else 0)
        if fell and self._memory[at.TXRTSCTRL] & bit:
            self.request_to_send(bit)

    # --- what SPI acts on ----------------------------------------------------------------------------
    def reset(self) -> None:
        """RESET instruction, RESET pin, power-up: configuration mode, registers as in the data sheet."""
        memory = self._memory
        memory[:] = bytes(at.SIZE)
        memory[at.CANCTRL] = at.CANCTRL_AT_RESET
        self.receiver.refilter()
        self._enter(Mode.CONFIGURATION)
        self._update_pin()

    def read(self, address: int) -> int:
        """A register's value now."""
        address = at.canonical(address)
        if address == at.CANSTAT:
            return self.mode | self._interrupt_code() << 1
        if address == at.TEC:
            return min(self.port.tec, 255)
        if address == at.REC:
            return self.port.rec
        if address == at.EFLG:
            return self._memory[address] | self._error_flags()
        if address == at.TXRTSCTRL:
            enabled = self._memory[address]
            return enabled | (self._rts_pins & ~enabled) << 3
        if address in at.HIDDEN and self.mode != Mode.CONFIGURATION:
            return 0
        return self._memory[address]

    def write(self, address: int, value: int, mask: int = 0xFF) -> None:
        """Change the bits of `mask` that the microcontroller may change, with what follows from it."""
        address = at.canonical(address)
        mask &= at.WRITABLE[address]
        if not mask or (address in at.CONFIGURATION_ONLY and self.mode != Mode.CONFIGURATION):
            return
        if self._locked(address):
            return
        old = self._memory[address]
        new = old & ~mask | value & mask
        if address in at.TXBCTRL:
            self._request(at.TXBCTRL.index(address), new, asked=bool(value & mask & at.TXREQ))
            return
        self._memory[address] = new
        if address == at.CANCTRL:
            self._control(new)
        elif address in (at.CANINTE, at.CANINTF):
            self._flags_written()
        elif address == at.RXBCTRL[0]:
            self._memory[address] = new & ~2 | (new & at.BUKT) >> 1
        elif address in at.HIDDEN:
            self.receiver.refilter()

    def modify(self, address: int, mask: int, value: int) -> None:
        """BIT MODIFY; a register that does not know it is written whole."""
        known = at.canonical(address) in at.BIT_MODIFIABLE
        self.write(address, value, mask if known else 0xFF)

    def request_to_send(self, buffers: int) -> None:
        """RTS for a set of buffers."""
        for buffer, address in enumerate(at.TXBCTRL):
            if buffers >> buffer & 1:
                self._request(buffer, self._memory[address] | at.TXREQ, asked=True)

    def read_status(self) -> int:
        """Flags and requests, as READ STATUS orders them."""
        flags, memory = self._memory[at.CANINTF], self._memory
        status = flags & 3
        for buffer, address in enumerate(at.TXBCTRL):
            status |= (bool(memory[address] & at.TXREQ) | (flags >> (2 + buffer) & 1) << 1) << (
                2 + 2 * buffer
            )
        return status

    def rx_status(self) -> int:
        """What lies in the receive buffers."""
        return self.receiver.status(self._memory[at.CANINTF])

    def deselected(self, buffer: int | None) -> None:
        """Chip select has risen: what READ RX BUFFER has read is free."""
        self._requested = 0
        if buffer is not None:
            self._set_flags(0, clear=1 << buffer)

    # --- modes ------------------------------------------------------------------------------------------
    def _control(self, value: int) -> None:
        if value & at.ABAT:
            self.transmitter.abort_all()
        self._try_mode()
        self._pump()

    def _try_mode(self) -> None:
        """Enter the requested mode; from normal mode only once nothing waits to be sent."""
        wanted = self._memory[at.CANCTRL] & 0xE0
        if wanted not in tuple(Mode) or wanted == self.mode or self.mode is Mode.SLEEP:
            return
        if self.mode in (Mode.NORMAL, Mode.LOOPBACK) and self.transmitter.pending:
            return
        self._enter(Mode(wanted))

    def _enter(self, mode: Mode) -> None:
        self.mode = mode
        port = self.port
        self.transmitter.forget()
        port.asleep = mode is Mode.SLEEP
        memory = self._memory
        self.times = decode(self._fosc_hz, memory[at.CNF1], memory[at.CNF2], memory[at.CNF3])
        if mode not in (Mode.NORMAL, Mode.LISTEN_ONLY):
            port.online = False
            return
        port.timing = self.times.wire_timing()
        port.listen_only = mode is Mode.LISTEN_ONLY
        port.online = True
        if port.listen_only:
            port.tec = port.rec = 0
        self._flags = self._error_flags()

    def activity(self, t_ns: int) -> None:
        """The bus has moved while the chip slept: it wakes into listen-only mode, if it may."""
        if self._memory[at.CANINTE] & Interrupt.WAK:
            self._set_flags(Interrupt.WAK)
            self._enter(Mode.LISTEN_ONLY)

    # --- sending ------------------------------------------------------------------------------------
    def _locked(self, address: int) -> bool:
        """Whether `address` is in a transmit buffer that waits to be sent."""
        row = address & 0x70
        return row in at.TXBCTRL and address != row and bool(self._memory[row] & at.TXREQ)

    def _request(self, buffer: int, value: int, *, asked: bool) -> None:
        """TXBnCTRL becomes `value`. asked: this instruction is what sets TXREQ."""
        if asked and self.spi.selected:
            self._requested |= 1 << buffer
        self.transmitter.control(buffer, value)
        self._pump()
        self._try_mode()

    def _pump(self) -> None:
        if self.mode is Mode.NORMAL:
            self.transmitter.pump()
        elif self.mode is Mode.LOOPBACK:
            self._loop()

    def _offer(self, frame: Frame) -> None:
        self.port.send(frame, self._queue.now_ns)

    def _loop(self) -> None:
        """Loop-back: the frame takes its time and reaches nobody but the chip itself."""
        transmitter = self.transmitter
        buffer = transmitter.best()
        if transmitter.on_bus or buffer is None:
            return
        frame = transmitter.frame(buffer)
        looped = transmitter.take(buffer, frame)
        duration = round(frame_bits(frame) * 1e9 / self.times.bitrate)

        def through(t_ns: int) -> None:
            if transmitter.current is looped:
                self._received(t_ns, frame)
                self._sent(t_ns, frame)

        self._queue.at(self._queue.now_ns + duration, through)

    def _sent(self, _t_ns: int, _frame: Frame) -> None:
        buffer = self.transmitter.sent()
        if buffer is None:
            return
        self._set_flags(_TX_FLAGS[buffer])
        if self._errata and self.spi.selected and self._requested >> buffer & 1:
            self._requested &= ~(1 << buffer)
            self._memory[at.TXBCTRL[buffer]] |= at.TXREQ
        self._pump()
        self._try_mode()

    # --- what the bus tells -----------------------------------------------------------------------
    def began(self, t_ns: int) -> None:
        """The offered frame is on the bus."""
        self.transmitter.on_bus = self.transmitter.current is not None

    def lost(self, t_ns: int) -> None:
        """Arbitration lost."""
        self.transmitter.missed(at.MLOA)
        self._try_mode()

    def failed(self, t_ns: int, *, sending: bool) -> None:
        """An error frame."""
        self._set_flags(Interrupt.MERR)
        if sending:
            self.transmitter.missed(at.TXERR)
        self.counted(t_ns)
        self._try_mode()

    def counted(self, t_ns: int) -> None:
        """Counters have moved: entering a worse state is an error interrupt."""
        flags = self._error_flags()
        if flags & ~self._flags:
            self._set_flags(Interrupt.ERR)
        self._flags = flags

    def _received(self, _t_ns: int, frame: Frame) -> None:
        flags, overflow = self.receiver.take(frame, self._memory[at.CANINTF])
        if overflow:
            self._memory[at.EFLG] |= overflow
            flags |= Interrupt.ERR
        self._set_flags(flags)

    # --- interrupts -------------------------------------------------------------------------------------
    def _error_flags(self) -> int:
        port = self.port
        return error_flags(port.tec, port.rec, bus_off=port.state == "bus_off")

    def _interrupt_code(self) -> int:
        active = self._memory[at.CANINTF] & self._memory[at.CANINTE]
        return next((code for flag, code in at.ICOD if active & flag), 0)

    def _set_flags(self, flags: int, clear: int = 0) -> None:
        self._memory[at.CANINTF] = (self._memory[at.CANINTF] | flags) & ~clear & 0xFF
        self._update_pin()

    def _flags_written(self) -> None:
        """CANINTE or CANINTF were written: WAKIF set by the microcontroller wakes the chip too."""
        if self.mode is Mode.SLEEP and self._memory[at.CANINTF] & self._memory[at.CANINTE] & Interrupt.WAK:
            self._enter(Mode.LISTEN_ONLY)
        self._update_pin()

    def _update_pin(self) -> None:
        asserted = self.interrupt_pin
        if asserted != self._asserted:
            self._asserted = asserted
            if self.interrupt is not None:
                self.interrupt(self._queue.now_ns, asserted)
