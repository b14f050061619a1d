#include "sim/object_dictionary.hpp"

#include <algorithm>
#include <utility>

namespace patella::sim {
namespace {

constexpr unsigned kDeviceName = 0x1008;

unsigned indexOf(const can::Frame& frame) noexcept {
  return frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8U;
}

void putNumber(can::Frame& frame, std::uint32_t number) noexcept {
  for (std::size_t i = 0; i < 4; ++i) {
    frame.data[4 + i] = static_cast<std::uint8_t>(number >> (8U * i));
  }
}

}  // namespace

ObjectDictionary::ObjectDictionary(std::vector<DictionaryObject> objects) : objects_(std::move(objects)) {
  for (DictionaryObject& object : objects_) {
    object.initial = object.value;
  }
}

DictionaryObject* ObjectDictionary::find(unsigned index, unsigned sub) noexcept {
  const auto found =
      std::find_if(objects_.begin(), objects_.end(), [index, sub](const DictionaryObject& candidate) {
        return candidate.index == index && candidate.sub == sub;
      });
  return found == objects_.end() ? nullptr : &*found;
}

const DictionaryObject* ObjectDictionary::find(unsigned index, unsigned sub) const noexcept {
  const auto found =
      std::find_if(objects_.begin(), objects_.end(), [index, sub](const DictionaryObject& candidate) {
        return candidate.index == index && candidate.sub == sub;
      });
  return found == objects_.end() ? nullptr : &*found;
}

bool ObjectDictionary::has(unsigned index) const noexcept {
  return std::any_of(objects_.begin(), objects_.end(),
                     [index](const DictionaryObject& object) { return object.index == index; });
}

std::uint32_t ObjectDictionary::value(unsigned index, unsigned sub) const noexcept {
  const DictionaryObject* object = find(index, sub);
  return object == nullptr ? 0 : object->value;
}

void ObjectDictionary::set(unsigned index, unsigned sub, std::uint32_t value) noexcept {
  if (DictionaryObject* object = find(index, sub); object != nullptr) {
    object->value = value;
  }
}

void ObjectDictionary::reset() noexcept {
  for (DictionaryObject& object : objects_) {
    object.value = object.initial;
  }
}

can::Frame SdoServer::blank(const can::Frame& request) const noexcept {
  constexpr std::uint32_t kAnswers = 0x580;
  can::Frame frame;
  frame.id = kAnswers + static_cast<std::uint32_t>(node_);
  frame.length = 8;
  std::copy(request.data.begin() + 1, request.data.begin() + 4, frame.data.begin() + 1);
  return frame;
}

can::Frame SdoServer::abort(const can::Frame& request, AbortCode code) const noexcept {
  can::Frame frame = blank(request);
  frame.data[0] = 0x80;
  putNumber(frame, static_cast<std::uint32_t>(code));
  return frame;
}

AbortCode SdoServer::check(const can::Frame& request, ObjectDictionary& dictionary, DictionaryObject*& object,
                           std::uint32_t& value) noexcept {
  constexpr unsigned kExpedited = 0x02;
  constexpr unsigned kSizeStated = 0x01;
  const unsigned index = indexOf(request);
  object = dictionary.find(index, request.data[3]);
  if (object == nullptr) {
    return dictionary.has(index) ? AbortCode::kNoSubIndex : AbortCode::kNoObject;
  }
  if (!object->writable) {
    return AbortCode::kReadOnly;
  }
  const unsigned command = request.data[0];
  if ((command & kExpedited) == 0) {
    return AbortCode::kUnknownCommand;  // numbers come in one frame
  }
  const unsigned bytes = (command & kSizeStated) != 0 ? 4U - (command >> 2U & 3U) : object->bytes;
  if (bytes != object->bytes) {
    return AbortCode::kWrongLength;
  }
  value = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    value |= static_cast<std::uint32_t>(request.data[4 + i]) << (8U * i);
  }
  return AbortCode::kNone;
}

can::Frame SdoServer::upload(const can::Frame& request, const ObjectDictionary& dictionary) noexcept {
  constexpr unsigned kCommand = 0xE0;
  constexpr unsigned kUpload = 0x40;
  constexpr unsigned kSegment = 0x60;
  if ((request.data[0] & kCommand) == kSegment) {
    return segment(request);
  }
  if ((request.data[0] & kCommand) != kUpload) {
    return abort(request, AbortCode::kUnknownCommand);
  }
  const unsigned index = indexOf(request);
  can::Frame answer = blank(request);
  if (index == kDeviceName && request.data[3] == 0) {
    sent_ = 0;
    answer.data[0] = 0x41;
    putNumber(answer, static_cast<std::uint32_t>(name_.size()));
    return answer;
  }
  const DictionaryObject* object = dictionary.find(index, request.data[3]);
  if (object == nullptr) {
    return abort(request, dictionary.has(index) ? AbortCode::kNoSubIndex : AbortCode::kNoObject);
  }
  answer.data[0] = static_cast<std::uint8_t>(0x43U | (4U - object->bytes) << 2U);
  putNumber(answer, object->value);
  return answer;
}

can::Frame SdoServer::segment(const can::Frame& request) noexcept {
  constexpr unsigned kToggle = 0x10;
  constexpr std::size_t kMost = 7;
  can::Frame answer = blank(request);
  const std::size_t count = std::min(kMost, name_.size() - sent_);
  answer.data.fill(0);
  std::copy_n(name_.begin() + static_cast<std::ptrdiff_t>(sent_), count, answer.data.begin() + 1);
  sent_ += count;
  answer.data[0] =
      static_cast<std::uint8_t>((request.data[0] & kToggle) | static_cast<unsigned>(kMost - count) << 1U |
                                (sent_ == name_.size() ? 1U : 0U));
  return answer;
}

}  // namespace patella::sim
