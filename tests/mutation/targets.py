"""Modules that are mutated, and the tests that have to notice, the quick ones first."""

from pathlib import Path

AIMS = {
    "bus": 95, "boards": 95, "plant/kernels": 95, "scenarios/run": 95, "calibration/decide": 90,
    "calibration": 85, "host": 85, "plant": 85, "scenarios": 85,
}  # fmt: skip
"""Rooms, the inner ones before those around them, and the share of mutants that is to be killed, per cent."""

_BITS = tuple(f"tests/bus/can/test_{name}.py" for name in ("bits", "disturbance"))
_ERRORS = tuple(f"tests/bus/can/test_{name}.py" for name in ("disturbance", "trouble"))
_RECOVERY = tuple(f"tests/bus/can/test_{name}.py" for name in ("recovery", "stuck", "trouble"))
_CHIP = (
    "tests/boards/chips/mcp2515/test_transmit.py",
    "tests/boards/chips/mcp2515/test_receive.py",
    "tests/boards/chips/mcp2515/test_modes_and_errors.py",
    "tests/boards/chips/mcp2515/test_timing.py",
    "tests/boards/chips/mcp2515/test_registers.py",
)
_TRANSMIT, _RECEIVE, _MODES, _TIMING, _REGISTERS = ((name,) for name in _CHIP)
_ENDAT = ("tests/boards/silicon/test_endat.py", "tests/boards/chips/test_endat_clocked.py")
_CODECS = "tests/bus/protocol"
_PROTOCOL = tuple(f"{_CODECS}/test_{name}.py" for name in ("edges", "flags", "codecs"))

TARGETS: dict[str, tuple[str, ...]] = {
    "boards/silicon/endat.py": _ENDAT,
    "boards/chips/mcp2515/chip.py": _CHIP,
    "boards/chips/mcp2515/receive.py": _RECEIVE,
    "boards/chips/mcp2515/registers.py": _CHIP,
    "boards/chips/mcp2515/spi.py": (*_TRANSMIT, *_REGISTERS),
    "boards/chips/mcp2515/transmit.py": _TRANSMIT,
    "boards/chips/mcp2515/bittiming.py": _TIMING,
    "boards/chips/mcp2515/message.py": (*_TRANSMIT, *_RECEIVE),
    "bus/can/bits.py": _BITS,
    "bus/can/confinement.py": ("tests/bus/can/test_confinement.py", *_ERRORS, *_MODES),
    "bus/can/disturbance.py": _ERRORS,
    "bus/can/length.py": _BITS,
    "bus/can/recovery.py": (*_RECOVERY, *_MODES),
    "bus/can/trouble.py": (
        "tests/bus/can/test_confinement.py",
        "tests/bus/outside/test_errorframes.py",
        "tests/bus/can/test_trouble_told.py",
        "tests/bus/can/test_plan.py",
        *_MODES,
        *_RECOVERY,
    ),
    "bus/protocol/command_layouts.py": _PROTOCOL,
    "bus/protocol/motion.py": _PROTOCOL,
    "bus/protocol/heartbeat.py": _PROTOCOL,
    "bus/protocol/nodes/codec.py": (f"{_CODECS}/test_nodes.py",),
    "bus/protocol/nodes/messages.py": (f"{_CODECS}/test_node_commands.py",),
    "bus/protocol/position.py": _PROTOCOL,
    "bus/protocol/report.py": (f"{_CODECS}/test_report.py",),
    "bus/protocol/saturate.py": _PROTOCOL,
    "bus/protocol/serial.py": (f"{_CODECS}/test_edges.py", f"{_CODECS}/test_serial.py"),
    "calibration/decide/accept.py": tuple(
        f"tests/calibration/decide/test_{n}.py" for n in ("accept", "select")
    ),
    "calibration/decide/verdict.py": (
        "tests/calibration/decide/test_rules.py",
        "tests/calibration/test_honesty.py",
    ),
    "scenarios/run/evaluate.py": tuple(
        f"tests/scenarios/run/test_{name}.py" for name in ("evaluate", "judge")
    ),
}


def modules(room: str) -> dict[str, tuple[str, ...]]:
    """Every module of a room with its tests: TARGETS', else those that mirror it."""
    files = sorted(Path(room).rglob("*.py"), key=str)
    code = [str(each) for each in files if each.name != "__init__.py"]
    return {path: TARGETS.get(path) or mirrored(path) for path in code if room_of(path) == room}


def room_of(path: str) -> str:
    """The first room of AIMS that a module lies in."""
    return next((room for room in AIMS if path.startswith(f"{room}/")), "")


def mirrored(path: str) -> tuple[str, ...]:
    """The test of the module's name; without one, all of the nearest folder that mirrors the module's."""
    folder = Path("tests", path).parent
    while not any(folder.glob("test_*.py")) and folder != Path("tests"):
        folder = folder.parent
    own = folder / f"test_{Path(path).stem}.py"
    return (str(own),) if own.exists() else tuple(sorted(map(str, folder.glob("test_*.py"))))
