"""`python -m tests.blind.diagram RESULTS PNG`: probability said against the share of right first names."""

import json
from pathlib import Path
from typing import Any

import click

from tests.blind.table import exact_interval


def points(rows: list[dict[str, Any]]) -> list[tuple[float, int, int]]:
    """(probability said, right, of) of every probability that was said, from the rows of results.json."""
    pairs = [pair for r in rows for pair in r.get("sureness", [])]
    out = []
    for said in sorted({p for p, _ in pairs}):
        hits = [ok for p, ok in pairs if p == said]
        out.append((float(said), int(sum(hits)), len(hits)))
    return out


def draw(found: list[tuple[float, int, int]], title: str, png: Path) -> None:
    """The diagram with 95 % intervals (Clopper-Pearson); a calibrated finder lies on the diagonal."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(4.5, 4.2), layout="constrained")
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    for said, right, of in found:
        low, high = exact_interval(right, of)
        share = right / of
        axes.errorbar(said, share, [[share - low], [high - share]], fmt="o", color="tab:blue", capsize=3)
        axes.annotate(f"{right} of {of}", (said, share), (-6, 0), textcoords="offset points", ha="right")
    axes.set(xlabel="probability said", ylabel="share of first names that were right", title=title)
    axes.set(xlim=(0, 1.03), ylim=(0, 1.03))
    figure.savefig(png, dpi=120)
    plt.close(figure)


@click.command()
@click.argument("results", type=click.Path(path_type=Path, exists=True))
@click.argument("png", type=click.Path(path_type=Path))
def main(results: Path, png: Path) -> None:
    """Draw the reliability diagram of a run's results.json."""
    data = json.loads(results.read_text())
    draw(points(data["cases"]), f"axis logs, seed {data['about']['seed']}", png)


if __name__ == "__main__":
    main()
