"""Scores of candidate blocks and the surrogate distribution of their maximum.

The whitened residual's sign is drawn anew per block of rows (a wild block bootstrap). That keeps colour and
bursts, and destroys coherence with angle, speed or time beyond a block. The threshold is a quantile of the
largest score over all candidates.
"""

from dataclasses import dataclass

import numpy as np

from calibration.arrays import Array
from calibration.statistics.tails import wald_log10
from calibration.statistics.thresholds import APART, KEPT


@dataclass(frozen=True)
class Scores:
    """-log10 p of every candidate (k,), the threshold, and the largest of every surrogate (draws,)."""

    value: Array
    threshold: float
    surrogate_max: Array


def orthonormal_blocks(blocks: list[Array], q: Array) -> tuple[Array, list[int]]:
    """Candidates' columns orthonormal beside a basis, and how many remain: what is there is dropped."""
    turned = [(b, _turn(b, q)) for b in blocks]
    parts = [b @ turn - q @ (q.T @ (b @ turn)) for b, turn in turned]
    return np.hstack([q[:, :0], *parts]), [part.shape[1] for part in parts]


def taken_away(e: Array, q: Array, blocks: list[Array]) -> tuple[list[float], list[int]]:
    """Squares of `e` (n,) that blocks (n, k) take beside a basis (n, p), and how many columns count."""
    rest = e - q @ (q.T @ e)
    turned = [(b.T @ rest) @ _turn(b, q) for b in blocks]
    return [float(np.sum(a**2)) for a in turned], [len(a) for a in turned]


def basis(base: Array) -> Array:
    """Orthonormal columns (n, p) that span the base's."""
    return np.asarray(np.linalg.qr(base / np.maximum(np.linalg.norm(base, axis=0), 1e-300))[0])


def _turn(x: Array, q: Array) -> Array:
    """What makes a block (n, k) orthonormal beside q (n, p): (k, as many columns as count)."""
    whole, lost = x.T @ x, x.T @ q
    gram = whole - lost @ lost.T
    good = np.diag(gram) > KEPT * np.maximum(np.diag(whole), 1e-300)
    size = np.sqrt(np.diag(gram)[good])
    w, v = np.linalg.eigh(gram[np.ix_(good, good)] / size[:, None] / size)
    turn = np.zeros((len(gram), int((w > APART).sum())))
    turn[good] = v[:, w > APART] / np.sqrt(w[w > APART]) / size[:, None]
    return turn


def together(parts: list[tuple[Array, Array]], level: float) -> Scores:
    """The scores of all candidates, of what `score` gives for some at a time; `level` of the quantile."""
    values, largest = zip(*parts, strict=True)
    top = np.max(largest, axis=0)
    return Scores(np.concatenate(values), float(np.quantile(top, level)), top)


def score(
    e: Array, noise: Array, q: Array, widths: list[int], block: int, signs: Array
) -> tuple[Array, Array]:
    """-log10 p of `e` on every orthonormal block of `q`, and the largest of every surrogate of `noise`.

    `noise` lacks the effects found: none raises its own threshold. Wald statistics by its block sums.
    """
    total, parts = q.T @ e, np.add.reduceat(q * noise[:, None], np.arange(0, len(e), block), axis=0)
    null = signs @ parts
    floor = (float(np.mean(noise**2)) if len(noise) else 0.0) or 1.0  # no row may be usable at all
    gain = np.zeros((1 + len(signs), len(widths)))  # of the residual, and of every surrogate
    at = 0
    for k, width in enumerate(widths):
        own = slice(at, at + width)
        at = own.stop
        w, v = np.linalg.eigh(parts[:, own].T @ parts[:, own])
        half = v / np.sqrt(np.maximum(w, floor))
        gain[:, k] = np.sum((np.vstack([total[own], null[:, own]]) @ half) ** 2, axis=1)
    value = wald_log10(gain, np.maximum(np.array(widths), 1)[None, :], len(parts))
    return value[0], value[1:].max(axis=1, initial=0.0)
