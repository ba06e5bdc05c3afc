// What a component of that firmware leans on, written for this test: the driver itself is compiled unchanged.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace esphome {

uint32_t millis();
void delay(uint32_t milliseconds);

namespace setup_priority {
inline constexpr float HARDWARE = 800.0f;
}

class Component {
 public:
  virtual ~Component() = default;
  virtual void setup() {}
  virtual void loop() {}
  virtual void dump_config() {}
  virtual float get_setup_priority() const { return 0.0f; }
  void mark_failed() { failed_ = true; }
  bool is_failed() const { return failed_; }

 private:
  bool failed_ = false;
};

template<typename T> using optional = std::optional<T>;

template<typename Signature> class CallbackManager;
template<typename... Arguments> class CallbackManager<void(Arguments...)> {
 public:
  template<typename Callback> void add(Callback &&callback) { all_.emplace_back(std::forward<Callback>(callback)); }
  void operator()(Arguments... arguments) {
    for (auto &each : all_) each(arguments...);
  }

 private:
  std::vector<std::function<void(Arguments...)>> all_;
};

// Only named in the driver's headers; nothing in the test makes one.
template<typename T> class Parented {
 public:
  T *parent_ = nullptr;
};
template<typename... Arguments> class Action {
 public:
  virtual ~Action() = default;
  virtual void play(const Arguments &...) = 0;
};
template<typename... Arguments> class Trigger {
 public:
  void trigger(const Arguments &...) {}
};

}  // namespace esphome
