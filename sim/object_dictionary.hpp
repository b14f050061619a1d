// Object dictionary of a simulated CANopen node, and its SDO server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "drivers/can/can_frame.hpp"

namespace patella::sim {

/// An entry that holds a number.
struct DictionaryObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bytes = 4;
  bool writable = false;
  bool mappable = false;
  std::uint32_t value = 0;
  std::uint32_t initial = 0;
};

/// Codes by which a server ends a transfer.
enum class AbortCode : std::uint32_t {
  kNone = 0,
  kUnknownCommand = 0x05040001,
  kReadOnly = 0x06010002,
  kNoObject = 0x06020000,
  kNotMappable = 0x06040041,
  kPdoTooLong = 0x06040042,
  kWrongLength = 0x06070010,
  kNoSubIndex = 0x06090011,
  kDeviceState = 0x08000022
};

class ObjectDictionary {
 public:
  explicit ObjectDictionary(std::vector<DictionaryObject> objects);

  DictionaryObject* find(unsigned index, unsigned sub) noexcept;
  const DictionaryObject* find(unsigned index, unsigned sub) const noexcept;
  bool has(unsigned index) const noexcept;
  /// 0 for what is not there.
  std::uint32_t value(unsigned index, unsigned sub = 0) const noexcept;
  void set(unsigned index, unsigned sub, std::uint32_t value) noexcept;
  /// As after a start.
  void reset() noexcept;

 private:
  std::vector<DictionaryObject> objects_;
};

/// Answers expedited requests, and reads of the device's name (1008h) in segments.
class SdoServer {
 public:
  SdoServer(int node, std::string_view name) noexcept : node_(node), name_(name) {}

  /// `allow(object, value)` has the last word on a write: AbortCode::kNone, or why not. `written(object)`
  /// hears of one that was done.
  template <typename Allow, typename Written>
  can::Frame answer(const can::Frame& request, ObjectDictionary& dictionary, Allow&& allow,
                    Written&& written) noexcept {
    constexpr unsigned kCommand = 0xE0;
    constexpr unsigned kDownload = 0x20;
    if ((request.data[0] & kCommand) != kDownload) {
      return upload(request, dictionary);
    }
    DictionaryObject* object = nullptr;
    std::uint32_t value = 0;
    AbortCode code = check(request, dictionary, object, value);
    code = code == AbortCode::kNone ? allow(*object, value) : code;
    if (code != AbortCode::kNone) {
      return abort(request, code);
    }
    object->value = value;
    written(*object);
    can::Frame done = blank(request);
    done.data[0] = 0x60;
    return done;
  }

 private:
  can::Frame blank(const can::Frame& request) const noexcept;
  can::Frame abort(const can::Frame& request, AbortCode code) const noexcept;
  can::Frame upload(const can::Frame& request, const ObjectDictionary& dictionary) noexcept;
  can::Frame segment(const can::Frame& request) noexcept;
  static AbortCode check(const can::Frame& request, ObjectDictionary& dictionary, DictionaryObject*& object,
                         std::uint32_t& value) noexcept;

  int node_;
  std::string_view name_;
  std::size_t sent_ = 0;  ///< of the name
};

}  // namespace patella::sim
