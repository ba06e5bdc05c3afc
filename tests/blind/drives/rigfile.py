"""The rig file that the owner of such a drive would write from the documentation: what its maker tells."""

from tests.blind.drives.families import Family


def rig(f: Family, gain: float, turn: float, two: bool) -> str:
    """YAML text; `two`: the second position sensor is the response."""
    lines = [
        f"rig: {f.name}",
        "columns:",
        "  time: {column: t, unit: s}",
        f"  effort: {{column: effort, unit: {f.effort}}}",
        f"  position: {{column: position, unit: {f.position}, scale: {f.step!r}}}",
    ]
    if two:
        lines.append(f"  position2: {{column: load_position, unit: {f.position}, scale: {f.step!r}}}")
        lines.append(f"response: {{channel: position2, unit: {f.position}}}")
        lines.append("estimate: [offset]")
    else:
        lines.append(f"response: {{channel: effort, unit: {f.force}, gain: {gain!r}}}")
        lines.append("estimate: [inertia, viscous, coulomb, offset]")
    kind = ", kind: motor_cogging, harmonics: 60" if f.stage == "motor" else ", harmonics: 4"
    lines += ["stages:", f"  - {{name: {f.stage}, period: {turn!r}{kind}}}"]
    return "\n".join(lines) + "\n"
