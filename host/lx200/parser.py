"""From bytes to commands, however they were cut: split, joined, doubled, with rubbish between them."""

ACK = "\x06"
"""Asks for the alignment mode; a command of one byte."""
_LONGEST = 40
"""Longest command kept, in characters: `:SM` with a site's name is the longest there is."""


class Parser:
    """Fed byte by byte or whole, the commands are the same.

    A command is what stands between `:` and `#`, as Latin-1 text (the degree sign is 0xDF). What stands
    outside is dropped. A colon and a letter begin a command anew, since within one a colon is followed by a
    digit. A command that was torn off costs itself only.
    """

    def __init__(self) -> None:
        self._text: str | None = None
        self._colon = False

    def feed(self, data: bytes) -> list[str]:
        """Commands that became complete, without `:` and `#`; `ACK` for the byte 0x06."""
        commands: list[str] = []
        for character in data.decode("latin-1"):
            self._take(character, commands)
        return commands

    def _take(self, character: str, commands: list[str]) -> None:
        if character == ACK:
            self._text = None
            commands.append(ACK)
        elif character == ":" and self._text is None:
            self._text, self._colon = "", False
        elif self._text is None:
            return
        elif character == "#":
            if self._text:
                commands.append(self._text)
            self._text = None
        elif len(self._text) >= _LONGEST:
            self._text = None
        elif self._colon and character.isascii() and character.isalpha():
            self._text, self._colon = character, False
        else:
            self._colon = character == ":"
            self._text += character
