"""Modules that are mutated, and the tests that have to notice."""

_BITS = tuple(f"tests/bus/can/test_{name}.py" for name in ("bits", "disturbance"))
_ERRORS = tuple(f"tests/bus/can/test_{name}.py" for name in ("disturbance", "trouble"))
_RECOVERY = tuple(f"tests/bus/can/test_{name}.py" for name in ("recovery", "trouble", "stuck"))
_CHIP = (
    "tests/boards/silicon/mcp2515/test_registers.py",
    "tests/boards/silicon/mcp2515/test_transmit.py",
    "tests/boards/silicon/mcp2515/test_receive.py",
    "tests/boards/silicon/mcp2515/test_modes_and_errors.py",
    "tests/boards/silicon/mcp2515/test_timing.py",
)
_ENDAT = ("tests/boards/silicon/test_endat.py", "tests/boards/silicon/test_endat_clocked.py")
_CODECS = "tests/bus/protocol"
_PROTOCOL = tuple(f"{_CODECS}/test_{name}.py" for name in ("edges", "flags", "codecs"))

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
    "bus/can/bits.py": _BITS,
    "bus/can/confinement.py": ("tests/bus/can/test_confinement.py", *_ERRORS, _CHIP[3]),
    "bus/can/disturbance.py": _ERRORS,
    "bus/can/length.py": _BITS,
    "bus/can/recovery.py": (*_RECOVERY, _CHIP[3]),
    "bus/can/trouble.py": (
        *_ERRORS,
        *_RECOVERY,
        "tests/bus/can/test_confinement.py",
        "tests/bus/test_errorframes.py",
        _CHIP[3],
    ),
    "bus/protocol/command.py": _PROTOCOL,
    "bus/protocol/focus.py": _PROTOCOL,
    "bus/protocol/heartbeat.py": _PROTOCOL,
    "bus/protocol/motion.py": _PROTOCOL,
    "bus/protocol/nodes/codec.py": (f"{_CODECS}/test_nodes.py",),
    "bus/protocol/nodes/command.py": (f"{_CODECS}/test_nodes.py",),
    "bus/protocol/position.py": _PROTOCOL,
    "bus/protocol/reply.py": _PROTOCOL,
    "bus/protocol/report.py": (f"{_CODECS}/test_report.py",),
    "bus/protocol/saturate.py": _PROTOCOL,
    "bus/protocol/serial.py": (f"{_CODECS}/test_edges.py", f"{_CODECS}/test_serial.py"),
    "bus/protocol/signed.py": _PROTOCOL,
    "bus/protocol/tach.py": _PROTOCOL,
    "bus/protocol/target.py": _PROTOCOL,
}
