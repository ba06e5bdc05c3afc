"""How many inputs of an attack are done, for whoever shows what is left."""

from collections.abc import Callable, Iterator


class Left:
    """`heard` takes the number of inputs that the attack at hand has done."""

    heard: Callable[[int], None] | None = None


def counted(count: int) -> Iterator[int]:
    """0 to `count` - 1, each reported as it begins."""
    for number in range(count):
        if Left.heard is not None:
            Left.heard(number)
        yield number
