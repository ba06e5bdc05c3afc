// A bus whose bytes and chip select go to whoever holds the two functions.
#pragma once

#include <cstdint>

namespace esphome::spi {

enum BitOrder { BIT_ORDER_MSB_FIRST };
enum ClockPolarity { CLOCK_POLARITY_LOW };
enum ClockPhase { CLOCK_PHASE_LEADING };
enum DataRate { DATA_RATE_8MHZ };

extern uint8_t (*exchange)(uint8_t);
extern void (*select)(bool);

template<BitOrder, ClockPolarity, ClockPhase, DataRate> class SPIDevice {
 public:
  void spi_setup() {}
  void enable() { select(true); }
  void disable() { select(false); }
  uint8_t transfer_byte(uint8_t byte) { return exchange(byte); }
};

}  // namespace esphome::spi
