"""Steps that command the dome end when it is there; where there is none the step fails and says so."""

import json
from pathlib import Path

from tests.scenarios.conftest import SHORT, Command

STEPS = """\
network: {name: final}
steps:
  - dome: {azimuth: 6 deg}
  - dome: {shutter: open}
  - dome: {azimuth: 358 deg}
"""


def run(schmidt: Command, short: Path, text: str) -> list[dict[str, object]]:
    short.write_text(SHORT.partition("steps:")[0] + text)
    schmidt("run", short, "--out", "out")
    steps: list[dict[str, object]] = json.loads((short.parent / "out" / "summary.json").read_text())["steps"]
    return steps


def test_the_dome_turns_the_shorter_way_and_opens(schmidt: Command, short: Path) -> None:
    steps = run(schmidt, short, STEPS)
    assert [step["failed"] for step in steps] == ["", "", ""]
    took = [float(step["end_s"]) - float(step["start_s"]) for step in steps]  # type: ignore[arg-type]
    # 2°/s: 6° and, the shorter way, 8°, to within half a degree, a frame and a tick
    assert 2.5 < took[0] < 4 and 3.5 < took[2] < 5
