"""The encoder's memory: areas, the selected one, what may be written."""

from boards.chips.endat.registers import (
    ALARM_WORD,
    RECOVERY_WORD,
    WARNING_WORD,
    WRITABLE_AREAS,
    Area,
    words,
)

_STATUS = int(Area.STATUS)
_OPERATING_START = int(Area.MANUFACTURER_0)


class Memory:
    """area: selected by the last MRS (after a reset the first, ASSUMPTION)."""

    def __init__(self, position_bits: int) -> None:
        self._words = words(position_bits)
        self.area = _OPERATING_START

    def power_up(self, alarms: int) -> None:
        """Status as after switching on; parameters stay."""
        self.area = _OPERATING_START
        self._words[_STATUS, ALARM_WORD] = alarms
        self._words[_STATUS, WARNING_WORD] = 0
        self._words[_STATUS, RECOVERY_WORD] = 0

    @property
    def alarms(self) -> int:
        """Alarm word."""
        return self._words.get((_STATUS, ALARM_WORD), 0)

    @property
    def warnings(self) -> int:
        """Warning word."""
        return self._words.get((_STATUS, WARNING_WORD), 0)

    @property
    def short_recovery(self) -> bool:
        """Whether the short t_m is selected."""
        return self._words.get((_STATUS, RECOVERY_WORD), 0) & 3 == 1

    def raise_alarm(self, bits: int) -> None:
        """The encoder finds something wrong."""
        self._words[_STATUS, ALARM_WORD] = self.alarms | bits

    def raise_warning(self, bits: int) -> None:
        """The encoder finds something about to go wrong."""
        self._words[_STATUS, WARNING_WORD] = self.warnings | bits

    def clear_errors(self) -> None:
        """Alarms and warnings off."""
        self._words[_STATUS, ALARM_WORD] = self._words[_STATUS, WARNING_WORD] = 0

    def read(self, address: int) -> int:
        """Word of the selected area; 0 where there is none."""
        return self._words.get((self.area, address), 0)

    def write(self, address: int, value: int) -> None:
        """Write where writing is allowed; alarms and warnings can only be cleared, whole."""
        if self.area in WRITABLE_AREAS or (self.area == _STATUS and address == RECOVERY_WORD):
            self._words[self.area, address] = value
        elif self.area == _STATUS and address in (ALARM_WORD, WARNING_WORD) and not value:
            self._words[_STATUS, address] = 0
