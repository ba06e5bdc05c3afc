"""The emulator's own logs, row by row: what was added to the plant, how it was driven, what must be said.

Every case goes through the network of boards as `schmidt run` builds it (10-bit converters, 29-bit encoder,
5 ms counts, clocks that drift) and through `schmidt calibrate`. Axes are driven together; what is added acts
on the axis it names, so the other axis of the same run is a case without an effect.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml

from calibration.command import calibrate
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.plants import plant_model
from scenarios.run import run as runner

Move = tuple[str, dict[str, Any]]


def rate(arcsec_per_s: float, seconds: float) -> Move:
    return "set_rate", {"rate": f"{arcsec_per_s} arcsec/s", "for": f"{seconds} s"}


def both_ways(*moves: tuple[float, float]) -> list[Move]:
    return [rate(sign * speed, time) for speed, time in moves for sign in (1, -1)]


def rests() -> list[Move]:
    """Moves with a stop and a rest after each: the board holds, or is off, with gains of its own."""
    moves = []
    for speed in (3000, -600, 7200, -7200, 300, -3000, 1500, -1500, 5400):
        moves += [rate(speed, 13), ("stop", {}), ("wait", {"for": "3 s"})]
    return moves


def efforts() -> list[Move]:
    """Loop open, both ways; shares of the supply on right ascension (declination gets six tenths)."""
    levels = ((0.17, 12), (0.14, 12), (0.24, 14), (0.2, 12))
    moves: list[Move] = []
    for sign in (1, -1):
        moves += [("open_loop", {"effort": sign * e, "for": f"{t} s"}) for e, t in levels]
        moves += [("stop", {}), ("wait", {"for": "2 s"})]
    return [
        *moves,
        ("open_loop", {"effort": 0.18, "for": "8 s"}),
        ("open_loop", {"effort": -0.22, "for": "8 s"}),
    ]


RATES = both_ways((60, 10), (200, 10), (600, 10), (3600, 10), (7200, 12), (30, 4), (1500, 10), (5400, 10))
FIRST = both_ways((1500, 10), (300, 8), (6600, 10), (60, 8))
SECOND = both_ways((1000, 10), (4800, 10), (120, 8), (7200, 8))


@dataclass(frozen=True)
class Drive:
    """One plant, driven through one scenario per session."""

    plant: str
    sessions: tuple[list[Move], ...]
    effects: tuple[dict[str, Any], ...] = ()


DRIVES = {
    "rests": Drive(
        "low-preload",
        (rests(),),
        ({"name": "gear_eccentricity", "axis": "ra", "stage": "shaft1", "parameters": {"amplitude": 17}},),
    ),
    "open": Drive("low-preload-motor-units", (efforts(),)),
    "sessions": Drive("low-preload-motor-units", (FIRST, SECOND), ({"name": "adc_offset", "axis": "dec"},)),
    "rates": Drive(
        "high-preload",
        (RATES,),
        ({"name": "torque_ripple", "axis": "ra"}, {"name": "friction_asymmetry", "axis": "dec"}),
    ),
}

#: drive, axis, name (None: nothing), a parameter with the value that was put in
CASES: list[tuple[str, str, str | None, tuple[str, float] | None]] = [
    ("rests", "ra", "gear_eccentricity", ("amplitude", 17.0)),
    ("rests", "dec", None, None),
    ("open", "ra", None, None),
    ("open", "dec", None, None),
    ("sessions", "ra", None, None),
    ("sessions", "dec", "adc_offset", None),
    ("rates", "ra", "torque_ripple", ("ripple", 0.05)),
    ("rates", "dec", "friction_asymmetry", ("coulomb_asymmetry", 0.15)),
]


def scenario(drive: Drive, moves: list[Move], session: int) -> str:
    """The scenario file of one session; declination follows its own line beside right ascension."""
    steps: list[dict[str, Any]] = [{"power_on": {}}, {"name": "dec", "wait": {"for": "0.1 s"}}]
    before = "dec"
    for k, (action, given) in enumerate(moves):
        here, there = dict(given), dict(given)
        if action != "wait":
            here["axis"], there["axis"] = "ra", "dec"
        if "effort" in there:
            there["effort"] *= 0.6
        steps.append({"name": f"ra{k}", action: here})
        steps.append({"name": f"dec{k}", action: there, "after": before})
        before = f"dec{k}"
    return yaml.safe_dump(
        {
            "name": f"Session {session}",
            "seed": 5 + session,
            "plant": {"file": drive.plant, "effects": list(drive.effects)},
            "start_utc": f"2026-02-10T14:{10 * session:02d}:00Z",
            "steps": [*steps, {"wait": {"for": "1 s"}}, {"stop": {"axis": "both"}}],
        }
    )


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], list[Path]]:
    """Logs of one drive and axis; a drive is run once."""
    folders: dict[str, list[Path]] = {}

    def made(name: str, axis: str) -> list[Path]:
        if name not in folders:
            folders[name] = []
            for k, moves in enumerate(DRIVES[name].sessions):
                folder = tmp_path_factory.mktemp(f"{name}{k}")
                given = convert(parse(scenario(DRIVES[name], moves, k), folder / "scenario.yaml"))
                runner.run(given, plant_model(given.plant, folder), folder, lambda *_: None)
                folders[name].append(folder)
        return [folder / f"axis-{axis}.csv" for folder in folders[name]]

    return made


@pytest.mark.long
@pytest.mark.parametrize(("drive", "axis", "name", "parameter"), CASES)
def test_what_was_added_is_named_and_nothing_else(
    drive: str,
    axis: str,
    name: str | None,
    parameter: tuple[str, float] | None,
    logs: Callable[[str, str], list[Path]],
    tmp_path: Path,
) -> None:
    assert calibrate(logs(drive, axis), out=tmp_path, plots=False) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    too_short = [x for x in report["refused"] if "independent blocks" in x["why"]]
    assert not too_short, "a log that is too short for any name proves nothing"
    assert [e["name"] for e in report["effects"]] == ([] if name is None else [name]), report["effects"]
    if parameter is not None:
        found = report["effects"][0]["parameters"][parameter[0]]["value"]
        assert found == pytest.approx(parameter[1], rel=0.05)
