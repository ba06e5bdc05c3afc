"""What to seal."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Order:
    """What to seal: cell (nothing, single, outside), family, name, ratio, noise, what is spoiled, seconds."""

    key: str
    cell: str
    kind: str  # the family
    names: tuple[str, ...] = ()
    ratio: float = 0.0
    noise: str = "gaussian"
    spoil: str = ""
    seconds: float = 30.0
    two: bool = False
    law: bool = False  # the reference is logged and the controller declared
