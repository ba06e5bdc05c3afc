"""`python docs/example/seal.py`: drive three runs on a plant with an effect no plant file has.

Writes run1.csv to run3.csv and truth.json beside this file and prints the SHA-256 of truth.json. To be
repeated, with page.py after it, whenever the plant file low_preload_bridge changes: that file is what the
finder takes as declared.
"""

import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from plant.model import dump, load, with_effects
from plant.parts import EffectModel, Number

HERE = Path(__file__).resolve().parent
AXIS = "ra"
SOURCE = "chosen for the example"
EFFECT = EffectModel(
    "gear_mesh",
    stage="mesh2",
    harmonic=1,
    parameters={"amplitude": Number(15.0, "N m", SOURCE), "phase": Number(0.7, "rad", SOURCE)},
)


def schmidt(*words: str | Path) -> None:
    """Run the command that users run; raises CalledProcessError when it fails."""
    command = Path(sys.executable).with_name("schmidt")
    subprocess.run([str(command), *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def main() -> None:
    """Write the logs and the truth."""
    model = load("low_preload_bridge")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plant = folder / "plant.yaml"
        dump(with_effects(model, AXIS, (*getattr(model.axes, AXIS).effects, EFFECT)), plant)
        for run in ("run1", "run2", "run3"):
            schmidt("run", HERE / f"{run}.yaml", "--plant", plant, "--out", folder / run)
            shutil.copy(folder / run / f"axis-{AXIS}.csv", HERE / f"{run}.csv")
    truth = {
        "effect": EFFECT.name,
        "axis": AXIS,
        "stage": EFFECT.stage,
        "harmonic": EFFECT.harmonic,
        "parameters": {k: {"value": n.value, "unit": n.unit} for k, n in EFFECT.parameters.items()},
        "logs_sha256": {
            f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in sorted(HERE.glob("*.csv"))
        },
    }
    path = HERE / "truth.json"
    path.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    print(hashlib.sha256(path.read_bytes()).hexdigest())


if __name__ == "__main__":
    main()
