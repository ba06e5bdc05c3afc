"""A calibration as what a campaign runs: its document, its declared plant, and the row it leaves."""

import contextlib
import io
import json
from pathlib import Path
from typing import Any

from plant.model import dump
from scenarios.language.plants import named, plant_model

Document = dict[str, Any]
FIELD = "calibration"


def base(given: Document, folder: Path) -> Document:
    """The document of a campaign over a calibration: the campaign's block, the plant where inputs look."""
    document: Document = {FIELD: {word: value for word, value in given.items() if word != "plant"}}
    if "plant" in given:
        document["plant"] = given["plant"]
    return {**document, "_folder": str(folder.resolve())}


def row(document: Document, beside: Path, folder: Path) -> Document:
    """Calibrate into `folder`; the verdict, how many effects it names, and the error of every held-out
    channel before and after. Raises ValueError as `schmidt calibrate` does."""
    from calibration.command import calibrate

    given = document[FIELD]
    plant = None
    if "plant" in document:
        plant = folder / "declared.yaml"
        dump(plant_model(named(document["plant"]), beside), plant)
    rig = beside / given["rig"] if "rig" in given else None
    logs = [beside / name for name in given["logs"]]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        calibrate(logs, rig, given.get("hold_out"), folder, plant, plots=False, replay=False)
    found = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return {
        "verdict": found["verdict"],
        "effects": "; ".join(dict.fromkeys(effect["name"] for effect in found["effects"])),
        "figures": {
            "effects found": len(found["effects"]),
            **{f"{name} before": each["before"] for name, each in found["error"].items()},
            **{f"{name} after": each["after"] for name, each in found["error"].items()},
        },
    }
