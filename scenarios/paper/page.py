"""`python -m scenarios.paper.page [--check]`: docs/paper.md, from the rows' own files and finding.md."""

import sys
from pathlib import Path

from scenarios.paper.experiments import EXPERIMENTS, Limit
from scenarios.paper.published import TABLE_2, TABLE_2_TOLERANCE
from scenarios.paper.space import SPACE
from scenarios.paper.starts import ANGLES_DEG, SEEDS

PAGE = Path(__file__).parents[2] / "docs" / "paper.md"
FINDING = Path(__file__).with_name("finding.md")
"""What was found, written by hand."""

INTRODUCTION = f"""\
# The paper's experiments, and what decides each row

`schmidt paper` repeats section 4 of *Design and development of telescope control system and
software for the 50/80 cm Schmidt telescope* (Opt. Eng. 52(8) 081607, 2013) on the emulator and
prints published beside emulated; [paper-table.md](paper-table.md) is its last result. This page is
generated from the rows' files in `scenarios/paper/experiments/`.

**How it is run.** Every experiment is a discrete run of the real axis board firmware on its
emulated chips, with its EnDat board, over the emulated bus, against the plant. Commands go in as
CAN frames; the log is what the board sends every 10 ms: velocity as counts of the last 5 ms (one
count is 2.296″/s), control effort, ADC counts. Start-up is discarded. Duties are whole PWM steps,
the paper's firmware.

**From where.** Each row is measured from {len(ANGLES_DEG)} angles of the axis ({ANGLES_DEG[0]:g} to
{ANGLES_DEG[-1]:g}° of the absolute encoder) with seeds {", ".join(map(str, SEEDS))} in turn
(crystals, encoder phases, sensor noise); `--every` takes all {len(ANGLES_DEG) * len(SEEDS)}
combinations. The table has the median and the worst, and **a row is met when every limit holds
at every start**. `--rows E1,E6` takes some, `--quick` two starts for a look. The rows are
spread over the machine's processors.

**Tests that must fail.** `tests/paper/` has a plant for every row that must miss it: without
Coulomb friction, with another inertia, with gains ten times as high, with a disturbance too large,
with a motor of another resistance.

"""


def _limit(limit: Limit) -> str:
    unit = "" if limit.unit == "1" else f" {limit.unit}"
    return f"{limit.words} {limit.bounds}{unit}"


def page() -> str:
    """Return the page's text."""
    parts = [INTRODUCTION, FINDING.read_text(encoding="utf-8"), "\n## Row by row\n\n"]
    for row in EXPERIMENTS:
        limits = "; ".join(_limit(limit) for limit in row.limits)
        parts.append(
            f"### {row.id}: {row.title} ({row.where})\n\n> {row.quote}\n\nPublished: {row.figure}.\n\n"
            f"**Held to:** {row.bound}\n\n**Limits:** {limits}.\n\n"
        )
    rows = "\n".join(
        f"| {key} | {TABLE_2['low'][key]:g} | {TABLE_2['high'][key]:g} | ±{TABLE_2_TOLERANCE[key]:g} % |"
        for key in TABLE_2["low"]
    )
    parts.append(
        "## Table 2 and its tolerances\n\n| parameter | low | high | tolerance |\n|---|---|---|---|\n"
    )
    parts.append(
        f"{rows}\n\n## What the search may choose\n\n| number | bounds | unit | why |\n|---|---|---|---|\n"
    )
    parts += [
        f"| {free.name} | {free.low:g} to {free.high:g} | {free.unit} | {free.why} |\n" for free in SPACE
    ]
    return "".join(parts)


def main(arguments: list[str]) -> int:
    """Write the page, or with --check say whether it is current."""
    text = page()
    if "--check" in arguments:
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
            print(f"{PAGE.name} is not what the rows say; run python -m scenarios.paper.page")
            return 1
        return 0
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
