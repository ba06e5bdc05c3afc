"""An equation as plant/effects writes it, in TeX: known symbols become letters, all else stays words."""

import re

SYMBOLS = {
    "Ts": "T_s",
    "Tc": "T_c",
    "ws": r"\omega_s",
    "w": r"\omega",
    "w0": r"\omega_0",
    "dw": r"d\omega",
    "w_motor": r"\omega_{\text{motor}}",
    "T_gear": r"T_{\text{gear}}",
    "T_motor": r"T_{\text{motor}}",
    "T_drag": r"T_{\text{drag}}",
    "motor_angle": r"\text{motor angle}",
    "i_d": "i_d",
    "sigma0": r"\sigma_0",
    "sigma1": r"\sigma_1",
    "sigma2": r"\sigma_2",
    "delta": r"\delta",
    "phase": r"\varphi",
    "phase2": r"\varphi_2",
    "mu": r"\mu",
    "tau": r"\tau",
    "alpha": r"\alpha",
    "zeta": r"\zeta",
    "pi": r"\pi",
    "J2": "J_2",
    "V0": "V_0",
    "Rs": "R_s",
    "Rth": r"R_{\text{th}}",
    "t0": "t_0",
    "u0": "u_0",
    "dT": r"\Delta T",
    "dt": "dt",
    "dt2": "dt^2",
    "d2": "d^2",
    "de": "de",
    "dy": "dy",
    "dz": "dz",
    "dangle": r"d\,\text{angle}",
    "degC": r"\text{°C}",
    "exp": r"\exp",
    "cos": r"\cos",
    "sin": r"\sin",
    "max": r"\max",
    "sign": r"\text{sign}\,",
}
_LETTERS = set("ABFKNRTVabcdefghikmnpqrstuxyz")
_MARKS = {
    ",": r",\;",
    ";": r";\quad",
    "->": r"\to",
    "<=": r"\le",
    ">=": r"\ge",
    "<": r"\lt",
    ">": r"\gt",
    "*": r"\cdot",
}
_ARTICLE = re.compile(r"a [a-z]{3,} [a-z]{2,}")
"""Before two words, `a` is no factor."""
_TOKEN = re.compile(r"->|<=|>=|[A-Za-z][A-Za-z0-9_-]*|\d+(?:\.\d+)?|\s+|.")


def _words(text: str) -> str:
    return rf"\text{{{text}}}"


def tex(equation: str) -> str:
    """The equation in TeX, without dollars."""
    parts: list[str] = []
    words: list[str] = []

    def flush() -> None:
        if words:
            parts.append(_words(" ".join(words)))
            words.clear()

    for found in _TOKEN.finditer(equation):
        token = found[0]
        if token.isspace():
            continue
        article = token == "a" and _ARTICLE.match(equation, found.start())
        known = None if article else SYMBOLS.get(token) or (token if token in _LETTERS else None)
        if known is None and token[0].isalpha():
            words.append(token)
            continue
        flush()
        parts.append(known or _MARKS.get(token, token))
    flush()
    return _spaced(parts)


def _spaced(parts: list[str]) -> str:
    """Parts in a row, a thin space between two factors; an exponent of a word is held together."""
    row, last, marks = "", "", set(_MARKS.values())
    for part in parts:
        factor = bool(re.match(r"[\\A-Za-z0-9]", part)) and part not in marks
        before = bool(re.search(r"[A-Za-z0-9})]$", last)) and last not in marks
        if last == "^" and part.startswith("\\"):
            part = f"{{{part}}}"
        row += (r"\, " if factor and before and last != "^" else " ") + part
        last = part
    return row.strip().replace("^ ", "^").replace(" ^", "^")
