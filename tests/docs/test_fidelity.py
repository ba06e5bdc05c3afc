"""FIDELITY.md against the code: every row id is there, what it names exists, its figures are the code's."""

import re
from pathlib import Path

import pytest

from boards.axis import config as axis
from boards.core.board import BOOT_NS
from boards.core.interrupts import InterruptController, Line, Source
from boards.display import firmware as display
from boards.focus import config as focus
from boards.focus.config import FocusConfig
from boards.gateway import firmware as gateway
from boards.gateway.firmware import HOLD_NS
from boards.motor_velocity import firmware as motor
from boards.position import firmware as position
from boards.silicon.endat import EndatEncoder, EndatMaster
from boards.silicon.pwm import FCY_HZ, PWM_HZ, STEPS
from boards.silicon.uart import BAUD, Uart
from bus.protocol import Device
from bus.protocol.serial import packet_bytes
from bus.time import EventQueue
from host import client
from host.sky.site import NAINITAL
from plant import loop, model
from plant.effects import REGISTRY
from plant.stops import BEYOND_RAD
from plant.units import to_si
from scenarios.lab.chain import DROP_NS, FED_NS
from scenarios.lab.faults.table import KINDS
from scenarios.lab.network import CRYSTAL_DRIFT_PPM_PER_HOUR, CRYSTAL_PPM
from scenarios.language import model as scenario_model
from scenarios.studies.paper.scales import INERTIA
from tests.boards.lab import axis_config

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "FIDELITY.md").read_text(encoding="utf-8")
ROWS = {"P": 13, "B": 9, "L": 3, "H": 7, "E": 10}
"""Rows of the requirements: letter and last number."""
IDS = [f"{letter}{number}" for letter, last in ROWS.items() for number in range(1, last + 1)]


def of(table: tuple[Source, ...], fcy_hz: int, name: str) -> Line:
    return InterruptController(EventQueue(), fcy_hz, table).lines[name]


AXIS = of(axis.TABLE, axis.FCY_HZ, "control")
POSITION = of(position.TABLE, position.FCY_HZ, "sample")
GATEWAY = of(gateway.TABLE, gateway.FCY_HZ, "usb")
PLANT = model.load("low_preload")
RA, DEC, FOCUS = PLANT.axes.ra, PLANT.axes.dec, PLANT.focus
LOOP_OHM = RA.motor.switch_resistance.si + RA.motor.sense_resistance.si
FIGURES = {
    "| interrupt latency, dsPIC30F |": f"{AXIS.latency_ns} ns",
    "| interrupt latency, PIC18 |": f"{POSITION.latency_ns} ns (gateway {GATEWAY.latency_ns} ns)",
    "| axis control routine |": f"{AXIS.cost_ns} ns",
    "| axis, answer to a command |": f"{of(axis.TABLE, axis.FCY_HZ, 'can').cost_ns} ns",
    "| position routine, EnDat included |": f"{POSITION.cost_ns} ns",
    "| EnDat transfer |": f"{EndatMaster(EndatEncoder(lambda t: t)).latch_to_data_ns} ns",
    "| motor velocity routine |": f"{of(motor.TABLE, motor.FCY_HZ, 'sample').cost_ns} ns",
    "| focus sample, step routine |": ", ".join(
        f"{of(focus.TABLE, focus.FCY_HZ, name).cost_ns} ns" for name in ("sample", "step")
    ),
    "| display refresh |": f"{of(display.TABLE, display.FCY_HZ, 'refresh').cost_ns} ns",
    "| gateway, unpacking a report |": f"{GATEWAY.cost_ns} ns",
    "| gateway hold |": f"{HOLD_NS} ns",
    "| PWM |": f"{1_000_000_000 // PWM_HZ} ns",
    "| serial packet, axis |": f"{Uart(EventQueue()).duration_ns(packet_bytes(Device.AXIS_RA))} ns | "
    f"{packet_bytes(Device.AXIS_RA)} bytes × 10 bits at {BAUD} baud (position "
    f"{packet_bytes(Device.POSITION_RA)} bytes, focus {packet_bytes(Device.FOCUS)})",
    "| plant grid |": f"{PLANT.numerics.grid.si * 1e6:g} µs",
    "| boot |": f"{BOOT_NS // 1_000_000} ms",
    "| host |": f"ticks of {client.TICK_NS // 1_000_000} ms, answer within "
    f"{client.REPLY_TIMEOUT_NS // 1_000_000} ms",
    "| velocity loop of the search and calibration |": f"{loop.LATENCY_S * 1e6:g} µs",
    "| P1 | RA axis |": f"inertia {INERTIA:g} kg m²",
    "| P1 | Dec axis |": f"inertia {DEC.inertia.si:g} kg m²",
    "| P1 | both trains | stiffness": f"{RA.gear.stiffness.si * 1e3:.3g}".replace("e+0", "e") + " / ",
    "| P4 | loop |": f"R + {LOOP_OHM:g} Ω",
    "| P4 | safety chain |": f"watchdogs of {FED_NS // 10**6} ms on demand; a contactor cuts both drives "
    f"{DROP_NS // 10**6} ms later",
    "| P4 | supply |": f"{PLANT.supply.voltage.si:g} V",
    "| P5 | bearings, Dec |": f"by {DEC.friction.viscous.si / RA.friction.viscous.si:.2f}",
    "| P6 | disturbances |": f"{len(REGISTRY) - 1} named effects",
    "| P9 | CP-850 |": f"{RA.encoders.tachometer.si:g} counts",
    "| P11 | focus | encoder": f"{FOCUS.encoder.si:g} counts",
    "| P12 | LVDT |": f"0–{FOCUS.lvdt_full_scale.si:g} V over ±5 mm, {FOCUS.lvdt_gain_error.si:.0%} gain, "
    f"{FOCUS.lvdt_offset.si * 1e3:g} mV offset, {FOCUS.lvdt_nonlinearity.si:.1%} bend",
    "| B1 | axis: PWM |": f"{STEPS} steps at {PWM_HZ // 1000} kHz and {FCY_HZ // 10**6} MIPS",
    "| B5 | focus: stepper |": f"ramp {FocusConfig().start_rate}–{FocusConfig().top_rate} half steps/s",
    "| B9 | all: crystal |": f"±{CRYSTAL_PPM:g} ppm, ±{CRYSTAL_DRIFT_PPM_PER_HOUR:g} ppm/h",
    "| P1 | site |": f"height {NAINITAL.height_m:g} m, {NAINITAL.temperature_c:g} °C, "
    f"{NAINITAL.humidity:.0%} humidity",
    "| P1 | mount: hard stops |": f"buffers {BEYOND_RAD / to_si(1, 'deg'):.0f}° beyond",
    "| P1 | mount | travel": f"±{scenario_model.HOUR_ANGLE_LIMIT_RAD / to_si(1, 'deg'):.0f}°",
}
"""How a row begins, and a figure that it must hold."""


