"""From the rows to the table of figures: counts, exact 95 % intervals, must, aim."""

from collections.abc import Callable
from typing import Any

import numpy as np

Row = dict[str, Any]


def exact_interval(hits: int, total: int) -> tuple[float, float]:
    """Clopper-Pearson 95 % interval of a share."""
    from scipy.stats import beta

    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, total - hits + 1))
    high = 1.0 if hits == total else float(beta.ppf(0.975, hits + 1, total - hits))
    return low, high


def share(rows: list[Row], test: Callable[[Row], bool]) -> dict[str, Any]:
    """Hits, total, share and its interval."""
    hits, total = sum(bool(test(row)) for row in rows), len(rows)
    if total == 0:
        return {"hits": 0, "total": 0, "value": None, "low": None, "high": None}
    low, high = exact_interval(hits, total)
    return {"hits": hits, "total": total, "value": hits / total, "low": low, "high": high}


def quotient(rows: list[Row], over: str, under: str) -> dict[str, Any]:
    """Median of a quotient of held-out errors with its bootstrap 95 % interval (fixed generator) and the 90
    % point."""
    pairs = [(r["held_out"][over], r["held_out"][under]) for r in rows if r.get("held_out")]
    values = np.array([a / b for a, b in pairs if b])
    if len(values) == 0:
        return {"total": 0, "value": None, "low": None, "high": None, "p90": None}
    rng = np.random.default_rng(1)
    medians = np.median(rng.choice(values, (2000, len(values))), axis=1)
    low, high = (float(x) for x in np.quantile(medians, [0.025, 0.975]))
    p90 = float(np.quantile(values, 0.9))
    return {"total": len(values), "value": float(np.median(values)), "low": low, "high": high, "p90": p90}


def figures(rows: list[Row]) -> list[dict[str, Any]]:
    """The figures of the table, in its order. Cases whose finder gave no answer count against it."""
    nothing = [r for r in rows if r["cell"] == "nothing"]
    single = [r for r in rows if r["cell"] == "single"]
    strong = [r for r in single if r["ratio"] >= 2.0]
    pairs = [r for r in rows if r["cell"] == "pair"]
    outside = [r for r in rows if r["cell"] == "outside"]
    boxes = [i for r in rows for i in r.get("intervals", [])]
    answered = [r for r in rows if r["answered"] and r["named"] > 0]
    floor, before = quotient(strong, "after", "floor"), quotient(strong, "after", "before")

    def line(name: str, must: str, aim: str, measured: dict[str, Any], ok: bool | None) -> dict[str, Any]:
        return {"figure": name, "must": must, "aim": aim, "measured": measured, "met": ok}

    def at_most(m: dict[str, Any], limit: float) -> bool | None:
        return None if m["value"] is None else m["value"] <= limit

    def at_least(m: dict[str, Any], limit: float) -> bool | None:
        return None if m["value"] is None else m["value"] >= limit

    named = share(nothing, lambda r: r["named"] > 0 or not r["answered"])
    one = share(strong, lambda r: r["right"])
    both = share(pairs, lambda r: r["right"])
    out = share(outside, lambda r: r["right"])
    bad = share(answered, lambda r: r.get("worse", False))
    inside = share(boxes, lambda i: i["inside"])
    covered = None if inside["value"] is None else 0.93 <= inside["value"] <= 0.97
    sure = share(rows, lambda r: bool(r.get("sure_and_wrong")))
    tail = {**floor, "value": floor["p90"], "low": None, "high": None}
    must = [
        line("logs without an effect in which one is named", "≤ 1 %", "0", named, at_most(named, 0.01)),
        line("right name or right class, one effect, ratio ≥ 2", "≥ 97 %", "99 %", one, at_least(one, 0.97)),
        line("both names and none extra, two effects", "≥ 90 %", "95 %", both, at_least(both, 0.9)),
        line("outside the catalogue: `unknown`, right domain", "≥ 95 %", "98 %", out, at_least(out, 0.95)),
        line("a wrong name with probability > 0.9, all cases", "≤ 1 %", "0", sure, at_most(sure, 0.01)),
        line(
            "held-out after / floor, one effect, ratio ≥ 2 (median)",
            "≤ 1.2",
            "1.05",
            floor,
            at_most(floor, 1.2),
        ),
        line("held-out after / floor, same (90th percentile)", "≤ 2", "1.3", tail, at_most(tail, 2.0)),
        line("held-out after / before, same (median)", "≤ 0.5", "floor/before", before, at_most(before, 0.5)),
        line("accepted effects that make held-out data worse", "0", "0", bad, at_most(bad, 0.0)),
        line("95 % intervals that contain the truth", "93–97 %", "95 %", inside, covered),
    ]
    more = [
        line("one effect, ratio ≥ 2: the name itself", "", "", share(strong, lambda r: r["exact"]), None),
        line(
            "one effect, ratio ≥ 2: right and none extra",
            "",
            "",
            share(strong, lambda r: r["right"] and not r["extra"]),
            None,
        ),
        *(
            line(
                f"one effect, ratio {x:g}: right",
                "",
                "",
                share([r for r in single if r["ratio"] == x], lambda r: r["right"]),
                None,
            )
            for x in (1.0, 2.0, 5.0)
        ),
        line(
            "stage right where there is one, ratio ≥ 2",
            "",
            "",
            share([r for r in strong if r.get("staged")], lambda r: r["stage_right"]),
            None,
        ),
        *(
            line(
                f"nothing, {k}: one named",
                "",
                "",
                share([r for r in nothing if r["kind"] == k], lambda r: r["named"] > 0),
                None,
            )
            for k in ("pure", "off", "gains")
        ),
        line(
            "nothing: answered `unknown`",
            "",
            "",
            share(nothing, lambda r: r["answered"] and r["named"] == 0 and not r["right"]),
            None,
        ),
        line(
            "two effects that look alike",
            "",
            "",
            share([r for r in pairs if "-twin-" in r["key"]], lambda r: r["right"]),
            None,
        ),
        line(
            "outside the catalogue: `unknown`, any domain",
            "",
            "",
            share(outside, lambda r: r["unknown"]),
            None,
        ),
        line("cases without an answer", "0", "0", share(rows, lambda r: not r["answered"]), None),
    ]
    return must + more


