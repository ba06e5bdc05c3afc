"""`python docs/example/page.py FOLDER`: keep the pictures and write README.md, from what a run left there.

The command is `schmidt calibrate docs/example/*.csv --out FOLDER`; every figure comes from its report.json.
"""

import base64
import hashlib
import json
import re
import sys
from pathlib import Path
from typing import Any

from plant.model import load

HERE = Path(__file__).resolve().parent
PICTURES = {
    "Fitted rows, the declared model": "residual.png",
    "Rows that nothing was fitted to": "held-out.png",
}
"""File by the start of the caption; the first picture of the report that has it."""
PAGE = """# A log in, a corrected plant out

The runs in this folder are logs of the right ascension axis, as `schmidt run` writes them. They are three
closed-loop runs at rates from {slow} to {fast}″/s, both ways. Something acted on the axis that is in no plant
file. What it was is in `truth.json`, which the finder does not read; its SHA-256 is `{digest}`.

One command looks for it:

    schmidt calibrate docs/example/*.csv --out out/example

It holds out `{held}`, calibrates the declared model again on the others, and answers **{verdict}**:

| | |
|---|---|
| name | {name} |
| parameters | {parameters} |
| held-out torque error | {before} N m before, **{after} N m** after, floor {floor} N m |
{again}{others}| not identifiable from these runs | {missing} |

"Before" is the declared model with its own parameters calibrated again on the same runs. "Floor" is what the
sensors leave. "Replayed closed loop" drives the held-out run's set points once more through either plant,
and compares with the log. The residual, over the phase of the order that explains it, on rows that were
fitted:

![Residual over the phase of the order that explains it: {name}](residual.png)

The same channel on the held-out rows, before and after:

![Held-out residual before and after](held-out.png)

`out/example/report.html` has the rest: spectrum over order with the gear table, surrogates, controls.
`out/example/plant.yaml` is the corrected plant, and the emulator runs on it:

    schmidt run scenarios/quick-look.yaml --plant out/example/plant.yaml --out out/example-night

## The seal, opened
It was {truth}. Beside the declared effects the corrected plant has:

{found}

The report gives the phase of the torque that the motors supply against an effect, as a cosine. The plant file
gives that of the torque on the axis, as a sine.

The drive is `low_preload_bridge` with that one effect added. `seal.py` made the runs, `page.py` this page.
A test, `tests/docs/test_example.py`, repeats the calibration and compares it with the seal.
"""


def keep_pictures(html: str) -> None:
    """Write the pictures that the page shows; StopIteration when the report has none with a caption."""
    found = re.findall(r'<img src="data:image/png;base64,([^"]+)" alt="([^"]+)"', html)
    for start, file in PICTURES.items():
        data = next(data for data, alt in found if alt.startswith(start))
        (HERE / file).write_bytes(base64.b64decode(data))


def number(name: str, p: dict[str, Any]) -> str:
    """A parameter with its interval, to the digits the interval is good for."""
    return f"{name} {p['value']:.4g} ({p['low']:.4g} to {p['high']:.4g}) {p['unit']}"


def in_words(name: str, stage: str | None, harmonic: int | None) -> str:
    """`gear_mesh` on mesh2, harmonic 1."""
    return f"`{name}`" + (f" on {stage}, harmonic {harmonic}" if stage else "")


def page(report: dict[str, Any], plant: Path) -> str:
    """The page's text."""
    text = (HERE / "truth.json").read_bytes()
    truth = json.loads(text)
    first, *others = report["effects"]
    torque = report["error"]["torque"]
    rates = [float(x.split()[0]) * (3600 if "deg" in x else 1) for x in _rates()]
    name = in_words(first["name"], first["stage"], first["harmonic"])
    parameters = "; ".join(number(k, p) for k, p in first["parameters"].items())
    sealed = ", ".join(f"{k} {p['value']:g} {p['unit']}" for k, p in truth["parameters"].items())
    named = {(e["name"], e["stage"], e["harmonic"]) for e in report["effects"]}
    made = [e for e in load(plant).axes.ra.effects if (e.name, e.stage, e.harmonic) in named]
    fitted = "\n".join(
        f"- {in_words(e.name, e.stage, e.harmonic)}: "
        + ", ".join(f"{k} {n.value:.4g} {n.unit}" for k, n in e.parameters.items())
        for e in made
    )
    return PAGE.format(
        slow=f"{min(map(abs, rates)):g}",
        fast=f"{max(map(abs, rates)):g}",
        digest=hashlib.sha256(text).hexdigest(),
        held="`, `".join(report["held_out"]),
        verdict=report["verdict"],
        name=name,
        parameters=parameters,
        others="".join(
            f"| also named | {in_words(e['name'], e['stage'], e['harmonic'])}, domain {e['domain']} |\n"
            for e in others
        ),
        again="".join(
            f"| replayed closed loop, {channel} | {row['before']:.3g} {row['unit']} before, "
            f"**{row['after']:.3g}** after, floor {row['floor']:.3g} |\n"
            for channel, row in report["closed_loop"].items()
        ),
        missing=", ".join(report["not_identifiable"]),
        truth=f"{in_words(truth['effect'], truth['stage'], truth['harmonic'])}, {sealed}",
        found=fitted,
        **{k: f"{torque[k]:.2f}" for k in ("before", "after", "floor")},
    )


def _rates() -> list[str]:
    return re.findall(
        r", rate: (\S+ \S+),", "".join(p.read_text(encoding="utf-8") for p in HERE.glob("run*.yaml"))
    )


def main(out: Path) -> None:
    """Write the pictures and README.md."""
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    keep_pictures((out / "report.html").read_text(encoding="utf-8"))
    (HERE / "README.md").write_text(page(report, out / "plant.yaml"), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
