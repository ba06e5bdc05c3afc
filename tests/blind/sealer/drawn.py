"""What a drawn effect is: kernel slots and sensor figures, those that scale with its size and those that do
not."""

from dataclasses import dataclass, field


@dataclass
class Drawn:
    """One effect of one case, before and after its size is set.

    scaled: slot or sensor name -> value at size 1 (about the floor); fixed: not scaled.
    parameters: truth name -> (slot or sensor name, factor to unit, unit).
    how: "measured" (size set so that residual/floor has the wanted ratio), "tolerance" (values already
    carry the
    ratio as multiples of the declared tolerance), "fraction" (values already carry the share of samples or
    the step).
    """

    name: str
    channel: str
    domain: tuple[str, ...]
    scaled: dict[str, float] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    parameters: dict[str, tuple[str, float, str]] = field(default_factory=dict)
    stage: str | None = None
    harmonic: int | None = None
    order: float | None = None
    frequency_hz: float | None = None
    how: str = "measured"
    one_session: bool = False
    size: float = 1.0

    def values(self) -> dict[str, float]:
        """All values at the present size."""
        return {**self.fixed, **{key: value * self.size for key, value in self.scaled.items()}}
