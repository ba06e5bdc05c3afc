"""Speed of the whole network, of the plant alone, cost per node, memory, and where the time goes."""

from __future__ import annotations

import cProfile
import os
import pstats
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bus.can import Frame
from plant.model import load
from plant.plant import Plant
from scenarios import run as runner
from scenarios.network import NetworkConfig, build
from scenarios.session import Session, start_steps

SCENARIO = Path(__file__).parents[1] / "observing-night.yaml"
_SETTLED_S = 40
"""By then the telescope tracks its first star."""
_SECOND_NS = 1_000_000_000


def session(folder: Path) -> Session:
    """The main scenario with all logs, run until it tracks."""
    scenario, model = runner.prepare(SCENARIO)
    made = Session(scenario, model, folder)
    made.advance(_SETTLED_S * _SECOND_NS)
    return made


def factor(advance: Callable[[int], None], start_ns: int, seconds: int, parts: int = 5) -> dict[str, float]:
    """Simulated over wall and over CPU time: the median of several parts, and the best."""
    walls, cpus = [], []
    for part in range(parts):
        wall, cpu = time.perf_counter(), time.process_time()
        advance(start_ns + (part + 1) * seconds * _SECOND_NS // parts)
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    simulated = seconds / parts
    middle = parts // 2
    return {
        "real_time_factor": simulated / sorted(walls)[middle],
        "cpu_time_factor": simulated / sorted(cpus)[middle],
        "best_real_time_factor": simulated / min(walls),
    }


def whole_network(seconds: int) -> tuple[dict[str, Any], list[tuple[int, Frame, str]]]:
    """Eleven nodes with host, logs and full telemetry; also a second of its traffic."""
    with tempfile.TemporaryDirectory() as folder:
        made = session(Path(folder))
        frames_before = made.network.wire.frames
        start_ns = made.network.queue.now_ns
        figures: dict[str, Any] = dict(factor(made.advance, start_ns, seconds))
        figures["frames_per_s"] = (made.network.wire.frames - frames_before) / seconds
        figures["bus_load"] = made.network.wire.load
        traffic: list[tuple[int, Frame, str]] = []
        made.network.wire.tap(lambda t, frame, sender: traffic.append((t, frame, sender)))
        made.advance(made.network.queue.now_ns + _SECOND_NS)
        made.recorder.close()
    return figures, traffic


def plant_alone(seconds: int) -> dict[str, float]:
    """Both axes without boards, advanced every 5 ms and in one piece a second."""
    scenario, model = runner.prepare(SCENARIO)
    plant = Plant(model, 1, start_steps(scenario))
    plant.advance(_SECOND_NS)
    whole = factor(plant.advance, plant.now_ns, seconds)

    def ticking(until_ns: int) -> None:
        for t_ns in range(plant.now_ns, until_ns + 1, 5_000_000):
            plant.advance(t_ns)

    ticked = factor(ticking, plant.now_ns, seconds)
    return {"real_time_factor": whole["real_time_factor"], "in_5_ms_pieces": ticked["real_time_factor"]}


def nodes(sizes: tuple[int, ...], seconds: int) -> list[dict[str, float]]:
    """Cost per node: boards, bus and plant without the host, for networks of several sizes."""
    rows = []
    for size in sizes:
        scenario, _ = runner.prepare(SCENARIO)
        network = build(NetworkConfig(size=size), Plant(load(), 1, start_steps(scenario)), 1)
        network.run_until(_SECOND_NS)
        made = factor(network.run_until, network.queue.now_ns, seconds)
        per_node = 1e3 / made["cpu_time_factor"] / size
        rows.append({"nodes": size, "ms_per_node_and_s": per_node, **made, "bus_load": network.wire.load})
    return rows


def memory(seconds: int) -> dict[str, float]:
    """Growth of the resident set, MiB per simulated hour, and what a ten-hour night would reach."""
    with tempfile.TemporaryDirectory() as folder:
        made = session(Path(folder))
        made.advance(
            made.network.queue.now_ns + seconds // 2 * _SECOND_NS
        )  # fill buffers and row groups first
        before, start_ns = resident_mib(), made.network.queue.now_ns
        while made.network.queue.now_ns < start_ns + seconds * _SECOND_NS:
            made.advance(made.network.queue.now_ns + _SECOND_NS)
            made.recorder.flush()
        after = resident_mib()
        made.recorder.close()
    per_hour = (after - before) * 3600 / seconds
    return {"resident_MiB": after, "MiB_per_hour": per_hour, "ten_hours_MiB": after + 10 * max(0.0, per_hour)}


def resident_mib() -> float:
    """Resident set of this process, MiB (its peak where the system has no /proc)."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def profile(seconds: int, rows: int = 25) -> list[dict[str, Any]]:
    """Where the time goes: the functions with most time of their own, cProfile's overhead included."""
    with tempfile.TemporaryDirectory() as folder:
        made = session(Path(folder))
        profiler = cProfile.Profile()
        profiler.enable()
        made.advance(made.network.queue.now_ns + seconds * _SECOND_NS)
        profiler.disable()
        made.recorder.close()
    stats: Any = pstats.Stats(profiler)
    total = stats.total_tt
    root = Path(__file__).parents[2]
    table = []
    for (file, line, name), (_, calls, own, cumulative, _) in stats.stats.items():
        place = Path(file)
        short = (
            str(place.relative_to(root)) if place.is_relative_to(root) and ".venv" not in file else place.name
        )
        table.append(
            {
                "function": f"{short}:{line} {name}" if line else name,
                "calls_per_s": calls / seconds,
                "own_share": own / total,
                "total_share": cumulative / total,
            }
        )
    return sorted(table, key=lambda row: -row["own_share"])[:rows]


def rooms(table: list[dict[str, Any]]) -> dict[str, float]:
    """Own time by room, from a profile table."""
    shares: dict[str, float] = {}
    for row in table:
        room = row["function"].split("/", 1)[0] if "/" in row["function"] else "libraries"
        shares[room] = shares.get(room, 0.0) + row["own_share"]
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


__all__ = ["memory", "nodes", "plant_alone", "profile", "rooms", "whole_network"]
