"""One physical cause shows up in several channels: merge its traces into one finding, drop its
consequences."""

from __future__ import annotations

from dataclasses import replace

from calibration.finding import Finding
from calibration.inputs.train import Train

#: a finding of the key's name (in that channel) explains away findings of these names
CONSEQUENCES: dict[tuple[str, str], tuple[str, ...]] = {
    ("backlash_loss", "E"): (
        "structural_mode",
        "coulomb_change",
        "stribeck_change",
        "viscous_change",
        "shaft_compliance",
        "pwm_deadband",
        "supply_sag",
        "presliding",
        "damaged_tooth",
        "preload_change",
        "brake_drag",
        "cable_wrap",
        "gear_eccentricity",
        "friction_asymmetry",
        "position_friction",
        "adc_gain",
        "load_friction",
        "unknown",
    ),
    ("channel_delay", "S"): ("structural_mode", "roller_slip", "unknown", "damaged_tooth", "wind_torque"),
    ("sample_loss", "S"): ("wind_torque", "channel_delay", "roller_slip"),
    ("clock_jitter", "S"): ("roller_slip", "damaged_tooth", "unknown"),
    ("log_wrap", "S"): (
        "encoder_eccentricity",
        "roller_ratio",
        "roller_slip",
        "adc_gain",
        "magnet_weakening",
        "unknown",
        "structural_mode",
        "damaged_tooth",
        "channel_delay",
        "friction_asymmetry",
        "supply_sag",
        "command_disturbance",
        "sample_loss",
    ),
    ("magnet_weakening", "E"): ("adc_gain",),
    ("structural_mode", "T"): ("damaged_tooth",),
    ("brake_drag", "T"): ("friction_warmup",),
    ("unknown", "T"): ("wind_torque",),
    ("encoder_eccentricity", "K"): ("roller_ratio",),
    ("cable_wrap", "T"): ("preload_change", "friction_warmup"),
}
TWIST = "gear_eccentricity"
SAME_ORDER = 1e-6  # of an order: two counts of teeth that give the same one
SUPERFLUOUS = (
    0.25  # a second torque effect that takes less than this part of the first one's share is its remainder
)


def merge(findings: list[Finding], train: Train | None = None) -> list[Finding]:
    """Findings of all channels as a list of effects, strongest first; `train` of an axis with two motors."""
    out = _resolve_gain(findings)
    out = _resolve_motor(out, train) if train is not None else out
    out = _resolve_mesh(out)
    out = _same_key(out)
    out = _consequences(out)
    out = _remainders(out)
    return sorted(out, key=lambda f: -(f.share + min(f.evidence, 1000.0) / 1e5))


def traces(findings: list[Finding], kept: list[Finding]) -> list[tuple[str, str, str]]:
    """Refusals (channel, what, why) of the names that `merge` took for traces of others."""
    names = {f.name for f in kept}
    why = f"taken for a trace of {', '.join(sorted(names))}"
    return [(f.channel, f.name, why) for f in findings if f.name not in names]


def _resolve_gain(findings: list[Finding]) -> list[Finding]:
    """A torque that is too large on one motor: the electrical channel says whether its reading or its
    magnets."""
    electrical = {f.name for f in findings if f.channel == "E"}
    out = []
    for f in findings:
        if f.channel == "T" and f.name == "adc_gain":
            if "adc_gain" in electrical or "magnet_weakening" in electrical:
                continue
            f.equivalent = list(dict.fromkeys([*f.equivalent, "magnet_weakening"]))
        out.append(f)
    return out


def _resolve_motor(findings: list[Finding], train: Train) -> list[Finding]:
    """A torque line of the motor that the encoders see too is a twist of its gear: cogging twists nothing."""
    twists = {f.harmonic for f in findings if (f.channel, f.name, f.stage) == ("K", TWIST, train.motor)}
    out = []
    for f in findings:
        twist = f.channel == "T" and TWIST in f.equivalent and f.stage == train.motor and f.harmonic in twists
        if twist and f.name == "motor_cogging":
            p = f.parameters["amplitude"]  # cogging is told at the motor, a gear's torque at the axis
            told = replace(p.times(train.ratio), unit="N m")
            f = replace(f, name=TWIST, equivalent=[], parameters={"amplitude": told})
        out.append(f)
    return out