def row(start: str) -> str:
    found = [text for text in PAGE.splitlines() if text.startswith(start)]
    assert len(found) == 1, f"{len(found)} rows start with {start!r}"
    return found[0]


@pytest.mark.parametrize("start", FIGURES)
def test_figures_are_those_of_the_code(start: str) -> None:
    assert FIGURES[start].replace("%", " %") in row(start).replace("  %", " %")


def test_rates_of_the_speed_classes_are_those_of_the_code() -> None:
    scale = 1_296_000 / 112_896_000 * 200 / 65536
    slew, set_, guide, fine, track = (round(rate * scale, 3) for rate in axis_config().classes)
    text = row("| B2 | axis: speeds |")
    assert f"slew {slew:g}, track {track:g}″/s" in text
    assert f"set {set_:g}, guide {guide:g}, fine {fine:g}″/s" in text


@pytest.mark.parametrize("name", IDS)
def test_every_requirement_has_a_row(name: str) -> None:
    assert re.search(rf"^\| {name} \| ", PAGE, re.MULTILINE), f"FIDELITY.md has no row for {name}"


def test_every_effect_is_on_the_page() -> None:
    missing = [name for name in REGISTRY if f"`{name}`" not in PAGE.split("## Effects")[1].split("\n## ")[0]]
    assert not missing


def test_every_file_it_names_exists() -> None:
    named = set(re.findall(r"`((?:[\w.-]+/)+[\w.-]+)`", PAGE))
    assert len(named) > 20
    missing = sorted(name for name in named if not (ROOT / name).exists())
    assert not missing, f"FIDELITY.md names files that do not exist: {', '.join(missing)}"


def test_every_test_it_names_exists() -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    known = set(re.findall(r"def (test_\w+)", text))
    named = set(re.findall(r"(?<![\w/])(test_\w+)(?!\w|\.py)", PAGE))
    assert len(named) > 50
    assert not named - known, f"FIDELITY.md names tests that do not exist: {', '.join(sorted(named - known))}"


CHIPS = {
    "adc": ("| B1 | axis: ADC |",),
    "can": ("| B9 | all: CAN controller |",),
    "dspic30f": ("| dsPIC30F QEI |", "| dsPIC30F PWM |", "| dsPIC30F ADC |"),
    "ecan": ("| ECAN |",),
    "endat": ("| EnDat 2.1/2.2 |", "| B3 | position: EnDat |"),
    "hid": ("| B7 | gateway: USB |",),
    "mcp2515": (
        "| MCP2515 | SPI", "| MCP2515 | register map", "| MCP2515 | three transmit",
        "| MCP2515 | two receive", "| MCP2515 | modes", "| MCP2515 | TEC", "| MCP2515 | errata",
        "| MCP2515 | CNF1", "| MCP2515 | a wrong bit rate",
    ),
    "pic18f4431": ("| PIC18F4431 QEI |",),
    "pwm": ("| B1 | axis: PWM |", "| B1 | axis: spread duty"),
    "qei": ("| B1 | axis: QEI |",),
    "quadrature": ("| dsPIC30F QEI |", "| PIC18F4431 QEI |"),
    "stepper": ("| B5 | focus: stepper |", "| stepper |"),
    "uart": ("| B9 | five: RS232 |",),
    "uartline": ("| UART |",),
    "usb": ("| USB HID |",),
}  # fmt: skip
"""Chip, file or package in `boards/silicon` or `boards/chips`, to the rows that say how it behaves."""


def test_every_chip_has_its_rows() -> None:
    folders = [ROOT / "boards" / name for name in ("silicon", "chips")]
    there = {path.stem for folder in folders for path in folder.iterdir() if path.stem[0] != "_"}
    assert there == set(CHIPS)
    missing = [begin for rows in CHIPS.values() for begin in rows if f"\n{begin}" not in PAGE]
    assert missing == []


def test_every_fault_has_a_row_that_says_what_is_simpler() -> None:
    section = PAGE.partition("\n## Faults\n")[2].partition("\n## ")[0]
    rows = [line.split(" | ") for line in section.splitlines() if line.startswith("| `")]
    assert [cells[0].strip("|` ") for cells in rows] == [kind.name for kind in KINDS]
    assert all(len(cells) == 3 and len(cells[2]) > 10 for cells in rows)
