"""The cheapest experiment that would tell two names apart, by pair of names (effects.md, last column of the
catalogue)."""

from __future__ import annotations

TABLE: dict[str, str] = {
    "friction_asymmetry": "run both directions at two speeds, and read the currents at locked rotor",
    "adc_offset": "read both currents at zero duty for ten seconds",
    "adc_gain": "lock the rotor and step the duty of each motor: a reading that is too large shows "
    "there, a weak magnet does not",
    "magnet_weakening": "drive each motor alone at two speeds and compare volts per speed",
    "gravity_imbalance": "move through at least 60 degrees slowly, there and back",
    "cable_wrap": "a full turn both ways: a cable loops, an imbalance does not",
    "position_friction": "go there and back over the same angle: friction changes its sign, a gear or "
    "cogging does not",
    "gear_eccentricity": "a second speed: a gear keeps its angle, a resonance its frequency; more travel "
    "splits close orders",
    "gear_mesh": "a second speed, and travel enough to split it from the neighbouring order",
    "motor_cogging": "hold the speed and vary the torque (raise the counter torque): ripple grows, "
    "cogging stays",
    "torque_ripple": "hold the speed and vary the torque (raise the counter torque): ripple grows, "
    "cogging stays",
    "bearing_pass": "twice the travel: the order stands clear of every gear",
    "structural_mode": "repeat at another speed: a mode keeps its frequency",
    "friction_warmup": "repeat the same run after a rest of half an hour: a warm-up comes back",
    "preload_change": "repeat the same run after a rest: a preload that has changed stays",
    "brake_drag": "repeat at two speeds: a brake adds the same torque at both",
    "stribeck_change": "slow ramps on both sides of the Stribeck speed",
    "viscous_change": "two speeds that differ by a factor of ten",
    "coulomb_change": "slow motion in both directions",
    "load_friction": "the same speed with counter torques of 10 and 25 %",
    "presliding": "a sine smaller than break-away",
    "backlash_loss": "raise the counter torque from 10 to 25 %: lost teeth come back",
    "shaft_compliance": "lock the axis and step the torque: play is a step, compliance a line",
    "encoder_eccentricity": "a full turn: eccentricity comes back after a turn, gravity is in the torque",
    "roller_ratio": "out and back over the same angle: a ratio cancels, slip does not",
    "roller_slip": "out and back with gentle and hard acceleration",
    "damaged_tooth": "slow travel over several turns of the shaft",
    "supply_sag": "record the supply voltage, or step one motor with the other off",
    "winding_heating": "locked rotor before and after a minute at full current",
    "diode_braking": "coast from speed with the drive off",
    "pwm_deadband": "a slow ramp of the duty through zero at locked rotor",
    "channel_delay": "one quick step, and compare the columns row by row",
    "unknown": "repeat the run: what is fixed to angle, to time or to neither tells where to look",
}


def experiment(names: list[str]) -> str | None:
    """Text for a class of names; None when there is nothing to separate."""
    texts = [f"{n}: {TABLE[n]}" for n in dict.fromkeys(names) if n in TABLE]
    return "; ".join(texts[:3]) if texts else None
