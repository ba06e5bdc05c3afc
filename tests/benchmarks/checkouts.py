"""`python -m tests.benchmarks.checkouts --before FOLDER [--rounds N] [--plain]`: two checkouts run in turn.

Whole commands, each in a process of its own: the observing night and the calibration of one log. Every round
runs both checkouts one after the other, so both sides of a ratio saw the same machine. Above one: this
checkout is the faster one.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import click

from tests.benchmarks.calibration import ONE_THREAD, SEED
from tests.benchmarks.dither import ratio
from tests.benchmarks.drives import write_drive

ROOT = Path(__file__).parents[2]
LOG_S = 600.0
"""s, of the log: the ten minutes that docs/results/speed.md names."""
ROUNDS = 7
MUST = 0.97
"""Speed over that of before. ASSUMPTION: three per cent are the noise of a shared machine."""
_MAIN = "from scenarios.cli import main; main()"


class CommandFailed(click.ClickException):
    """A command of one of the checkouts ended badly; one line."""


def commands(log: Path) -> dict[str, list[str]]:
    """What is timed, by its name; each gets `--out FOLDER` on top. The scenario is each checkout's own."""
    return {
        "night": ["run", "scenarios/observing-night.yaml", "--no-report"],
        "calibration": ["calibrate", str(log)],
    }


def _python(root: Path, arguments: Sequence[str], plain: bool) -> None:
    """Run Python on the sources under `root`; raises CommandFailed."""
    environment = {**os.environ, **ONE_THREAD, "SCHMIDT_PURE": "1" if plain else "0", "PYTHONPATH": str(root)}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=root, env=environment, capture_output=True, text=True
    )
    if done.returncode:
        words = (done.stderr or done.stdout).strip().splitlines() or ["no word"]
        raise CommandFailed(f"{root}: {' '.join(arguments[-4:])}: {words[-1]}")


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(root: Path, command: Sequence[str], plain: bool) -> tuple[float, str]:
    """CPU seconds of one command in a checkout, and the digest of its traces ("" where it has none)."""
    with tempfile.TemporaryDirectory(prefix="schmidt-turn-") as folder:
        before = _cpu_s()
        _python(root, ["-c", _MAIN, *command, "--out", folder], plain)
        spent = _cpu_s() - before
        summary = Path(folder) / "summary.json"
        digest = json.loads(summary.read_text(encoding="utf-8"))["trace_digest"] if summary.exists() else ""
    return spent, digest[:16]


def measure(
    roots: Mapping[str, Path],
    timed: Mapping[str, Sequence[str]],
    rounds: int,
    plain: bool,
    tell: Callable[[str], None],
) -> dict[str, dict[str, list[float]]]:
    """CPU seconds by command and checkout, one value a round; a round before them fills caches only.

    tell: takes a line for each command that is through.
    """
    found = {name: {which: list[float]() for which in roots} for name in timed}
    for turn in range(rounds + 1):
        order = list(roots) if turn % 2 else list(reversed(roots))
        for name, command in timed.items():
            for which in order:
                spent, digest = run(roots[which], command, plain)
                if turn:
                    found[name][which].append(spent)
                tell(f"{turn}/{rounds} {name} {which}: {spent:.2f} s {digest}".rstrip())
    return found


@click.command()
@click.option(
    "--before",
    required=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="The other checkout, such as a worktree of an older commit.",
)
@click.option("--rounds", type=click.IntRange(3), default=ROUNDS, show_default=True)
@click.option("--plain", is_flag=True, help="Plain Python; otherwise each checkout's library, built first.")
@click.option("--json", "target", type=click.Path(path_type=Path), help="Write the seconds here too.")
def main(before: Path, rounds: int, plain: bool, target: Path | None) -> None:
    """Time both checkouts in turn; exit 1 when this one is slower than is allowed."""
    roots = {"before": before.resolve(), "now": ROOT}
    if not plain:
        for root in roots.values():
            click.echo(f"{root}: its library, if it is not there", err=True)
            _python(root, ["-m", "scenarios.native"], True)
    with tempfile.TemporaryDirectory(prefix="schmidt-log-") as folder:
        log = write_drive(Path(folder) / "log.csv", LOG_S, SEED).path
        found = measure(roots, commands(log), rounds, plain, lambda text: click.echo(text, err=True))
    fast = True
    for name, seconds in found.items():
        middle, error = ratio(seconds["before"], seconds["now"])
        fast &= middle >= MUST
        of = ", ".join(f"{which} {statistics.median(each):.2f} s" for which, each in seconds.items())
        click.echo(f"{name}: speed over before {middle:.3f} ± {error:.3f} (must {MUST}); CPU: {of}")
    if target is not None:
        target.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    sys.exit(0 if fast else 1)


if __name__ == "__main__":
    main()
