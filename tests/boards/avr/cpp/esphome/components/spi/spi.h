// The processor's own SPI at 8 MHz, chip select on B2.
#pragma once
#include "esphome/core/component.h"

namespace esphome {
namespace spi {
enum BitOrder { BIT_ORDER_MSB_FIRST };
enum ClockPolarity { CLOCK_POLARITY_LOW };
enum ClockPhase { CLOCK_PHASE_LEADING };
enum DataRate { DATA_RATE_8MHZ };

template<BitOrder, ClockPolarity, ClockPhase, DataRate> class SPIDevice {
 public:
  void spi_setup() {
    DDRB = 1 << PB2 | 1 << PB3 | 1 << PB5;
    disable();
    SPCR = 1 << SPE | 1 << MSTR;
    SPSR = 1 << SPI2X;
  }
  void enable() { PORTB &= (uint8_t) ~(1 << PB2); }
  void disable() { PORTB |= 1 << PB2; }
  uint8_t transfer_byte(uint8_t byte) {
    SPDR = byte;
    while (!(SPSR & (1 << SPIF))) {
    }
    return SPDR;
  }
  uint8_t read_byte() { return transfer_byte(0); }
  void write_byte(uint8_t byte) { transfer_byte(byte); }
  void write_array(const uint8_t *data, size_t length) {
    while (length--)
      transfer_byte(*data++);
  }
};
}  // namespace spi
}  // namespace esphome
