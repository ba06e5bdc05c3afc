// A motor velocity board on other people's driver: TACH every 10 ms, heartbeat every second, PING answered.
#include <avr/interrupt.h>
#include <avr/sleep.h>
#include "esphome/components/mcp2515/mcp2515.h"

using namespace esphome;

enum : uint8_t { DEVICE = 0x31 };
static volatile uint32_t now_ms;
static mcp2515::MCP2515 chip;

ISR(TIMER1_COMPA_vect) { now_ms++; }
ISR(INT0_vect) {}
extern "C" void __cxa_pure_virtual() {}

uint32_t esphome::millis() {
  cli();
  uint32_t now = now_ms;
  sei();
  return now;
}
void esphome::delay(uint32_t milliseconds) {
  for (uint32_t end = millis() + milliseconds; millis() < end;) {
  }
}

static void say(uint32_t base, uint8_t a, uint8_t b, uint32_t count) {
  canbus::CanFrame frame;
  frame.can_id = base + DEVICE;
  frame.can_data_length_code = 8;
  const uint8_t data[8] = {DEVICE, a, b, (uint8_t) count, (uint8_t) (count >> 8)};
  memcpy(frame.data, data, 8);
  chip.send(&frame);
}

int main() {
  canbus::CanFrame heard;
  uint32_t ticks = 0;
  OCR1A = 1999;  // 1 ms of 16 MHz / 8
  TCCR1B = 1 << WGM12 | 1 << CS11;
  TIMSK1 = 1 << OCIE1A;
  EICRA = 1 << ISC01;  // INT0 falls
  EIMSK = 1;
  sei();
  chip.set_bitrate(canbus::CAN_1000KBPS);
  chip.set_mcp_clock(mcp2515::MCP_16MHZ);
  chip.begin();
  for (uint32_t next = millis();;) {
    while (chip.read(&heard) == canbus::ERROR_OK)
      if (heard.can_id == 0x080 + DEVICE)
        say(0x100, heard.data[1], heard.data[1] != 1, 0);
    if (millis() >= next) {
      next += 10;
      say(0x200, 0, (uint8_t) ticks, ticks);
      if (ticks++ % 100 == 0)
        say(0x700, 0xF7, 1, ticks / 100);
    }
    set_sleep_mode(SLEEP_MODE_IDLE);
    sleep_mode();
  }
}
