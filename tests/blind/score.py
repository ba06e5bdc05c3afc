"""Score one answer against one truth."""

from typing import Any

# Ambiguous answers are right when they contain the truth and stay inside one of these groups: the pairs
# that the catalogue itself calls twins. A certain answer must be the name.
TWINS: tuple[frozenset[str], ...] = (
    frozenset({"position_friction", "gravity_imbalance", "cable_wrap"}),
    frozenset({"friction_asymmetry", "adc_offset"}),
    frozenset({"adc_offset", "adc_gain"}),
    frozenset({"motor_cogging", "torque_ripple"}),
    frozenset({"backlash_loss", "shaft_compliance"}),
    frozenset({"coulomb_change", "load_friction", "viscous_change"}),
    frozenset({"stribeck_change", "presliding"}),
    frozenset({"preload_change", "brake_drag", "friction_warmup", "magnet_weakening"}),
    frozenset({"winding_heating", "magnet_weakening"}),
    frozenset({"gear_eccentricity", "damaged_tooth"}),
    frozenset({"encoder_eccentricity", "encoder_thermal_drift"}),
    frozenset({"roller_ratio", "roller_slip"}),
    frozenset({"supply_sag", "pwm_deadband"}),
)
SURE = 0.9  # probability of a name beyond which it must not be wrong
CHANNEL_KEYS = {
    "T": ("torque",),
    "K": ("position", "velocity"),
    "E": ("electrical", "torque"),
    "S": ("velocity", "position"),
}


def right(effect: dict[str, Any], truth: dict[str, Any]) -> bool:
    """Right name, or right class."""
    said = {effect["name"], *effect.get("equivalent", [])}
    name = truth["name"]
    if effect["name"] == name:
        return True
    if set(truth["class"]) >= said:
        return True
    return name in said and any(said <= group for group in TWINS)


def match(effects: list[dict[str, Any]], truths: list[dict[str, Any]]) -> tuple[int, int]:
    """How many truths are answered by an effect of their own, and how many effects are left over."""
    rest = list(effects)
    hits = 0
    for truth in truths:
        exact = [e for e in rest if e["name"] == truth["name"]] or [e for e in rest if right(e, truth)]
        if exact:
            hits += 1
            rest.remove(exact[0])
    return hits, len(rest)


def held_out(report: dict[str, Any], channel: str | None) -> dict[str, float] | None:
    """before, after, floor of the channel the effect lives in; without one, of the channel furthest off its
    floor."""
    errors = {k: e for k, e in report.get("error", {}).items() if e.get("floor") is not None}
    if not errors:
        return None
    for key in CHANNEL_KEYS.get(channel or "", ()):
        if key in errors:
            return dict(errors[key])
    return dict(max(errors.values(), key=lambda e: e["before"] / e["floor"]))


def worse(report: dict[str, Any]) -> bool:
    """An accepted effect made its own channel worse on held-out data."""
    for effect in report.get("effects", []):
        error = held_out(report, effect.get("channel"))
        if error is not None and error["after"] > error["before"] * (1.0 + 1e-9):
            return True
    return False


def wrong_names(effects: list[dict[str, Any]], truths: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Stated catalogue names that are no hidden effect's, by the answer's first name or class."""
    return [e for e in effects if e["name"] != "unknown" and not any(right(e, t) for t in truths)]


def sureness(effects: list[dict[str, Any]], truths: list[dict[str, Any]]) -> list[list[float]]:
    """[probability, 1 or 0 for a right first name] of every stated effect that has a probability."""
    names = {t["name"] for t in truths}
    return [
        [
            e["probability"],
            float(e["name"] in names or (e["name"] == "unknown" and bool(names) and not known(truths))),
        ]
        for e in effects
        if e.get("probability") is not None
    ]


def known(truths: list[dict[str, Any]]) -> bool:
    """Whether the hidden effects are of the catalogue."""
    return all(t.get("in_catalogue", True) for t in truths)


def intervals(report: dict[str, Any], truth: dict[str, Any]) -> list[dict[str, Any]]:
    """Every reported 95 % interval whose true value is known: calibrated figures, and parameters of right
    names."""
    from tests.blind.names import calibrated_truths, parameter_truths

    out: list[dict[str, Any]] = []
    known = calibrated_truths(truth)
    for name, item in report.get("calibrated", {}).items():
        if name in known and item.get("low") is not None and item.get("high") is not None:
            inside = any(item["low"] <= value <= item["high"] for value in known[name])
            out.append({"name": name, "of": "calibrated", "inside": inside})
    for effect in report.get("effects", []):
        for wanted in truth["effects"]:
            if effect["name"] != wanted["name"]:
                continue
            values = parameter_truths(wanted, truth)
            for name, item in effect.get("parameters", {}).items():
                if name in values and item.get("low") is not None and item.get("high") is not None:
                    inside = any(item["low"] <= value <= item["high"] for value in values[name])
                    out.append({"name": f"{effect['name']}.{name}", "of": "effect", "inside": inside})
    return out


def score(answer: dict[str, Any], report: dict[str, Any] | None, truth: dict[str, Any]) -> dict[str, Any]:
    """One row of results."""
    row: dict[str, Any] = {
        "key": truth["key"],
        "cell": truth["cell"],
        "kind": truth["kind"],
        "poor": truth["poor"],
        "truth": [e["name"] for e in truth["effects"]],
        "ratio": min((e["ratio"] for e in truth["effects"]), default=0.0),
        "seconds": answer["seconds"],
        "failure": answer["failure"],
        "answered": report is not None,
    }
    effects = list(report["effects"]) if report else []
    named = [e for e in effects if e["name"] != "unknown"]
    row["verdict"] = report["verdict"] if report else None
    row["said"] = [[e["name"], *e.get("equivalent", [])] for e in effects]
    row["named"] = len(named)
    hits, extra = match(effects, truth["effects"])
    row["hits"], row["extra"] = hits, extra
    top = effects[0] if effects else None
    if truth["cell"] == "single":
        wanted = truth["effects"][0]
        row["right"] = bool(top and right(top, wanted))
        row["exact"] = bool(top and top["name"] == wanted["name"])
        row["staged"] = wanted["stage"] is not None
        row["stage_right"] = bool(top and row["right"] and top.get("stage") == wanted["stage"])
    if truth["cell"] == "pair":
        row["right"] = hits == 2 and extra == 0
    if truth["cell"] == "outside":
        wanted = truth["effects"][0]
        row["right"] = bool(top and top["name"] == "unknown" and top.get("domain") in wanted["domain"])
        row["unknown"] = bool(top and top["name"] == "unknown")
    if truth["cell"] == "nothing":
        row["right"] = report is not None and not effects
    wrong = wrong_names(effects, truth["effects"])
    row["wrong"] = len(wrong)
    row["sure_and_wrong"] = sum((e.get("probability") or 0.0) > SURE for e in wrong)
    row["sureness"] = sureness(effects, truth["effects"])
    if report is not None:
        first = truth["effects"][0]["channel"] if truth["effects"] else None
        row["held_out"] = held_out(report, first)
        row["worse"] = worse(report)
        row["intervals"] = intervals(report, truth)
    return row
