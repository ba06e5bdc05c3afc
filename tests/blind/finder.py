"""The finder as a black box: logs in, report.json out. It gets the log files and nothing else."""

import contextlib
import importlib
import io
import json
import signal
import sys
import time
import traceback
import types
from pathlib import Path
from typing import Any

COMMAND = "scenarios.cli:main"
INTERRUPTED = 130  # exit status of the command line
LIMIT_S = 300  # a finder that takes longer has not answered


class TooSlow(Exception):
    """The finder did not answer within LIMIT_S."""


def _alarm(_number: int, _frame: types.FrameType | None) -> None:
    raise TooSlow(f"no answer within {LIMIT_S} s")


def call(command: str, argv: list[str]) -> int:
    """Run `module:function` as the command line would; answer the exit status."""
    module, _, name = command.partition(":")
    main = getattr(importlib.import_module(module), name)
    before = sys.argv
    sys.argv = ["schmidt", *argv]
    try:
        main()
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    finally:
        sys.argv = before
    return 0


def told(said: io.TextIOWrapper) -> str:
    """What was written, as text and as bytes."""
    said.seek(0)
    return said.read()


def inputs(logs: Path) -> list[str]:
    """What the finder is called with: axis logs, or whatever tables there are and their rig file."""
    axis = sorted(str(path) for path in logs.glob("*.log"))
    if axis:
        return axis
    rig = logs / "rig.yaml"
    skip = ("SEAL", rig.name)
    tables = sorted(str(path) for path in logs.iterdir() if path.is_file() and path.name not in skip)
    return [*tables, *(("--rig", str(rig)) if rig.exists() else ())]


def find(logs: Path, out: Path, command: str = COMMAND) -> dict[str, Any]:
    """Answer for one case: {"status", "seconds", "failure"}; report.json is in `out` when status is 0.

    A result that is there already is not made again.
    """
    done = out / "answer.json"
    if done.exists():
        answer: dict[str, Any] = json.loads(done.read_text())
        return answer
    out.mkdir(parents=True, exist_ok=True)
    begin = time.perf_counter()
    said = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)  # errors come as bytes
    failure = None
    status = 1
    old = signal.signal(signal.SIGALRM, _alarm)
    signal.alarm(LIMIT_S)
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            status = call(command, ["calibrate", *inputs(logs), "--out", str(out)])
    except Exception:  # whatever the finder throws is its answer to this case
        failure = traceback.format_exc()[-2000:]
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old)
    if status == INTERRUPTED:
        raise KeyboardInterrupt  # the run was stopped: this case has no answer yet
    if status != 0 and failure is None:
        failure = told(said)[-2000:]
    if failure is None and not (out / "report.json").exists():
        failure = "no report.json"
    answer = {"status": status, "seconds": time.perf_counter() - begin, "failure": failure}
    done.write_text(json.dumps(answer, indent=1))
    return answer
