"""`python -m tests.studies.paper.docs_page [--check]`: the page of the paper, from rows and finding.md."""

import sys
from pathlib import Path

from scenarios.studies.paper.experiments import EXPERIMENTS, Limit
from scenarios.studies.paper.scales import TABLE_2
from scenarios.studies.paper.starts import ANGLES_DEG, SEEDS
from tests.studies.paper.space import SPACE

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "paper.md"
FINDING = Path(__file__).with_name("finding.md")
"""What was found, written by hand."""

INTRODUCTION = f"""\
# The paper's experiments, row by row

`schmidt paper` repeats section 4 of *Design and development of telescope control system and software for the
50/80 cm Schmidt telescope* (Opt. Eng. 52(8) 081607, 2013). [The results](../results/experiments.md) have a
page of their own. This one says what decides each row. `python -m tests.studies.paper.docs_page` makes it
from the rows' files in `scenarios/studies/paper/experiments/`.

**How it is run.** Every experiment is a discrete run of the real axis board firmware on its emulated chips.
Its EnDat board, the bus and the plant are emulated, too. Commands go in as CAN frames. The log is what
the board sends every 10 ms: velocity as counts of the last 5 ms, control effort, ADC counts. One count is
2.296″/s. Start-up is discarded. Duties are whole PWM steps, the paper's firmware.

**From where.** Each row is measured from {len(ANGLES_DEG)} angles of the axis with {len(set(SEEDS))} seeds in
turn. The angles lie between {ANGLES_DEG[0]:g} and {ANGLES_DEG[-1]:g}° of the absolute encoder. A row is met
when every limit holds at every start. `--rows E1,E6` takes some rows, and `--quick` two starts for a look.

**Tests that must fail.** For every row a plant in `tests/studies/paper/` must miss it. Such plants have no
Coulomb friction, another inertia, gains ten times as high, a disturbance too large or another resistance.

"""


def _limit(limit: Limit) -> str:
    unit = "" if limit.unit == "1" else f" {limit.unit}"
    return f"| {limit.words} | {limit.bounds}{unit} |"


def page() -> str:
    """Return the page's text."""
    parts = [INTRODUCTION, FINDING.read_text(encoding="utf-8"), "## Row by row\n\n"]
    for row in EXPERIMENTS:
        limits = "\n".join(map(_limit, row.limits))
        said = row.said
        parts.append(
            f"### {row.id}: {said['title']} ({said['where']})\n\n> {said['quote']}\n\n"
            f"Published: {said['figure']}.\n\n{said['bound']}\n\n| figure | limit |\n|---|---|\n{limits}\n\n"
        )
    tolerances = {limit.figure: limit.high for row in EXPERIMENTS if row.id == "E7" for limit in row.limits}
    rows = "\n".join(
        f"| {key} | {TABLE_2['low'][key]:g} | {TABLE_2['high'][key]:g} | ±{tolerances[f'low {key}']:g} % |"
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
            print(f"{PAGE.name} is not what the rows say; run python -m tests.studies.paper.docs_page")
            return 1
        return 0
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
