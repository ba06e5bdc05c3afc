"""Two peers on the residual that `schmidt calibrate` works on: same rows, same held-out part, same unit."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter, process_time

import numpy as np
from numpy.typing import NDArray

from calibration.inputs.axislog import read_axis_log
from calibration.inputs.rigfile import telescope
from calibration.look.axis_channels import analyse
from calibration.look.looked import Options
from plant.gears import ORDERS as STAGES
from tests.benchmarks.drives import TRUE_LINES, Drive

Floats = NDArray[np.float64]
Rows = NDArray[np.bool_]
#: the peers are given the gear table; mesh 1 is above the analysis grid's Nyquist frequency at these rates
ORDERS = {name: STAGES[name] for name in ("axis", "shaft2", "shaft1", "mesh3", "motor", "mesh2")}
HARMONICS = 2
FOLDS = 5
FOLD_S = 20.0  # s per piece dealt into a fold
SURE = 5.0  # standard errors, by the fit's own covariance, from which a line counts as named
ROBUST_NM = 3.0  # residuals beyond this count linearly in scipy's fit
THRESHOLDS_NM = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4)  # coefficient threshold of STLSQ, times inertia


class MissingPeer(ValueError):
    """A peer is not installed."""


@dataclass(frozen=True)
class Residual:
    """Torque balance of one log on the analysis grid."""

    t: Floats  # s
    angle: Floats  # rad at the axis
    rate: Floats  # rad/s
    acceleration: Floats  # rad/s2
    torque: Floats  # N m, motor torque at the axis
    left: Floats  # N m, what the re-calibrated declared model leaves
    declared: Floats  # N m, columns of lines that the plant file declares
    inertia: float  # kg m2
    friction: tuple[float, float, float, float]  # declared viscous (SI), Coulomb, stiction (N m), vs (rad/s)
    train: Rows
    test: Rows


@dataclass(frozen=True)
class Answer:
    """What a peer made of it: seconds, of CPU, held-out rms before and after (N m), terms, lines named."""

    seconds: float
    cpu_seconds: float
    before: float
    after: float
    terms: int
    lines: tuple[tuple[str, int], ...]
    note: str

    @property
    def named(self) -> bool:
        """Both true lines are among those named."""
        return set(TRUE_LINES) <= set(self.lines)


def residual_of(drive: Drive) -> Residual:
    """The residual as the calibration makes it, before any effect."""
    run = read_axis_log(drive.path)
    result = analyse([run], telescope(run.header["axis"]), Options())
    selection, motion = result.selections["T"], result.motion
    p, d = selection.problem, result.declared
    columns = [k for k, (label, _) in enumerate(p.base_labels) if label.startswith("declared ")]
    return Residual(
        p.t,
        motion.theta[motion.pick],
        motion.rate[motion.pick],
        motion.acceleration[motion.pick],
        p.y,
        selection.before.residual,
        p.base[:, columns],
        float(selection.before.beta[0]),
        (d.viscous, d.coulomb, d.stiction, d.stribeck_rate),
        p.train,
        p.test,
    )


def rms(values: Floats) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def sindy(r: Residual) -> Answer:
    """PySINDy on the residual acceleration: polynomials of the motion and Fourier terms of every shaft.

    The threshold is the one with the least error over pieces of the training part that were left out.
    Raises MissingPeer when PySINDy is not installed.
    """
    try:
        import pysindy
    except ImportError:
        raise MissingPeer("PySINDy is not installed: pip install 'schmidt[bench]', or make bench") from None
    begin, begin_cpu = perf_counter(), process_time()
    target = (r.left / r.inertia)[:, None]
    degree = np.pi / 180.0
    x = (r.rate / degree)[:, None]  # deg/s, so that coefficients of all terms are of one size
    angles = np.column_stack([r.angle * order for order in ORDERS.values()])
    u = np.column_stack([np.sign(r.rate), r.angle - r.angle.mean(), angles])
    names = ["rate", "sign", "angle", *ORDERS]

    def fit(rows: Rows, threshold_nm: float) -> tuple[object, Callable[[Rows], Floats]]:
        library = pysindy.GeneralizedLibrary(
            [pysindy.PolynomialLibrary(degree=2), pysindy.FourierLibrary(n_frequencies=HARMONICS)],
            inputs_per_library=[[0, 1, 2], list(range(3, 3 + len(ORDERS)))],
        )
        model = pysindy.SINDy(
            feature_library=library,
            optimizer=pysindy.STLSQ(threshold=threshold_nm / r.inertia, alpha=1e-6),
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it warns of every threshold that leaves nothing
            model.fit(x[rows], t=r.t[1] - r.t[0], x_dot=target[rows], u=u[rows], feature_names=names)
        return model, lambda some: np.asarray(model.predict(x[some], u=u[some]))[:, 0]

    piece = np.floor(r.t / FOLD_S).astype(int) % FOLDS
    errors = []
    for threshold in THRESHOLDS_NM:
        left = []
        for k in range(FOLDS):
            out = r.train & (piece == k)
            if out.any():
                predicted = fit(r.train & (piece != k), threshold)[1](out)
                left.append(target[out, 0] - predicted)
        errors.append(rms(np.concatenate(left)))
    best = THRESHOLDS_NM[int(np.argmin(errors))]
    model, predict = fit(r.train, best)
    after = r.inertia * rms(target[r.test, 0] - predict(r.test))
    coefficients = np.asarray(model.coefficients())[0]  # type: ignore[attr-defined]
    terms = [
        name
        for name, c in zip(model.get_feature_names(), coefficients, strict=True)  # type: ignore[attr-defined]
        if c != 0
    ]
    lines = [
        (stage, h)
        for stage in ORDERS
        for h in range(1, HARMONICS + 1)
        if any(f"({h} {stage})" in term for term in terms)
    ]
    return Answer(
        perf_counter() - begin,
        process_time() - begin_cpu,
        rms(r.left[r.test]),
        after,
        len(terms),
        tuple(lines),
        f"threshold {best:g} N m by {FOLDS}-fold cross-validation",
    )


def rate_of(logarithm: float) -> float:
    """A positive rate, rad/s, from its logarithm, which a trial step may carry far away."""
    return float(np.exp(np.clip(logarithm, -20.0, 2.0)))


def whole_vector(r: Residual) -> Answer:
    """scipy least squares of the torque balance's whole parameter vector, friction as a static map."""
    from scipy.optimize import least_squares

    begin, begin_cpu = perf_counter(), process_time()
    pairs = [
        wave(r.angle * order * h)
        for order in ORDERS.values()
        for h in range(1, HARMONICS + 1)
        for wave in (np.cos, np.sin)
    ]
    lines = np.column_stack(pairs)
    viscous, coulomb, stiction, speed = r.friction
    start = np.array(
        [r.inertia, viscous, coulomb, stiction - coulomb, np.log(speed), np.log(speed / 20), 0.0]
    )
    start = np.concatenate([start, np.zeros(r.declared.shape[1])])

    def friction(p: Floats, rows: Rows) -> Floats:
        w = r.rate[rows]
        level = p[2] + p[3] * np.exp(-((w / rate_of(p[4])) ** 2))
        static = level * np.tanh(w / rate_of(p[5])) + p[1] * w + p[6]
        return np.asarray(p[0] * r.acceleration[rows] + static + r.declared[rows] @ p[7 : len(start)])

    def fit(first: Floats, extra: Floats) -> tuple[Floats, Floats]:
        rows = r.train

        def left(p: Floats) -> Floats:
            return np.asarray(r.torque[rows] - friction(p, rows) - extra[rows] @ p[len(start) :])

        # robust: in the rows after a reversal no static map holds, and they would pull all others
        found = least_squares(left, first, x_scale="jac", loss="soft_l1", f_scale=ROBUST_NM, max_nfev=200)
        noise = 2.0 * found.cost / max(rows.sum() - len(found.x), 1)
        return found.x, noise * np.linalg.pinv(found.jac.T @ found.jac)

    plain, _ = fit(start, lines[:, :0])
    p, covariance = fit(np.concatenate([plain, np.zeros(lines.shape[1])]), lines)
    test = r.test
    before = rms(r.torque[test] - friction(plain, test))
    after = rms(r.torque[test] - friction(p, test) - lines[test] @ p[len(start) :])
    named = []
    for k in range(lines.shape[1] // 2):
        at = slice(len(start) + 2 * k, len(start) + 2 * k + 2)
        distance = float(p[at] @ np.linalg.pinv(covariance[at, at]) @ p[at])
        if distance > SURE**2:
            named.append((list(ORDERS)[k // HARMONICS], k % HARMONICS + 1))
    return Answer(
        perf_counter() - begin,
        process_time() - begin_cpu,
        before,
        after,
        len(p),
        tuple(named),
        "friction is a static map, without memory of the reversal; a line is named at 5 of its own errors",
    )
