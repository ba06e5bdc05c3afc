"""Integers that complain when a result does not fit 64 bits: firmware computed with them shows what
overflows."""

from typing import Any

WIDEST = 64


class Checked(int):
    """An int whose sums, products, shifts and quotients must fit a signed 64-bit register."""

    def __new__(cls, value: int) -> "Checked":
        half = 1 << (WIDEST - 1)
        if not -half <= value < half:
            raise OverflowError(
                f"{value} needs {value.bit_length() + 1} bits, the widest register has {WIDEST}"
            )
        return super().__new__(cls, value)


def _watched(name: str) -> Any:
    plain = getattr(int, name)

    def operation(self: int, *others: int) -> Any:
        found = plain(self, *others)
        return found if found is NotImplemented else Checked(found)

    return operation


for _name in ("add", "sub", "mul", "floordiv", "mod", "lshift", "rshift", "and", "or"):
    setattr(Checked, f"__{_name}__", _watched(f"__{_name}__"))
    setattr(Checked, f"__r{_name}__", _watched(f"__r{_name}__"))
for _name in ("neg", "abs"):
    setattr(Checked, f"__{_name}__", _watched(f"__{_name}__"))


def checked(thing: Any, *names: str) -> None:
    """Turn attributes of `thing` into checked integers."""
    for name in names:
        setattr(thing, name, Checked(getattr(thing, name)))
