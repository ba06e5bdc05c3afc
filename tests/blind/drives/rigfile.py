"""The rig file that the owner of such a drive would write from the documentation: what its maker tells."""

from tests.blind.drives.families import Family


def controller(f: Family, plant: dict[str, float]) -> str:
    """The loop's law in the words of docs/reference/rigs.md."""
    p, v = plant["KP"], plant.get("KV", 0.0)
    if plant.get("CASCADE", 0.0) > 0.5:
        gains = f"position: {p!r}, velocity: {v!r}, rate_feedforward: {v!r}"
        return f"controller: {{law: cascade, gains: {{{gains}}}, limit: {plant['TOP']!r}, source: its maker}}"
    gains = f"p: {p!r}, i: {plant.get('KI', 0.0)!r}, d: {plant['KD']!r}"
    return f"controller: {{law: pid, gains: {{{gains}}}, limit: {plant['TOP']!r}, source: its maker}}"


def rig(f: Family, plant: dict[str, float], turn: float, two: bool, law: bool) -> str:
    """YAML text; `two`: the second position sensor is the response; `law`: with reference and controller."""
    lines = [
        f"rig: {f.name}",
        "columns:",
        "  time: {column: t, unit: s}",
        f"  effort: {{column: effort, unit: {f.effort}}}",
        f"  position: {{column: position, unit: {f.position}, scale: {f.step!r}}}",
    ]
    if law:
        lines.append(f"  reference: {{column: reference, unit: {f.position}}}")
        lines.append(controller(f, plant))
    if two:
        lines.append(f"  position2: {{column: load_position, unit: {f.position}, scale: {f.step!r}}}")
        lines.append(f"response: {{channel: position2, unit: {f.position}}}")
        lines.append("estimate: [offset]")
    else:
        lines.append(f"response: {{channel: effort, unit: {f.force}, gain: {plant['GAIN']!r}}}")
        lines.append("estimate: [inertia, viscous, coulomb, offset]")
    kind = ", kind: motor_cogging, harmonics: 60" if f.stage == "motor" else ", harmonics: 4"
    lines += ["stages:", f"  - {{name: {f.stage}, period: {turn!r}{kind}}}"]
    return "\n".join(lines) + "\n"
