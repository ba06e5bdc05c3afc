"""The bench's one table, and the figures that its history keeps."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from scenarios.bench import named

_WAYS = ("plain", "compiled")


def headline(figures: dict[str, Any]) -> dict[str, float]:
    """Figures to compare with earlier benches, each the better the larger. Ratios first: machines drift."""
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


def rows(figures: dict[str, Any]) -> list[tuple[str, str, str]]:
    """What, measured, asked for."""
    turns, memory, start = figures["turns"], figures["memory"], figures["startup"]
    found = []
    best = "compiled" if "compiled" in turns else "plain"
    for way in _WAYS:
        if way not in turns:
            continue
        each = turns[way]
        asked = ("≥ 0.75, aim 1.5", "≥ 13, aim 25") if way == best else ("", "")
        factor = 1e3 / each["night"]["median"]
        found += [
            (f"night, {way}", _spread(each["night"], "ms CPU a simulated second"), ""),
            ("  times real time by CPU", f"{factor:.0f}", "≥ 130, aim 300" if way == best else ""),
            ("  bare loop over it", _spread(each["bare over night"], ""), asked[0]),
            ("  python-can over it", _spread(each["python-can over night"], ""), asked[1]),
            ("  frames a second", f"{each['frames_per_s']:.0f}", ""),
            ("  plant alone, every 5 ms", _spread(each["plant"], "ms"), ""),
        ]
        if way in figures["instructions"]:
            found.append(("  instructions", f"{figures['instructions'][way]:.1f} M a simulated second", ""))
    if "plain over compiled night" in turns:
        found.append(("plain night over compiled night", _spread(turns["plain over compiled night"], ""), ""))
    if not figures["instructions"]:
        found.append(("instructions", "neither perf nor valgrind can count here", ""))
    cost = " ".join(f"{row['nodes']}: {row['ms_per_node_and_s']:.2f}" for row in figures["nodes"])
    found += [
        ("cost per node, ms a simulated second, this way", cost, "flat"),
        ("memory", f"{memory['resident_MiB']:.0f} MiB, {memory['MiB_per_hour']:+.1f} MiB/h", ""),
        ("  ten-hour night, extrapolated", f"{memory['ten_hours_MiB']:.0f} MiB", "≤ 250, aim 120"),
        ("first command until it simulates", f"{start['first_run_s']:.1f} s", "≤ 3 s"),
        ("later command until it simulates", f"{start['later_run_s']:.2f} s", "≤ 0.8 s"),
        ("  a whole short run with its report", f"{start['short_run_with_report_s']:.1f} s", "≤ 2 s"),
        ("  schmidt --version", f"{start['version_s']:.2f} s", ""),
    ]
    return found + named.lines(figures["networks"]) + _served(figures["served"])


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
