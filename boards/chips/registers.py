"""A peripheral's registers by name, with their fields."""

from collections.abc import Mapping


class Registers:
    """fields: field -> (register, shift, bits). widths: bits of each register. values: after a reset."""

    def __init__(
        self,
        fields: Mapping[str, tuple[str, int, int]],
        widths: Mapping[str, int],
        values: Mapping[str, int],
    ) -> None:
        self._fields, self._widths, self._values = fields, widths, dict(values)

    def __getitem__(self, register: str) -> int:
        return self._values[register]

    def __setitem__(self, register: str, value: int) -> None:
        """Write a register; bits it does not have read as 0. Raises KeyError for one there is not."""
        self._values[register] = value & (1 << self._widths[register]) - 1

    def field(self, name: str) -> int:
        """Value of a field."""
        register, shift, bits = self._fields[name]
        return self._values[register] >> shift & (1 << bits) - 1

    def put(self, name: str, value: int) -> None:
        """Change a field; raises ValueError when it does not fit."""
        register, shift, bits = self._fields[name]
        mask = (1 << bits) - 1
        if not 0 <= value <= mask:
            raise ValueError(f"{name} has {bits} bits, {value} does not fit")
        self[register] = self._values[register] & ~(mask << shift) | value << shift
