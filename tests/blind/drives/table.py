"""The figures of the other drives, and a line per hidden effect."""

from typing import Any

from tests.blind.table import quotient, share, text_of

Row = dict[str, Any]
LEAST = 1.8  # ratio that a measured effect must have come to, of 2 asked for: sizes are met to a tenth


def markdown(rows: list[Row], seed: int) -> str:
    """The table as Markdown."""
    cells = ("nothing", "single", "outside", "short")
    nothing, single, outside, brief = ([r for r in rows if r["cell"] == c] for c in cells)
    single, small = [r for r in single if r["reached"] >= LEAST], [r for r in single if r["reached"] < LEAST]
    figures = [
        (
            "nothing hidden, an effect named",
            "≤ 3 %",
            share(nothing, lambda r: bool(r["wrong"]) or not r["answered"]),
        ),
        (
            "nothing hidden, `unknown` said",
            "",
            share(nothing, lambda r: any("unknown" in s for s in r["said"])),
        ),
        ("one effect, ratio ≥ 2, right name or class", "≥ 90 %", share(single, lambda r: r["right"])),
        ("the same, no plausible size comes to ratio 2", "", share(small, lambda r: r["right"])),
        ("one effect, a wrong name among those said", "", share(single, lambda r: bool(r["wrong"]))),
        ("one effect, `cannot tell` or nothing", "", share(single, lambda r: not r["said"])),
        ("outside, `unknown` in the right domain", "≥ 95 %", share(outside, lambda r: r["right"])),
        (
            "a wrong name with probability > 0.9, all cases",
            "≤ 1 %",
            share(rows, lambda r: bool(r["sure_and_wrong"])),
        ),
        (
            "held-out data made worse",
            "0",
            share([r for r in rows if r["said"]], lambda r: bool(r.get("worse"))),
        ),
        ("cases without an answer", "0", share(rows, lambda r: not r["answered"])),
    ]
    staged = [r for r in single if r.get("stage_right") is not None]
    if staged:
        figures.append(
            ("one effect, its stage is the first answer's", "", share(staged, lambda r: r["stage_right"]))
        )
        figures.append(
            ("an effect named whose interval holds zero", "", share(rows, lambda r: bool(r["empty"])))
        )
    if brief:
        figures.append(
            ("short logs: named, or `cannot tell` with the name", "", share(brief, lambda r: r["right"]))
        )
        figures.append(
            ("short logs: a bare `nothing`", "", share(brief, lambda r: r["verdict"] == "nothing"))
        )
    out = ["| figure | must | measured (95 % interval) |", "|---|---|---|"]
    out += [f"| {name} | {must} | {text_of(measured)} |" for name, must, measured in figures]
    left = quotient(single, "after", "floor")
    if left["total"]:
        out.append(
            f"| held-out after / floor, one effect, ratio ≥ 2: median; 90th percentile | ≤ 1.2; ≤ 2 |"
            f" {left['value']:.2f} ({left['low']:.2f}–{left['high']:.2f}); {left['p90']:.2f},"
            f" n = {left['total']} |"
        )
    seconds = sorted(r["seconds"] for r in rows)
    out += [
        "",
        f"Seed {seed}, {len(rows)} cases; {seconds[len(seconds) // 2]:.1f} s a case (median),"
        f" {seconds[-1]:.1f} s at most.",
        "",
    ]
    out += ["| hidden | right | said otherwise |", "|---|---|---|"]
    for name in sorted({r["truth"] for r in rows}):
        mine = [r for r in rows if r["truth"] == name]
        other = [
            f"{r['family']}: {r['said'][0][0] if r['said'] else r['verdict'] or 'no answer'}"
            for r in mine
            if not r["right"]
        ]
        out.append(
            f"| {name or 'nothing'} | {sum(r['right'] for r in mine)}/{len(mine)} | {', '.join(other)} |"
        )
    return "\n".join(out) + "\n"
