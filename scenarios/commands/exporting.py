"""Commands that make files for other programs: fmu, export."""

from pathlib import Path

import click

from scenarios.commands.options import PATH, SEED
from scenarios.commands.parts import need


@click.command(short_help="Write one axis as an FMU.")
@click.option("--axis", type=click.Choice(["ra", "dec"]), required=True, help="Which axis.")
@click.option("--out", type=PATH, required=True, help="File to write, such as drive.fmu.")
@click.option("--plant", default="low-preload-bridge", help="Plant file, or a name.")
@click.option("--seed", type=SEED, default=1, help="Of noise.")
@click.option("--fmi", type=click.Choice(["2", "3"]), default="3", help="Version of FMI.")
def fmu(axis: str, out: Path, plant: str, seed: int, fmi: str) -> None:
    """Write one axis as an FMU for co-simulation: duties in; encoders, currents, rate and torque out."""
    need("fmu")
    from plant.fmu import write
    from scenarios.language.plants import plant_model

    made = write(plant_model({"file": plant}, Path()), axis, seed, out, int(fmi))
    numbers = sum(bool(each.name) for each in made.parameters)
    effects = sum(bool(name) for name in made.switchable)
    told = f"FMI {fmi}.0, axis {axis} of {made.model.name}, {numbers} parameters"
    click.echo(f"{out}: {told}, effects to switch: {effects}")


@click.command(short_help="Write a run as one MCAP file.")
@click.argument("folder", type=PATH)
@click.option("--mcap", "file", type=PATH, required=True, help="File to write.")
def export(folder: Path, file: Path) -> None:
    """Write what a run has left in FOLDER as one file: frames, logs, truth, faults, verdicts."""
    need("recordings", "parquet")
    from scenarios.run.mcapfile import export as write

    click.echo(f"{file}: {write(folder, file)} messages")
