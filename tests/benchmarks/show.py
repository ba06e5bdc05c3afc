"""The bench's one table, and the figures that its history keeps."""

from typing import Any

from rich.console import Console
from rich.table import Table

from tests.benchmarks import named

_WAYS = ("plain", "compiled")


def headline(figures: dict[str, Any]) -> dict[str, float]:
    """Figures to compare with earlier benches, the better the larger; ratios, as machines drift."""
    turns = figures["turns"]
    found = {}
    for way in _WAYS:
        if way in turns:
            found[f"bare loop over {way} night"] = turns[way]["bare over night"]["median"]
            found[f"python-can over {way} night"] = turns[way]["python-can over night"]["median"]
            found[f"{way} night, times real time by CPU"] = 1e3 / turns[way]["night"]["median"]
    if "plain over compiled night" in turns:
        found["plain over compiled night"] = turns["plain over compiled night"]["median"]
    return found


def costs(figures: dict[str, Any]) -> dict[str, float]:
    """The same for figures that are the better the smaller."""
    start = figures["startup"]
    found = {f"million instructions, {way}": value for way, value in figures["instructions"].items()}
    found |= {f"cost of a node of {row['nodes']}": row["of_first"] for row in figures["nodes"][1:]}
    return found | {
        "peak memory of a long night, MiB": figures["long night"]["peak_MiB"],
        "first command until it simulates, CPU s": start["first_run_cpu_s"],
        "later command until it simulates, CPU s": start["later_run_cpu_s"],
        "short run with its report, CPU s": start["short_run_with_report_cpu_s"],
    }


def rows(figures: dict[str, Any]) -> list[tuple[str, str, str]]:
    """What, measured, asked for."""
    turns = figures["turns"]
    found = []
    best = "compiled" if "compiled" in turns else "plain"
    for way in _WAYS:
        if way in turns:
            found += _night(turns[way], way, figures["instructions"].get(way), way == best)
    if "plain over compiled night" in turns:
        found.append(("plain night over compiled night", _spread(turns["plain over compiled night"], ""), ""))
    if not figures["instructions"]:
        found.append(("instructions", "neither perf nor valgrind can count here", ""))
    return (
        found
        + _nodes(figures["nodes"])
        + _long(figures["long night"], best)
        + _start(figures["startup"])
        + named.lines(figures["networks"])
        + _served(figures["served"])
        + [
            (
                f"stepped by another process, {way}",
                f"{each['times_real_time']:.0f} times real time by CPU",
                "≥ 30",
            )
            for way, each in figures["stepped"].items()
        ]
    )


def _night(each: dict[str, Any], way: str, counted: float | None, best: bool) -> list[tuple[str, str, str]]:
    """One way's night beside its yardsticks; what is asked is asked of the best way there is."""
    asked = ("≥ 130, aim 300", "≥ 0.75, aim 1.5", "≥ 13, aim 25") if best else ("", "", "")
    found = [
        (f"night, {way}", _spread(each["night"], "ms CPU a simulated second"), ""),
        ("  times real time by CPU", f"{1e3 / each['night']['median']:.0f}", asked[0]),
        ("  bare loop over it", _spread(each["bare over night"], ""), asked[1]),
    ]
    if "in C" in each:
        found.append(("  with both axis boards in C", _spread(each["in C"], "ms"), ""))
        ratio = _spread(each["night over night in C"], "")
        found.append(("  the night over that", ratio, "> 1" if way == "plain" else ""))
    if "bare on compiled pins over night" in each:
        text = _spread(each["bare on compiled pins over night"], "")
        found.append(("  bare loop on the compiled plant pins over it", text, ""))
    found += [
        ("  python-can over it", _spread(each["python-can over night"], ""), asked[2]),
        ("  frames a second", f"{each['frames_per_s']:.0f}", ""),
        ("  plant alone, every 5 ms", _spread(each["plant"], "ms"), ""),
    ]
    if counted is not None:
        found.append(("  instructions", f"{counted:.1f} M a simulated second", ""))
    return found


