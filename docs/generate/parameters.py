"""docs/reference/parameters.md: parameters of every board, from the boards of the network `final`."""

from docs.generate.text import MADE, table
from scenarios.lab.wiring import network

_HEAD = """# Parameters of the boards

{made}
GET_PARAMETER and SET_PARAMETER of [the protocol](protocol.md) read and write them by number. A scenario sets
them with the step `set_parameter`, or from the start under `network: nodes: NAME: parameters`. Values are
whole numbers, in the unit that the name ends in: `q8`, `q12` and `q16` are binary fractions with as many
bits. The value is the one a board is made with.

Parameters 12 to 68 of an axis board are off in it; that is the paper's firmware.

The paper does not say what a loss of supply does to parameters. ASSUMPTION: boards of the networks `lab` and
`serial` keep what was written last, as in the EEPROM that their microcontrollers have. The boards that only
`final` has, and boards of your own, return to the value in the table.
"""


def page() -> str:
    """The whole page, Markdown. Boards with one table are shown together."""
    alike: dict[str, list[str]] = {}
    for name, board in network(network_name="final").boards.items():
        rows = [
            [str(row.number), f"`{row.name}`", f"{row.low} to {row.high}", str(row.read())]
            for row in board.parameters.rows()
        ]
        if rows:
            alike.setdefault(table(["number", "name", "range", "value"], rows), []).append(name)
    made = MADE.format(source="the boards")
    return _HEAD.format(made=made) + "".join(
        f"\n## {', '.join(names)}\n{text}" for text, names in alike.items()
    )
