"""Modules that are mutated, and the tests that have to notice."""

_CAN = ("tests/bus/can", "tests/boards/silicon/mcp2515/test_timing.py")
_CHIP = (
    "tests/boards/silicon/mcp2515/test_registers.py",
    "tests/boards/silicon/mcp2515/test_transmit.py",
    "tests/boards/silicon/mcp2515/test_receive.py",
    "tests/boards/silicon/mcp2515/test_modes_and_errors.py",
    "tests/boards/silicon/mcp2515/test_timing.py",
)
_ENDAT = ("tests/boards/silicon/test_endat.py", "tests/boards/silicon/test_endat_clocked.py")
_CODECS = "tests/bus/protocol"
_PROTOCOL = tuple(f"{_CODECS}/test_{name}.py" for name in ("codecs", "flags", "serial"))

TARGETS: dict[str, tuple[str, ...]] = {
    "boards/silicon/endat/crc.py": _ENDAT,
    "boards/silicon/mcp2515/chip.py": _CHIP,
    "boards/silicon/mcp2515/errorflags.py": _CHIP[3:],
    "boards/silicon/mcp2515/receive.py": _CHIP[2:3],
    "boards/silicon/mcp2515/registers.py": _CHIP,
    "boards/silicon/mcp2515/spi.py": _CHIP[:2],
    "boards/silicon/mcp2515/transmit.py": _CHIP[1:2],
    "boards/silicon/microchip_can/acceptance.py": _CHIP[2:3],
    "boards/silicon/microchip_can/bittiming.py": _CHIP[4:],
    "boards/silicon/microchip_can/message.py": _CHIP[1:3],
    "bus/can/bits.py": _CAN,
    "bus/can/confinement.py": (*_CAN, _CHIP[3]),
    "bus/can/disturbance.py": _CAN,
    "bus/can/recovery.py": (*_CAN, _CHIP[3]),
    "bus/protocol/command.py": _PROTOCOL,
    "bus/protocol/focus.py": _PROTOCOL,
    "bus/protocol/heartbeat.py": _PROTOCOL,
    "bus/protocol/motion.py": _PROTOCOL,
    "bus/protocol/position.py": _PROTOCOL,
    "bus/protocol/reply.py": _PROTOCOL,
    "bus/protocol/report.py": _PROTOCOL,
    "bus/protocol/serial.py": _PROTOCOL,
    "bus/protocol/tach.py": _PROTOCOL,
    "bus/protocol/target.py": _PROTOCOL,
}
