"""How the consoles look: red on black for a dark observatory floor, dark on light by day (theme.css)."""

from pathlib import Path

CSS = Path(__file__).with_name("theme.css").read_text(encoding="utf-8")
INK = {"night": "#ff6a5a", "day": "#0b5cad"}
SOFT = {"night": "#b3463b", "day": "#a85a00"}
LINE = {"night": "#5a1f1a", "day": "#c3cad2"}
