"""One run of a campaign, wherever it is made: a scenario in, a row out."""

import platform
import shutil
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

from scenarios.campaign.plan import Case
from scenarios.lab.prepare import prepare
from scenarios.language.document import Document
from scenarios.language.load import BESIDE
from scenarios.native import compiled
from scenarios.run import run as runner
from scenarios.run.probe import digest

Row = dict[str, Any]
_EXPECTATIONS = "expectations"


def run(job: Case) -> Row:
    """Run one case. What the run makes of it is the row's `failure`; only a broken machine raises."""
    start, cpu = time.perf_counter(), time.process_time()
    row: Row = {"key": job.key, "index": job.index, "failure": ""}
    row |= {f"input: {name}": _cell(value) for name, value in job.values.items()}
    with tempfile.TemporaryDirectory(prefix="schmidt-run-") as folder:
        try:
            row |= _simulated(job, Path(folder))
        except ValueError as error:
            row |= {"failure": " ".join(str(error).split()), "passed": False, "missed": ""}
        if job.kept and (job.keep == "all" or (job.keep == "failed" and not row["passed"])):
            shutil.copytree(folder, Path(job.kept) / job.key, dirs_exist_ok=True)
    return row | {
        "wall_s": time.perf_counter() - start,
        "cpu_s": time.process_time() - cpu,
        "probe": digest(),
        "version": version("schmidt"),
        "compiled": compiled(),
        "machine": platform.node(),
    }


def _simulated(job: Case, folder: Path) -> Row:
    document = Document(Path(job.beside) / f"{job.key}.yaml", job.document, {})
    scenario, model = prepare(document)
    result = runner.run(scenario, model, folder, lambda _step, _t, _factor: None, runner.Way(report=False))
    summary = result.summary
    if result.interrupted:
        raise KeyboardInterrupt
    row: Row = {
        "passed": result.passed,
        "missed": "; ".join(verdict.name for verdict in result.verdicts if not verdict.passed),
        "digest": summary["trace_digest"],
        "simulated_s": summary["simulated_s"],
        "silent_faults": summary["silent_faults"],
    }
    judged = {verdict.name: verdict.value for verdict in result.verdicts}
    for metric in job.metrics:
        if metric == _EXPECTATIONS:
            row |= {f"metric: {name}": value for name, value in judged.items()}
        elif metric in judged:
            row[f"metric: {metric}"] = judged[metric]
        elif isinstance(summary.get(metric), int | float):
            row[f"metric: {metric}"] = summary[metric]
        else:
            raise ValueError(f"the run has no figure {metric!r}")
    return row


def _cell(value: Any) -> Any:
    """A table's cell: numbers as they are, anything else in words (a fault as `node_off POSITION_RA`)."""
    if isinstance(value, int | float | str):
        return value
    if isinstance(value, dict):
        return " ".join(str(_cell(each)) if not isinstance(each, dict) else f"{word} {_cell(each)}"
                        for word, each in value.items() if word not in BESIDE)  # fmt: skip
    return str(value)