def text_of(measured: dict[str, Any]) -> str:
    """One cell: value, interval, counts."""
    if measured["value"] is None:
        return "not measured"
    if "hits" in measured:
        v, lo, hi = (100.0 * measured[k] for k in ("value", "low", "high"))
        return f"{v:.1f} % ({lo:.1f}–{hi:.1f}), {measured['hits']} of {measured['total']}"
    if measured["low"] is None:
        return f"{measured['value']:.3f}, n = {measured['total']}"
    return f"{measured['value']:.3f} ({measured['low']:.3f}–{measured['high']:.3f}), n = {measured['total']}"


def markdown(lines: list[dict[str, Any]], about: dict[str, Any]) -> str:
    """The table as Markdown."""
    out = ["| figure | must | aim | measured (95 % interval) | met |", "|---|---|---|---|---|"]
    for item in lines:
        met = {True: "yes", False: "**no**", None: ""}[item["met"]]
        out.append(
            f"| {item['figure']} | {item['must']} | {item['aim']} | {text_of(item['measured'])} | {met} |"
        )
    out.append("")
    out.append(
        f"Seed {about['seed']}, {about['cases']} cases, {about['wall_s'] / 60.0:.0f} min wall time with "
        f"{about['jobs']} processes; finder {about['finder_median_s']:.1f} s a case (median), "
        f"{about['finder_max_s']:.1f} s at most; commit {about['commit']}."
    )
    return "\n".join(out) + "\n"


def reliability(rows: list[Row]) -> str:
    """What names were said to be worth against how often they were right, one line per probability said."""
    pairs = [pair for r in rows for pair in r.get("sureness", [])]
    out = ["| probability said | right | of | 95 % interval |", "|---|---|---|---|"]
    for said in sorted({p for p, _ in pairs}, reverse=True):
        hits = [ok for p, ok in pairs if p == said]
        low, high = exact_interval(int(sum(hits)), len(hits))
        out.append(f"| {said:.3f} | {sum(hits):.0f} | {len(hits)} | {100 * low:.0f}–{100 * high:.0f} % |")
    return "\n".join(out) + "\n"


def per_name(rows: list[Row]) -> str:
    """One line per catalogue name: hits by ratio, and what was said instead."""
    out = ["| effect | ratio 1 | ratio 2 | ratio 5 | said instead |", "|---|---|---|---|---|"]
    single = [r for r in rows if r["cell"] == "single"]
    for name in sorted({r["truth"][0] for r in single}):
        mine = [r for r in single if r["truth"][0] == name]
        cells = []
        for ratio in (1.0, 2.0, 5.0):
            some = [r for r in mine if r["ratio"] == ratio]
            cells.append(f"{sum(r['right'] for r in some)}/{len(some)}")
        wrong = [
            r["said"][0][0] if r["said"] else (r["verdict"] or "no answer") for r in mine if not r["right"]
        ]
        out.append(f"| {name} | {' | '.join(cells)} | {', '.join(f'{w}' for w in wrong)} |")
    return "\n".join(out) + "\n"
