"""How the consoles look: red on black for a dark observatory floor, light on dark by day (theme.css)."""

from pathlib import Path

CSS = Path(__file__).with_name("theme.css").read_text(encoding="utf-8")
INK = {"night": "#ff6a5a", "day": "#9ecbff"}
SOFT = {"night": "#b3463b", "day": "#f0b673"}
LINE = {"night": "#5a1f1a", "day": "#3b4656"}
