// What the driver leans on, for an ATmega328P, written for this test: the driver itself is compiled unchanged.
#pragma once
#include <avr/io.h>
#include <stdint.h>
#include <string.h>

namespace esphome {
uint32_t millis();
void delay(uint32_t milliseconds);
}  // namespace esphome
