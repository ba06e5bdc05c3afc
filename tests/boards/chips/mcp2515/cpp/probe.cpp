// A door of five C functions into the driver, for ctypes. One driver at a time.
#include "esphome/components/mcp2515/mcp2515.h"

#include <memory>

using Heard = void (*)(uint32_t, bool, bool, const uint8_t *, size_t);

namespace esphome {
namespace {
uint32_t (*now_ms)();
void (*wait_ms)(uint32_t);
std::unique_ptr<mcp2515::MCP2515> driver;
}  // namespace
uint32_t millis() { return now_ms(); }
void delay(uint32_t milliseconds) { wait_ms(milliseconds); }
namespace spi {
uint8_t (*exchange)(uint8_t);
void (*select)(bool);
}  // namespace spi
}  // namespace esphome

using namespace esphome;

extern "C" {

void wire(uint8_t (*exchange)(uint8_t), void (*select)(bool), uint32_t (*now)(), void (*wait)(uint32_t)) {
  spi::exchange = exchange;
  spi::select = select;
  now_ms = now;
  wait_ms = wait;
}

bool start(uint8_t speed, uint8_t clock, uint8_t mode, Heard heard) {
  driver = std::make_unique<mcp2515::MCP2515>();
  driver->set_bitrate(static_cast<canbus::CanSpeed>(speed));
  driver->set_mcp_clock(static_cast<mcp2515::CanClock>(clock));
  driver->set_mcp_mode(static_cast<mcp2515::CanctrlReqopMode>(mode));
  driver->add_callback([heard](uint32_t id, bool extended, bool remote, const std::vector<uint8_t> &data) {
    heard(id, extended, remote, data.data(), data.size());
  });
  driver->setup();
  return !driver->is_failed();
}

uint8_t send(uint32_t id, bool extended, bool remote, const uint8_t *data, size_t length) {
  return driver->send_data(id, extended, remote, std::vector<uint8_t>(data, data + length));
}

void loop() { driver->loop(); }
}
