"""`schmidt campaign`: plan, run, gather, report."""

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from scenarios.campaign import plan, table
from scenarios.campaign.executor import each
from scenarios.campaign.job import Row, run
from scenarios.campaign.options import CampaignOptions
from scenarios.campaign.report_page import write
from scenarios.language.document import ScenarioError
from scenarios.progress import shown
from scenarios.run.probe import digest

COMPLETE, INCOMPLETE, INTERRUPTED = 0, 1, 130


class _Waiting:
    """The planned runs that are not made yet; `late` when time is over before all were given."""

    def __init__(self, planned: plan.Plan, done: set[str], out: Path) -> None:
        self._planned, self._done = planned, done
        self._kept = None if planned.keep == "nothing" else str(out.resolve() / "runs")
        self._begun_s = time.perf_counter()
        self.late = False
        self.keys: set[str] = set()
        """Of the plan, so far."""
        self.alike = 0
        """Runs of the plan that are one of those before: the same input is the same run."""

    @property
    def wall_s(self) -> float:
        """Since the beginning."""
        return time.perf_counter() - self._begun_s

    def __iter__(self) -> Iterator[tuple[str, plan.Case]]:
        limit_s = self._planned.time_s
        for case in self._planned.cases():
            known = case.key in self.keys
            self.alike += known
            self.keys.add(case.key)
            if known or case.key in self._done:
                continue
            if limit_s is not None and self.wall_s > limit_s:
                self.late = True
                return
            yield case.key, replace(case, kept=self._kept)


def campaign(options: CampaignOptions, task: Callable[[plan.Case], Row] = run) -> int:
    """Run a campaign into its folder; exit 0 when every planned run is there, 130 when it was interrupted.

    task: what makes a row of a planned run; the bench has one that does nothing.
    """
    out = options.folder
    planned = plan.load(options.file)
    journal = table.Journal(out, options.resume)
    ours = digest()  # also fills the cache of compiled kernels before the workers ask for it
    waiting = _Waiting(planned, journal.done, out)
    before = len(journal.done)
    status = COMPLETE
    with shown("runs", planned.count, before) as advance:
        try:
            for done in each(task, waiting, jobs=options.jobs, scheduler=options.scheduler):
                if done.value is None:
                    journal.add({"key": done.key, "index": -1, "failure": done.error, "lost": True})
                    status = INCOMPLETE
                elif done.value["probe"] != ours:
                    machine, theirs, its = (done.value[word] for word in ("machine", "version", "probe"))
                    raise ScenarioError(
                        f"the worker on {machine} runs another version (schmidt {theirs}): "
                        f"the digest of its probe is {its[:12]}, here it is {ours[:12]}"
                    )
                else:
                    journal.add(done.value)
                advance(len(journal.done), f"{len(journal.done)} of {planned.count}")
        except KeyboardInterrupt:
            status = INTERRUPTED
        finally:
            journal.close()
    wall_s = waiting.wall_s
    if not journal.done:
        print(f"schmidt: no run has ended; nothing is in {out}", file=sys.stderr)
        return status or INCOMPLETE
    table.write(out)
    write(planned, out, wall_s, len(journal.done) - before)
    where = f"report {out / 'report.html'}, table {out / table.TABLE}"
    total = planned.count - waiting.alike
    # rows of another plan are no runs of this one; which they are is known when all of it was seen
    made = len(journal.done & waiting.keys if len(waiting.keys) == total else journal.done)
    more = f" ({waiting.alike} more are alike)" if waiting.alike else ""
    print(f"{made} of {total} runs{more}, {where}")
    missing = total - made
    if missing <= 0:
        return status
    why = "interrupted" if status == INTERRUPTED else "out of time" if waiting.late else "workers were lost"
    print(f"schmidt: {why}, {missing} runs are missing: --resume makes them", file=sys.stderr)
    return status or INCOMPLETE
