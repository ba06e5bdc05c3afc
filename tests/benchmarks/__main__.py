"""`python -m tests.benchmarks [--json FILE] [--history FILE] [--quick]`: measure, print a table, keep it."""

import json
import os
import platform
import time
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from scenarios.native.build import BuildError, build
from scenarios.progress import stages
from tests.benchmarks import counters, history, interleaved, named, network, night, profile, serving, startup
from tests.benchmarks.show import costs, headline, show

SIZES = (11, 22, 44, 64, 128, 256)
_ROUNDS = 5
USUAL_S = {
    "compiling what has changed": 60.0,
    "plain, compiled, bare loop and python-can in turn": 150.0,
    "instructions": 30.0,
    "cost per node": 60.0,
    "named networks in turn": 60.0,
    "a long night, run": 90.0,
    "profile": 30.0,
    "start-up, compiling from nothing": 60.0,
    "ticks of a served network": 130.0,
    "a network stepped by a host": 20.0,
}  # ASSUMPTION: shares of the ten minutes that a bench takes; the pace at hand is measured


def measure(quick: bool, say: Console) -> dict[str, Any]:
    """All figures. quick: shorter stretches, for trying the benchmark itself."""
    seconds = 10 if quick else 100
    begun = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    with stages("bench", USUAL_S) as stage:
        stage("compiling what has changed")
        native = _native(say)
        stage("plain, compiled, bare loop and python-can in turn")
        turns = interleaved.measure(4 if quick else interleaved.ROUNDS, native)
        stage("instructions")
        instructions = counters.instructions(native)
        stage("cost per node")
        sizes = network.nodes(SIZES, max(1, seconds // 50), 3 if quick else _ROUNDS)
        stage("named networks in turn")
        by_name = named.measure(max(2, seconds // 10), 3 if quick else named.ROUNDS)
        stage("a long night, run")
        long_night = night.measure(0.25 if quick else 10.0 if native else 1.0, quiet=True)
        stage("profile")
        profiled = profile.measure(max(5, seconds // 5))
        stage("start-up, compiling from nothing")
        start = startup.startup()
        stage("ticks of a served network")
        served = serving.punctuality(15 if quick else 120, native)
        stage("a network stepped by a host")
        stepped = serving.stepped(5 if quick else 30, native, step_ms=5)
    return {
        "begun": begun,
        "machine": {"name": history.machine(), "cores": os.cpu_count(), "load": os.getloadavg()},
        "python": platform.python_version(),
        "turns": turns,
        "instructions": instructions,
        "nodes": sizes,
        "networks": by_name,
        "long night": long_night,
        "startup": start,
        "served": served,
        "stepped": stepped,
        "rooms": profiled["rooms"],
        "profile": profiled["functions"],
    }


def _native(say: Console) -> bool:
    try:
        build()
    except BuildError as error:
        say.print(f"only the plain way is measured: {error}")
        return False
    return True


@click.command()
@click.option("--json", "json_file", type=click.Path(path_type=Path))
@click.option("--history", "past", type=click.Path(path_type=Path), help="Earlier benches, a line each.")
@click.option("--quick", is_flag=True, help="Short stretches; not kept in the history.")
def main(json_file: Path | None, past: Path | None, quick: bool) -> None:
    """Measure the emulator's speed."""
    console = Console()
    figures = measure(quick, console)
    show(figures, console)
    if json_file is not None:
        json_file.parent.mkdir(parents=True, exist_ok=True)
        json_file.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    if past is not None and not quick:
        dear = costs(figures)
        now = headline(figures) | dear
        for line in history.falls(history.read(past), now, dear):
            console.print(f"[bold red]{line}")
        history.add(past, now, {"begun": figures["begun"], "load": figures["machine"]["load"][0]})


if __name__ == "__main__":
    main()
