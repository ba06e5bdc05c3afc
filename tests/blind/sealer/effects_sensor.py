"""Encoders, roller, clock and log: how each effect is drawn."""

import numpy as np

from tests.blind.sealer import declared as d
from tests.blind.sealer.draw import Drive
from tests.blind.sealer.drawn import Drawn

Rng = np.random.Generator
SIGNAL_PERIODS = 32768  # RCN829 data sheet


def encoder_eccentricity(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Order 1 and 2 error of the on-shaft encoder."""
    scaled = {"ECC_1": 1.0, "ECC_2": rng.uniform(0.0, 0.5)}
    fixed = {"ECC_1_PH": rng.uniform(0, d.TURN), "ECC_2_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("ECC_1", 1.0, "arcsec"), "amplitude_2": ("ECC_2", 1.0, "arcsec")}
    return Drawn("encoder_eccentricity", "K", ("axis_angle",), scaled, fixed, names, "axis", 1, 1.0)


def encoder_subdivision(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Interpolation error of the on-shaft encoder, once and twice per signal period."""
    scaled = {"SUB_1": 0.003, "SUB_2": 0.003 * rng.uniform(0.0, 0.7)}
    fixed = {"SUB_1_PH": rng.uniform(0, d.TURN), "SUB_2_PH": rng.uniform(0, d.TURN)}
    names = {"amplitude": ("SUB_1", 1.0, "arcsec"), "amplitude_2": ("SUB_2", 1.0, "arcsec")}
    return Drawn(
        "encoder_subdivision", "S", ("axis_angle",), scaled, fixed, names, None, 1, float(SIGNAL_PERIODS)
    )


def roller_ratio(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Roller diameter: incremental scale error."""
    return Drawn(
        "roller_ratio",
        "K",
        ("velocity", "axis_angle"),
        {"ROLLER_EPS": 3e-4 * float(rng.choice([-1.0, 1.0]))},
        {},
        {"scale": ("ROLLER_EPS", 1.0, "1")},
        "roller",
    )


def roller_slip(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Roller creeps while the axis accelerates harder than a limit."""
    fixed = {"SLIP_A0": 0.3 * 2400.0 * d.ARCSEC}
    names = {"slip": ("SLIP_C", 1.0, "s"), "limit": ("SLIP_A0", 1.0, "rad/s2")}
    return Drawn(
        "roller_slip", "K", ("velocity", "reversal", "time"), {"SLIP_C": 0.01}, fixed, names, "roller"
    )


def play(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """The coupling of the on-shaft encoder has a gap."""
    return Drawn(
        "play", "K", ("reversal", "velocity"), {"PLAY": 1.0}, {}, {"gap": ("PLAY", 1.0, "arcsec")}, "axis"
    )


def encoder_thermal_drift(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """On-shaft encoder drifts with temperature (column `temperature`)."""
    return Drawn(
        "encoder_thermal_drift",
        "K",
        ("temperature", "time"),
        {"DRIFT": 0.3},
        {},
        {"drift": ("DRIFT", 1.0, "arcsec/K")},
    )


def channel_delay(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """One column is late."""
    key = str(rng.choice(["DELAY_POS", "DELAY_TACH", "DELAY_ADC", "DELAY_VEL"]))
    size = {"DELAY_POS": 2e-6, "DELAY_TACH": 1e-3, "DELAY_ADC": 1e-3, "DELAY_VEL": 1e-3}[key]
    return Drawn("channel_delay", "S", ("clock", "velocity"), {key: size}, {}, {"delay": (key, 1.0, "s")})


def clock_jitter(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Time stamps jitter (the samples do not)."""
    return Drawn(
        "clock_jitter", "S", ("clock", "time"), {"JITTER": 1e-4}, {}, {"sigma": ("JITTER", 1.0, "s")}
    )


def sample_loss(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """Packets of 25 samples missing, or samples repeated: 1, 2 or 5 % of them."""
    fixed = {"LOSS": 0.01 * ratio, "LOSS_REPEAT": float(rng.random() < 0.4)}
    return Drawn(
        "sample_loss", "S", ("clock", "time"), {}, fixed, {"fraction": ("LOSS", 1.0, "1")}, how="fraction"
    )


def log_wrap(rng: Rng, drive: Drive, span: float, ratio: float) -> Drawn:
    """A column wraps or saturates early; 1, 2 or 5 % of the samples (WRAP_KIND: 0 velocity, 1 position, 2
    ADC top)."""
    fixed = {"WRAP": 0.01 * ratio, "WRAP_KIND": float(rng.integers(3))}
    return Drawn(
        "log_wrap", "S", ("clock", "velocity", "current", "axis_angle"), {}, fixed, {}, how="fraction"
    )
