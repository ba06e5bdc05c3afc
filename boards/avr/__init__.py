"""An ATmega328P under simavr, with an MCP2515 on its SPI: a node whose binary nobody recompiled."""

from boards.avr.board import AvrBoard as AvrBoard
