"""`python -m scenarios.bench [--json FILE] [--quick]`: measure, print, write JSON."""

from __future__ import annotations

import json
import os
import platform
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from scenarios.bench import network, startup, virtual

SIZES = (4, 8, 16, 32, 64)


def measure(quick: bool, say: Console) -> dict[str, Any]:
    """All figures. quick: shorter stretches, for trying the benchmark itself."""
    seconds = 10 if quick else 100
    with say.status("the whole network, full telemetry"):
        whole, traffic = network.whole_network(seconds)
    with say.status("the plant alone"):
        plant = network.plant_alone(seconds)
    with say.status("the same traffic over python-can's virtual bus"):
        peer = virtual.replay(traffic)
    with say.status("cost per node"):
        sizes = network.nodes(SIZES, seconds // 5)
    with say.status("memory"):
        memory = network.memory(max(200, seconds * 4))  # shorter, the first row groups look like growth
    with say.status("profile"):
        table = network.profile(max(5, seconds // 5), rows=1000)
    with say.status("start-up, compiling from nothing"):
        start = startup.startup()
    return {
        "machine": {
            "processor": platform.processor() or platform.machine(),
            "cores": os.cpu_count(),
            "load": os.getloadavg(),
        },
        "python": platform.python_version(),
        "network": whole,
        "plant": plant,
        "virtual_bus": peer,
        "ratio_to_virtual_bus": whole["real_time_factor"] / peer["real_time_factor"],
        "nodes": sizes,
        "memory": memory,
        "startup": start,
        "rooms": network.rooms(table),
        "profile": table[:25],
    }


def show(figures: dict[str, Any], console: Console) -> None:
    """Print the figures beside what was asked for."""
    whole, peer, memory, start = (figures[name] for name in ("network", "virtual_bus", "memory", "startup"))
    table = Table(
        title=f"schmidt bench, {figures['machine']['cores']} cores, load {figures['machine']['load'][0]:.1f}"
    )
    for column in ("what", "measured", "asked for"):
        table.add_column(column)
    per_node = [row["ms_per_node_and_s"] for row in figures["nodes"]]
    rows = (
        (
            "eleven nodes, host and all logs",
            f"{whole['real_time_factor']:.1f}× real time",
            "≥ 40×, goal 100×",
        ),
        ("  by CPU time of this process", f"{whole['cpu_time_factor']:.1f}×", ""),
        ("  best of five parts", f"{whole['best_real_time_factor']:.1f}×", ""),
        ("  traffic", f"{whole['frames_per_s']:.0f} frames/s, load {whole['bus_load']:.1%}", ""),
        ("plant alone, in one piece", f"{figures['plant']['real_time_factor']:.0f}×", ""),
        ("plant alone, every 5 ms", f"{figures['plant']['in_5_ms_pieces']:.0f}×", ""),
        ("python-can virtual bus, a Notifier per node", f"{peer['real_time_factor']:.1f}×", ""),
        ("schmidt over python-can", f"{figures['ratio_to_virtual_bus']:.1f} times", "≥ 4, goal 10"),
        ("cost per node, 4 to 64 nodes", " ".join(f"{each:.2f}" for each in per_node) + " ms/s", "flat"),
        ("memory", f"{memory['resident_MiB']:.0f} MiB, {memory['MiB_per_hour']:+.1f} MiB/h", ""),
        ("  ten-hour night", f"{memory['ten_hours_MiB']:.0f} MiB", "≤ 500 MB"),
        ("first command until it simulates", f"{start['first_run_s']:.1f} s", "≤ 15 s"),
        ("later command until it simulates", f"{start['later_run_s']:.1f} s", "≤ 2 s"),
        ("  a short run with its report", f"{start['short_run_with_report_s']:.1f} s", ""),
        ("  schmidt --version", f"{start['version_s']:.1f} s", ""),
    )
    for row in rows:
        table.add_row(*row)
    console.print(table)
    profile = Table(title="where the time goes (own time, measured with cProfile)")
    for column in ("function", "calls/s", "own", "with callees"):
        profile.add_column(column)
    for row in figures["profile"]:
        profile.add_row(
            row["function"],
            f"{row['calls_per_s']:.0f}",
            f"{row['own_share']:.1%}",
            f"{row['total_share']:.1%}",
        )
    console.print(profile)
    console.print("by room: " + ", ".join(f"{name} {share:.0%}" for name, share in figures["rooms"].items()))


@click.command()
@click.option("--json", "json_file", type=click.Path(path_type=Path))
@click.option("--quick", is_flag=True, help="Short stretches.")
def main(json_file: Path | None, quick: bool) -> None:
    """Measure the emulator's speed."""
    console = Console()
    figures = measure(quick, console)
    show(figures, console)
    if json_file is not None:
        json_file.parent.mkdir(parents=True, exist_ok=True)
        json_file.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
