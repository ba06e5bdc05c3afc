"""Peripherals of the dsPIC30F3011 at register level (DS70141F, DS70135G, FRM sections 14 to 17)."""

from boards.chips.dspic30f.adc import Adc
from boards.chips.dspic30f.pwm import MotorControlPwm
from boards.chips.dspic30f.qei import QeiModule

__all__ = ["Adc", "MotorControlPwm", "QeiModule"]
