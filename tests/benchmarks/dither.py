"""`python -m tests.benchmarks.dither [--before FOLDER] [--count]`: what the spread duty costs the emulator.

The main scenario in processes that take turns, every few simulated seconds: the paper's firmware, the spread
duty alone, the proposed firmware; with `--before`, the paper's firmware of another checkout too. CPU time,
plain Python; ratios are taken turn by turn, so both sides saw the same machine. `--count` counts instructions
instead (valgrind), which no neighbour on the machine disturbs.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

import click

from tests.benchmarks import counters

ROOT = Path(__file__).parents[2]
SECONDS = 4
"""Simulated seconds of a turn."""
WAYS = {"off": "", "spread": "spread", "fine": "fine"}
_BEGIN = """
import gc, scenarios, sys, tempfile, time
from pathlib import Path
try:
    from scenarios.lab.prepare import Changes, prepare
    from scenarios.lab.session import Session
    from scenarios.run import run
except ImportError:  # a checkout of before the rooms
    import scenarios.run as run
    from scenarios.session import Session
    Changes, prepare = dict, lambda file, changes: run.prepare(file, **changes)
NIGHT = Path(scenarios.__file__).with_name("observing-night.yaml")  # of that checkout
name = sys.argv[1]
if name == "spread":
    firmware = sys.modules.get("scenarios.language.configure") or sys.modules["scenarios.firmware"]
    if hasattr(firmware, "FIRMWARES"):  # a checkout of before the bias followed from the power stage
        firmware.FIRMWARES["fine"] = dict(list(firmware.FIRMWARES["fine"].items())[:1])
    else:
        from scenarios.language import configure
        known = configure.parameters_of
        configure.parameters_of = lambda *given: dict(list(known(*given).items())[:1])
scenario, model = prepare(NIGHT, Changes(**({"firmware": "fine"} if name else {})))
with tempfile.TemporaryDirectory() as folder:
    made = Session(scenario, model, Path(folder))
    made.advance(40 * 10**9)  # by then the telescope tracks
    if "gc.freeze" in Path(run.__file__).read_text():  # as that checkout's `schmidt run` does
        gc.freeze()
"""
_TURNS = """
    print("ready", flush=True)
    for line in sys.stdin:
        begin = time.process_time()
        made.advance(made.network.queue.now_ns + int(line) * 10**9)
        print(time.process_time() - begin, flush=True)
    made.recorder.close()
"""
_COUNTED = """
    count("on")
    made.advance(made.network.queue.now_ns + int(sys.argv[2]) * 10**9)
    count("off")
    made.recorder.close()
"""


def _process(root: Path, name: str) -> subprocess.Popen[str]:
    environment = {**os.environ, "SCHMIDT_PURE": "1", "PYTHONPATH": str(root)}
    return subprocess.Popen(
        [sys.executable, "-c", _BEGIN + _TURNS, name], cwd=root, env=environment,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip


def _turn(process: subprocess.Popen[str]) -> float:
    """CPU ms per simulated second."""
    assert process.stdin is not None and process.stdout is not None
    process.stdin.write(f"{SECONDS}\n")
    process.stdin.flush()
    return 1e3 * float(process.stdout.readline()) / SECONDS


def _places(before: Path | None) -> dict[str, tuple[Path, str]]:
    """Checkout and firmware of every way."""
    places = {name: (ROOT, firmware) for name, firmware in WAYS.items()}
    return places if before is None else {**places, "before": (before.resolve(), "")}


def counted(before: Path | None) -> dict[str, float]:
    """Million instructions per simulated second, by way."""
    seconds = counters.UNDER_VALGRIND_S
    found = {}
    with tempfile.TemporaryDirectory() as cache:
        for name, (root, firmware) in _places(before).items():
            refs = counters.under_valgrind(
                counters.MARKS + _BEGIN + _COUNTED, [firmware, str(seconds)], root, "1", cache
            )
            if refs is None:
                raise click.ClickException("nothing was counted: is valgrind installed?")
            found[name] = refs / seconds / 1e6
    return found


def measure(rounds: int, before: Path | None) -> dict[str, list[float]]:
    """CPU ms per simulated second, by way and turn."""
    places = _places(before)
    found: dict[str, list[float]] = {name: [] for name in places}
    with ExitStack() as stack:
        running = {name: stack.enter_context(_process(*place)) for name, place in places.items()}
        for process in running.values():
            assert process.stdout is not None
            if process.stdout.readline() != "ready\n":
                raise click.ClickException("a process of the bench has died")
        for turn in range(rounds):
            order = list(running) if turn % 2 else list(reversed(running))
            for name in order:
                found[name].append(_turn(running[name]))
    return found


def ratio(one: list[float], other: list[float]) -> tuple[float, float]:
    """Median of the ratios turn by turn, and its standard error (from the quartiles)."""
    ratios = [a / b for a, b in zip(one, other, strict=True)]
    low, middle, high = statistics.quantiles(ratios, n=4)
    return middle, 1.2533 * (high - low) / 1.349 / len(ratios) ** 0.5


@click.command()
@click.option("--before", type=click.Path(exists=True, file_okay=False, path_type=Path), help="A checkout.")
@click.option("--rounds", default=40, show_default=True)
@click.option("--count", is_flag=True, help="Instructions, by valgrind, instead of CPU time.")
def main(before: Path | None, rounds: int, count: bool) -> None:
    """Measure and print."""
    pairs = [("spread", "off"), ("fine", "off")] + [("off", "before")] * (before is not None)
    if count:
        refs = counted(before)
        for name, value in refs.items():
            click.echo(f"{name:8s} {value:7.2f} million instructions per simulated second")
        for one, other in pairs:
            click.echo(f"{one} over {other}: {refs[one] / refs[other]:.4f}")
        return
    found = measure(rounds, before)
    for name, values in found.items():
        click.echo(f"{name:8s} {statistics.median(values):7.2f} ms of CPU per simulated second")
    for one, other in pairs:
        middle, error = ratio(found[one], found[other])
        click.echo(f"{one} over {other}: {middle:.3f} ± {error:.3f}")


if __name__ == "__main__":
    main()
