"""Scores of candidate blocks and the surrogate distribution of their maximum.

Surrogates are made of the user's own whitened residual: its sign is drawn anew per block of rows (a wild
block
bootstrap), which keeps colour inside a block and bursts of noise where they are, and destroys any coherence
with angle,
speed or time beyond a block. The threshold is a quantile of the largest score over all candidates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from calibration.readers.run import Array
from calibration.statistics.tails import chi2_log10


@dataclass(frozen=True)
class Scores:
    """-log10 p of every candidate, and the surrogate quantiles of the maximum."""

    value: Array
    gain: Array  # chi2 gain per candidate
    threshold: float
    surrogate_max: Array

    @property
    def p_of_maximum(self) -> float:
        """Fraction of surrogates whose maximum reaches ours (never zero)."""
        top = float(self.value.max()) if len(self.value) else 0.0
        return float((1 + np.sum(self.surrogate_max >= top)) / (1 + len(self.surrogate_max)))


KEPT = 1e-6  # of a column's sum of squares that must lie beside the base
APART = 1e-4  # smallest eigenvalue of a block's correlations: below, two columns are one


def orthonormal_blocks(x: Array, base: Array, widths: list[int]) -> tuple[Array, list[int]]:
    """Every candidate's columns made orthogonal to the base and orthonormal within the block.

    Columns that lose more than 1 - 1e-6 of their length to the base are dropped; returns the columns and
    widths left.
    """
    if base.shape[1]:
        q, _ = np.linalg.qr(base / np.maximum(np.linalg.norm(base, axis=0), 1e-300))
        left = x - q @ (q.T @ x)
    else:
        left = x.copy()
    before = np.maximum(np.linalg.norm(x, axis=0), 1e-300)
    out, kept, at = [], [], 0
    for width in widths:
        block = left[:, at : at + width]
        norm = np.linalg.norm(block, axis=0)
        good = norm > np.sqrt(KEPT) * before[at : at + width]
        at += width
        block = block[:, good] / np.maximum(norm[good], 1e-300)
        if block.shape[1] > 1:
            gram = block.T @ block
            w, v = np.linalg.eigh(gram)
            block = block @ (v[:, w > APART] / np.sqrt(w[w > APART]))
        out.append(block)
        kept.append(block.shape[1])
    return (np.hstack(out) if out else np.zeros((len(x), 0))), kept


def taken_away(e: Array, base: Array, blocks: list[Array]) -> tuple[list[float], list[int]]:
    """Sum of squares of `e` (n,) that every block (n, k) takes away beside the base (n, p), and how many of
    its columns count: as with orthonormal_blocks, from inner products alone."""
    if not blocks:
        return [], []
    if base.shape[1]:
        q, _ = np.linalg.qr(base / np.maximum(np.linalg.norm(base, axis=0), 1e-300))
        e = e - q @ (q.T @ e)
    else:
        q = np.zeros((len(e), 0))
    x = np.hstack(blocks)
    along, lost = x.T @ e, x.T @ q
    taken, kept, at = [], [], 0
    for b in blocks:
        k = slice(at, at + b.shape[1])
        at = k.stop
        whole = b.T @ b
        gram = whole - lost[k] @ lost[k].T
        good = np.diag(gram) > KEPT * np.maximum(np.diag(whole), 1e-300)
        size = np.sqrt(np.diag(gram)[good])
        w, v = np.linalg.eigh(gram[np.ix_(good, good)] / size[:, None] / size)
        apart = w > APART
        taken.append(float(np.sum(((along[k][good] / size) @ v[:, apart]) ** 2 / w[apart])))
        kept.append(int(apart.sum()))
    return taken, kept


@dataclass(frozen=True)
class Part:
    """-log10 p and chi2 gain of some candidates (k,), and -log10 p of every draw's (draws, k)."""

    value: Array
    gain: Array
    nulls: Array


def together(parts: list[Part], level: float) -> Scores:
    """The scores of all candidates; the threshold is a quantile of the largest over all of them."""
    largest = np.max(
        [p.nulls.max(axis=1) if p.nulls.shape[1] else np.zeros(len(p.nulls)) for p in parts], axis=0
    )
    return Scores(
        np.concatenate([p.value for p in parts]),
        np.concatenate([p.gain for p in parts]),
        float(np.quantile(largest, level)),
        largest,
    )


def score(e: Array, noise: Array, q: Array, widths: list[int], block: int, signs: Array) -> Part:
    """Scores of the whitened residual `e` on the orthonormal blocks `q`; surrogates are made of `noise` with
    the `signs` (draws, blocks of rows).

    `noise` is what is left once the effects found so far are out of the residual: an effect must not raise
    its own threshold. Every score is a Wald statistic with the covariance of the block sums of `noise`.
    """
    edges = np.arange(0, len(e), block)
    total = q.T @ e
    parts = np.add.reduceat(q * noise[:, None], edges, axis=0)
    null = signs @ parts
    floor = (float(np.mean(noise**2)) if len(noise) else 0.0) or 1.0  # no row may be usable at all
    value, gain = np.zeros(len(widths)), np.zeros(len(widths))
    nulls = np.zeros((len(signs), len(widths)))
    at = 0
    for k, width in enumerate(widths):
        if width == 0:
            continue
        block_parts = parts[:, at : at + width]
        spread = block_parts.T @ block_parts
        w, v = np.linalg.eigh(spread)
        half = v / np.sqrt(np.maximum(w, floor))
        gain[k] = float(np.sum((total[at : at + width] @ half) ** 2))
        nulls[:, k] = np.sum((null[:, at : at + width] @ half) ** 2, axis=1)
        at += width
    dof = np.maximum(np.array(widths), 1)
    value = chi2_log10(gain, dof)
    value[np.array(widths) == 0] = 0.0
    return Part(value, gain, chi2_log10(nulls, dof[None, :]))