def _resolve_mesh(findings: list[Finding]) -> list[Finding]:
    """Two teeth of mesh 1 pass in the time of an even harmonic of the motor. Where the encoders see that mesh
    turn unevenly and the torque shows it too, cogging or ripple at the same order is what its shape leaves:
    they twist nothing."""

    def orders(channel: str) -> list[float]:
        return [f.order for f in findings if f.channel == channel and f.name == "gear_mesh" and f.order]

    both = [k for k in orders("K") if any(abs(k - t) < SAME_ORDER * k for t in orders("T"))]

    def imitates(f: Finding) -> bool:
        order = f.order or 0.0
        motor = f.channel == "T" and f.name in ("torque_ripple", "motor_cogging")
        return motor and any(abs(order - k) < SAME_ORDER * k for k in both)

    return [f for f in findings if not imitates(f)]


def _same_key(findings: list[Finding]) -> list[Finding]:
    best: dict[tuple[str, str | None], Finding] = {}
    for f in sorted(
        findings, key=lambda f: ("SKETU".find(f.channel) if f.name == "channel_delay" else 0, -f.share)
    ):
        key = (f.name, f.stage) if f.name != "unknown" else (f.name, f.domain)
        single = f.name in (
            "damaged_tooth",
            "structural_mode",
            "gravity_imbalance",
            "cable_wrap",
            "channel_delay",
            "friction_warmup",
            "preload_change",
            "encoder_eccentricity",
            "friction_asymmetry",
        )
        if single:
            key = (f.name, None)
        if key in best:
            first = best[key]
            if f.channel == "K" and "amplitude" in f.parameters and first.channel == "T":
                first.parameters["kinematic"] = f.parameters["amplitude"]
            elif first.channel == "K" and f.channel == "T" and "amplitude" in first.parameters:
                f.parameters["kinematic"] = first.parameters["amplitude"]
                best[key] = f
            if not single and f.harmonic != first.harmonic and f.channel == first.channel:
                best[(f"{f.name} {f.harmonic}", f.stage)] = f
            continue
        best[key] = f
    return list(best.values())


def _consequences(findings: list[Finding]) -> list[Finding]:
    drop: set[int] = set()
    for f in findings:
        names = CONSEQUENCES.get((f.name, f.channel), ())
        for k, other in enumerate(findings):
            if other is not f and other.name in names and _small_beside(f, other):
                drop.add(k)
    explained = max((f.share for f in findings if f.channel == "T" and f.name != "wind_torque"), default=0.0)
    for k, other in enumerate(findings):
        if other.name == "wind_torque" and explained > 0.4:
            drop.add(k)
    tooth = [f for f in findings if f.name == "damaged_tooth"]
    for k, other in enumerate(findings):
        if other.name in ("gear_eccentricity", "gear_mesh") and other.channel == "K" and tooth:
            drop.add(k)
        if other.name == "structural_mode" and other.parameters["damping"].value > 0.145:
            drop.add(k)
    return [f for k, f in enumerate(findings) if k not in drop]


def _small_beside(f: Finding, other: Finding) -> bool:
    """Whether `other` can be a trace of `f`. In one channel both were fitted together: what is more than a
    remainder there is an effect of its own. Wind has no columns and is never more than what is left."""
    if other.name == "wind_torque":
        return True
    if f.channel == other.channel == "T":
        return other.share < SUPERFLUOUS * f.share
    return other.share <= max(f.share, 0.3)


def _remainders(findings: list[Finding]) -> list[Finding]:
    torque = [f for f in findings if f.channel == "T" and f.share > 0]
    top = max((f.share for f in torque), default=0.0)
    return [
        f
        for f in findings
        if not (f.channel == "T" and 0 < f.share < SUPERFLUOUS * top and f.evidence < WEAK)
    ]


WEAK = 25.0  # -log10 p below which a small second torque effect is not worth its name
