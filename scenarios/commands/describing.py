"""Commands that say what is there, or write it for other programs: from conformance to export."""

import sys
from io import StringIO
from pathlib import Path
from typing import Any

import click

from scenarios.options import PATH, SEED, SPEED, Number, need, network

_FILE_INFO = {
    "FileVersion": "1", "FileRevision": "1", "Description": "schmidt",
    "CreatedBy": "schmidt", "ModifiedBy": "schmidt",
    "CreationDate": "01-01-2026", "CreationTime": "12:00AM",
    "ModificationDate": "01-01-2026", "ModificationTime": "12:00AM",
}  # fmt: skip
"""Of the section FileInfo (CiA 306). The same dates whenever it is written: the same bytes."""


@click.command(short_help="Check boards, emulated or real, against the protocol.")
@click.argument("scenario", type=PATH, required=False)
@network
@click.option(
    "--can",
    "channel",
    metavar="INTERFACE:CHANNEL",
    help="Where the boards are, such as socketcan:can0. Without it: the emulated network in this process.",
)
@click.option("--json", "json_file", type=PATH, help="Write the results to this file.")
@click.option("--speed", type=SPEED, default=1.0, help="Speed the boards are served at.")
@click.option(
    "--tolerance",
    "period_tolerance",
    type=Number(min=0, max=1, min_open=True),
    default=0.02,
    help="Allowed error of a message's mean period, relative.",
)
@click.option(
    "--stamps",
    "stamps_s",
    type=Number(min=0),
    default=0.001,
    help="Uncertainty of the tester's time stamps, seconds (in process: 0).",
)
@click.option("--board", "boards", multiple=True, metavar="TYPE:ID", help="Check this one only (repeatable).")
@click.option(
    "--motion/--no-motion", help="Send commands that move the telescope, too; it is stopped at the end."
)
@click.option("--flood", is_flag=True, help="Fill the bus, too: boards will report what they had to drop.")
@click.option("--canopen", is_flag=True, help="Check what a CANopen master expects, and nothing else.")
def conformance(
    scenario: Path | None,
    network: str | None,
    channel: str | None,
    json_file: Path | None,
    boards: tuple[str, ...],
    **settings: Any,
) -> None:
    """Check boards, emulated or real, against the protocol; SCENARIO or --network says which boards."""
    from bus.conformance import Settings
    from scenarios.commands.checking import command

    sys.exit(command(channel, json_file, boards, Settings(**settings), scenario, network))


@click.command(short_help="Write CANopen data sheets of the boards.")
@click.argument("folder", type=PATH)
@click.argument("scenario", type=PATH, required=False)
@network
def eds(folder: Path, scenario: Path | None, network: str | None) -> None:
    """Write a CANopen data sheet (EDS) per type of board into FOLDER; SCENARIO or --network says which
    boards, those of one's own too."""
    for file in write_eds(folder, scenario, network):
        click.echo(file)


def write_eds(folder: Path, scenario: Path | None = None, name: str | None = None) -> list[Path]:
    """One file per type of board into `folder`, node numbers of the first of each, boards of one's own too;
    and `canopen.dbc`.

    scenario, name: whose network (neither: `lab`). Raises OSError when it cannot be written, ValueError
    subclasses for a scenario that cannot be used.
    """
    from canopen.objectdictionary.eds import export_eds

    from boards.canopen import canopen_dbc, dictionary
    from boards.canopen.dictionary import type_of
    from host.logs.files import write_file
    from scenarios.lab import wiring

    made = wiring.network(scenario, network_name=name)
    texts = {}
    for kind, board in sorted(
        {type_of(each)[0].lower(): each for each in reversed(made.boards.values())}.items()
    ):
        text = StringIO()
        export_eds(dictionary(board), text, {"FileName": f"{kind}.eds", **_FILE_INFO})
        texts[f"{kind}.eds"] = text.getvalue()
    texts["canopen.dbc"] = canopen_dbc(made.devices)
    for file, text_of in texts.items():
        write_file(folder / file, text_of)
    return [folder / file for file in texts]


@click.command()
def protocol() -> None:
    """Print the protocol page, made from the DBC."""
    from bus.protocol.page import page

    click.echo(page())


@click.command()
@click.argument("name", required=False)
def effects(name: str | None) -> None:
    """List the catalogue of effects, or describe one."""
    from plant.effects import REGISTRY

    if name is not None:
        if name not in REGISTRY:
            from plant.yamltext import nearest

            raise ValueError(f"no effect is called {name!r}; {nearest(name, REGISTRY)}")
        effect = REGISTRY[name]
        click.echo(f"{effect.name}: {effect.equation}\nchannel {effect.channel}, seen over {effect.domain}")
        if effect.stages:
            click.echo(f"stages: {', '.join(effect.stages)}")
        for each in effect.parameters:
            click.echo(
                f"  {each.name}: {each.default:g} {each.unit}, {each.low:g}..{each.high:g}; {each.source}"
            )
        return
    for effect in REGISTRY.values():
        click.echo(f"{effect.name:22} {effect.channel}  {effect.domain:12} {effect.equation}")


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
