"""What is left of something long: a bar on a terminal, a line now and then in a log."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from threading import Event, Thread
from typing import TextIO

FIRST_S, EVERY_S = 5.0, 15.0
"""Wall time until the first line of a log, and between two lines. ASSUMPTION: what a reader can bear."""
Show = Callable[[float | None, str], None]
"""Takes what is done, in the unit of the total (None: nobody knows), and what is being done."""
Stage = Callable[[str], None]
"""Takes the name of the stage that begins, or goes on."""
_FEWEST = 0.01
"""Share of the total that a rate is taken over at least. ASSUMPTION."""
_TICK_S = 1.0
_MOST = 0.97
"""A stage that takes longer than usual stands at this share of itself."""


def left(done: float, total: float, begun: float, wall_s: float) -> float | None:
    """Seconds left at the rate so far; None before there is one. begun: done when the clock started."""
    if done - begun < _FEWEST * total or wall_s <= 0:
        return None
    return max(0.0, (total - done) * wall_s / (done - begun))


def spoken(seconds: float | None) -> str:
    """`1 min 20 s left`, in steps of 5 s above 20 s."""
    if seconds is None:
        return "time left not known yet"
    whole = round(seconds / 5) * 5 if seconds > 20 else round(seconds)
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest} s left" if minutes else f"{rest} s left"


@contextmanager
def shown(what: str, total: float, begun: float = 0.0, stream: TextIO | None = None) -> Iterator[Show]:
    """Show how far `what` is: percent, what is being done, time left; on stderr unless a stream is given."""
    out = stream or sys.stderr
    start = time.monotonic()
    total = max(total, 1e-9)
    first: tuple[float, float] | None = None  # done and clock when work had begun: starting is no rate

    def text(done: float | None) -> str:
        nonlocal first
        now = time.monotonic()
        if done is None:
            return spoken(None)
        if first is None and done > begun:
            first = done, now
        return spoken(None if first is None else left(done, total, first[0], now - first[1]))

    if out.isatty() and find_spec("rich"):  # an isolated build has none
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

        text_of = TextColumn("{task.description}"), TextColumn("{task.fields[left]}")
        columns = (text_of[0], BarColumn(), TaskProgressColumn(), text_of[1])
        with Progress(*columns, console=Console(file=out), transient=True) as bar:
            task = bar.add_task(what, total=total, completed=int(begun), left="")

            def update(done: float | None, step: str) -> None:
                words = f"{what}: {step}" if step else what
                share = None if done is None else min(done, total)
                # a new step shows at once, however soon the next follows
                new = words != bar.tasks[task].description
                bar.update(task, completed=share, description=words, left=text(done), refresh=new)

            yield update
        return
    due = start + FIRST_S

    def line(done: float | None, step: str) -> None:
        nonlocal due
        now, remains = time.monotonic(), text(done)
        if now >= due and (done is None or done < total):
            due = now + EVERY_S
            share = "" if done is None else f"{100 * done / total:.0f} %"
            print(f"schmidt: {what}: {', '.join(filter(None, (share, step, remains)))}", file=out, flush=True)

    yield line


def paced(before_s: float, usual_s: float, wall_before_s: float, wall_s: float) -> float:
    """Usual seconds that are done, `wall_s` into a stage; before it `before_s` took `wall_before_s`."""
    pace = before_s / wall_before_s if before_s and wall_before_s > 0 else 1.0
    return before_s + min(_MOST * usual_s, wall_s * pace)


@contextmanager
def stages(what: str, usual_s: Mapping[str, float]) -> Iterator[Stage]:
    """Show what is left of stages that say nothing on their way; how long each usually takes is known.

    The pace of the machine at hand is measured. A thread shows, as the stages block. A stage that has begun
    is not begun again, nor one before it. A last stage that takes longer than usual has no time left that
    anybody knows.
    """
    names = list(usual_s)
    begun = time.monotonic()
    now = (names[0], begun)
    over = Event()

    def enter(name: str) -> None:
        nonlocal now
        if names.index(name) > names.index(now[0]):
            now = (name, time.monotonic())

    with shown(what, sum(usual_s.values())) as show:

        def tick() -> None:
            while not over.wait(_TICK_S):
                name, since = now
                before_s = sum(usual_s[each] for each in names[: names.index(name)])
                wall_s = time.monotonic() - since
                done = paced(before_s, usual_s[name], since - begun, wall_s)
                late = name == names[-1] and done >= before_s + _MOST * usual_s[name]
                show(None if late else done, f"{name}, longer than usual" if late else name)

        thread = Thread(target=tick, daemon=True)
        thread.start()
        try:
            yield enter
        finally:
            over.set()
            thread.join()
