"""`python docs/example/page.py`: calibrate the sealed runs, keep the pictures, write README.md.

The command is the one the page prints; every figure of the page comes from its report.json.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path
from typing import Any

from plant.model import load

HERE = Path(__file__).resolve().parent
#: picture of the report, by the start of its caption -> file
PICTURES = {
    "Residual over the domain that explains it": "residual.png",
    "Held-out residual before and after": "held-out.png",
}
PAGE = """# A log in, a corrected plant out

The runs in this folder are logs of the right ascension axis, as `schmidt run` writes them: three closed-loop
runs at rates from {slow} to {fast}″/s, both ways. Something acted on the axis that is in no plant file. What
it was is in `truth.json`, which the finder does not read; its SHA-256 is
`{digest}`.

One command looks for it:

    schmidt calibrate docs/example/*.csv --out out/example

It holds out `{held}`, re-calibrates the declared model on the others, and answers **{verdict}**:

| | |
|---|---|
| name | {name} |
| parameters | {parameters} |
| held-out torque error | {before} N m before, **{after} N m** after, floor {floor} N m |
{again}{others}| not identifiable from these runs | {missing} |

"Before" is the declared model with its own parameters re-calibrated on the same runs; "floor" is what the
sensors leave. "Closed loop run again" drives the held-out run's set points once more through either plant and
compares with the log. The residual, over the phase of the order that explains it, on rows that were fitted:

![{residual_alt}](residual.png)

The same channel on the held-out rows, before and after:

![Held-out residual before and after](held-out.png)

`out/example/report.html` has the rest: spectrum over order with the gear table, surrogates, controls.
`out/example/plant.yaml` is the corrected plant, and the emulator runs on it:

    schmidt run scenarios/quick-look.yaml --plant out/example/plant.yaml --out out/example-night

{seal}
"""

SEAL = (
    "The seal, opened: {truth}. The corrected plant has {found}; the report above gives the phase of the "
    "torque that the motors supply against it, as a cosine, the plant file that of the torque on the axis, "
    "as a sine. The drive is `low_preload` with that one effect added; `seal.py` made the runs, `page.py` "
    "this page, and `tests/docs/test_example.py` repeats the calibration and holds it against the seal."
)


def calibrate(out: Path) -> dict[str, Any]:
    """Run the page's command into `out` and return its report."""
    command = Path(sys.executable).with_name("schmidt")
    logs = map(str, sorted(HERE.glob("*.csv")))
    subprocess.run([str(command), "calibrate", *logs, "--out", str(out)], check=True)
    report: dict[str, Any] = json.loads((out / "report.json").read_text(encoding="utf-8"))
    return report


def keep_pictures(html: str, stage: str) -> str:
    """Write the pictures that the page shows; the alternative text of the residual's."""
    found = re.findall(r'<img src="data:image/png;base64,([^"]+)" alt="([^"]+)"', html)
    chosen = ""
    for data, alt in found:
        for start, file in PICTURES.items():
            if alt.startswith(start) and (file != "residual.png" or stage in alt):
                (HERE / file).write_bytes(base64.b64decode(data))
                chosen = alt if file == "residual.png" else chosen
    return chosen


def number(name: str, p: dict[str, Any]) -> str:
    """A parameter with its interval, to the digits the interval is good for."""
    return f"{name} {p['value']:.4g} ({p['low']:.4g} to {p['high']:.4g}) {p['unit']}"


def in_words(name: str, stage: str | None, harmonic: int | None) -> str:
    """`gear_mesh` on mesh2, harmonic 1."""
    return f"`{name}`" + (f" on {stage}, harmonic {harmonic}" if stage else "")


def page(report: dict[str, Any], plant: Path, alt: str) -> str:
    """The page's text."""
    text = (HERE / "truth.json").read_bytes()
    truth = json.loads(text)
    first, *others = report["effects"]
    torque = report["error"]["torque"]
    rates = [float(x.split()[0]) * (3600 if "deg" in x else 1) for x in _rates()]
    name = in_words(first["name"], first["stage"], first["harmonic"])
    parameters = "; ".join(number(k, p) for k, p in first["parameters"].items())
    sealed = ", ".join(f"{k} {p['value']:g} {p['unit']}" for k, p in truth["parameters"].items())
    made = load(plant).axes.ra.effects
    fitted = "; ".join(
        f"{in_words(e.name, e.stage, e.harmonic)}, "
        + ", ".join(f"{k} {n.value:.4g} {n.unit}" for k, n in e.parameters.items())
        for e in made
    )
    seal = SEAL.format(
        truth=f"{in_words(truth['effect'], truth['stage'], truth['harmonic'])}, {sealed}", found=fitted
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
            f"| closed loop run again, {channel} | {row['before']:.3g} {row['unit']} before, "
            f"**{row['after']:.3g}** after, floor {row['floor']:.3g} |\n"
            for channel, row in report["closed_loop"].items()
        ),
        missing=", ".join(report["not_identifiable"]),
        residual_alt=alt,
        seal=textwrap.fill(seal, 108, break_on_hyphens=False, break_long_words=False),
        **{k: f"{torque[k]:.2f}" for k in ("before", "after", "floor")},
    )


def _rates() -> list[str]:
    return re.findall(
        r", rate: (\S+ \S+),", "".join(p.read_text(encoding="utf-8") for p in HERE.glob("run*.yaml"))
    )


def main() -> None:
    """Write the pictures and README.md."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name)
        report = calibrate(out)
        alt = keep_pictures(
            (out / "report.html").read_text(encoding="utf-8"), str(report["effects"][0]["name"])
        )
        (HERE / "README.md").write_text(page(report, out / "plant.yaml", alt), encoding="utf-8")


if __name__ == "__main__":
    main()
