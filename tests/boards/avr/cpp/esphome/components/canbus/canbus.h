// What the driver is a kind of: frames, its enumerations, and the three calls a program makes.
#pragma once
#include "esphome/core/component.h"

namespace esphome {
namespace canbus {
enum Error : uint8_t { ERROR_OK, ERROR_FAIL, ERROR_ALLTXBUSY, ERROR_FAILINIT, ERROR_FAILTX, ERROR_NOMSG };
enum CanSpeed : uint8_t {
  CAN_5KBPS, CAN_10KBPS, CAN_20KBPS, CAN_31K25BPS, CAN_33KBPS, CAN_40KBPS, CAN_50KBPS, CAN_80KBPS,
  CAN_83K3BPS, CAN_95KBPS, CAN_100KBPS, CAN_125KBPS, CAN_200KBPS, CAN_250KBPS, CAN_500KBPS, CAN_1000KBPS
};
static const uint8_t CAN_MAX_DATA_LENGTH = 8;

struct CanFrame {
  bool use_extended_id = false;
  bool remote_transmission_request = false;
  uint32_t can_id;
  uint8_t can_data_length_code;
  uint8_t data[8];
};

class Canbus {
 public:
  void set_bitrate(CanSpeed bit_rate) { bit_rate_ = bit_rate; }
  bool begin() { return setup_internal(); }
  Error send(CanFrame *frame) { return send_message(frame); }
  Error read(CanFrame *frame) { return read_message(frame); }

 protected:
  CanSpeed bit_rate_;
  virtual bool setup_internal() = 0;
  virtual Error send_message(CanFrame *frame) = 0;
  virtual Error read_message(CanFrame *frame) = 0;
};
}  // namespace canbus
}  // namespace esphome