def _nodes(sizes: list[dict[str, float]]) -> list[tuple[str, str, str]]:
    cost = " ".join(f"{row['nodes']:.0f}: {row['ms_per_node_and_s']:.2f}" for row in sizes)
    ratio = " ".join(
        f"{row['nodes']:.0f}: {row['of_first']:.2f} ± {row['of_first_noise']:.2f}" for row in sizes[1:]
    )
    return [
        ("cost per node, ms CPU a simulated second, this way", cost, ""),
        (f"  over that of {sizes[0]['nodes']:.0f}, in turn", ratio, "flat"),
    ]


def _long(found: dict[str, float], way: str) -> list[tuple[str, str, str]]:
    what = f"a night of {found['hours']:g} hours, run once, {way}"
    asked = "≤ 250, aim 120" if found["hours"] >= 10 else "≤ 250 for ten hours"
    growth = f"{found['MiB_per_hour']:+.1f} MiB an hour after its first third"
    return [
        (f"{what}: peak memory", f"{found['peak_MiB']:.0f} MiB, {growth}", asked),
        ("  CPU time", f"{found['cpu_s']:.0f} s", ""),
    ]


def _start(start: dict[str, float]) -> list[tuple[str, str, str]]:
    def both(name: str) -> str:
        return f"{start[f'{name}_s']:.2f} s, {start[f'{name}_cpu_s']:.2f} s CPU"

    return [
        ("first command until it simulates", both("first_run"), "≤ 3 s"),
        ("later command until it simulates", both("later_run"), "≤ 0.8 s"),
        ("  a whole short run with its report", both("short_run_with_report"), "≤ 2 s"),
        ("  schmidt --version", f"{start['version_s']:.2f} s", ""),
    ]


def _served(ways: dict[str, dict[str, float]]) -> list[tuple[str, str, str]]:
    """Ticks of `schmidt serve` on one core, below those of a loop that does nothing else."""
    found = []
    for way, each in ways.items():
        asked = "" if "sleeps" in way else "≥ 99.9 %"
        on_time = f"{each['on_time']:.3%} of {each['ticks']:.0f}, load {each['load']:.1f}"
        late = f"{each['late_999_ms']:.2f} ms, worst {each['worst_ms']:.1f} ms, {each['slips']:.0f} slips"
        found += [
            (f"5 ms ticks within 1 ms of due, {way}", on_time, asked),
            ("  99.9 % of them within", late, ""),
        ]
    return found


def show(figures: dict[str, Any], console: Console) -> None:
    """Print everything."""
    machine = figures["machine"]
    table = Table(title=f"schmidt bench, {machine['cores']} cores, load {machine['load'][0]:.1f}")
    for column in ("what (median ± half the range between quartiles)", "measured", "asked for"):
        table.add_column(column)
    for row in rows(figures):
        table.add_row(*row)
    console.print(table)
    profile = Table(title="where the time goes (own time, plain Python under cProfile)")
    for column in ("function", "calls/s", "own", "with callees"):
        profile.add_column(column)
    for each in figures["profile"]:
        own, total = f"{each['own_share']:.1%}", f"{each['total_share']:.1%}"
        profile.add_row(each["function"], f"{each['calls_per_s']:.0f}", own, total)
    console.print(profile)
    by_room = Table(title="by room")
    for column in ("room", "own time", "calls a frame", "calls a tick"):
        by_room.add_column(column)
    for name, room in figures["rooms"].items():
        by_room.add_row(name, f"{room['share']:.0%}", f"{room['per_frame']:.1f}", f"{room['per_tick']:.1f}")
    console.print(by_room)


def _spread(found: dict[str, float], unit: str) -> str:
    return f"{found['median']:.3g} ± {found['noise']:.2g} {unit}".rstrip()
