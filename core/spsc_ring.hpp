// Fixed-size queue from one thread to one other, without locks: between the loop and whatever may be late
// (the recorder's writer, a rig on its own thread). Neither side ever waits or allocates.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "core/types.hpp"

namespace patella {

/// One producer calls push, one consumer calls pop; a full ring refuses, and the producer counts what it
/// lost.
template <typename T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied between threads byte by byte");

 public:
  /// `capacity` elements, a power of two. Throws std::invalid_argument otherwise.
  explicit SpscRing(std::size_t capacity)
      : mask_(checked(capacity) - 1), elements_(std::make_unique<T[]>(capacity)) {}

  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  /// False, and nothing stored, when the ring is full.
  bool push(const T& element) noexcept PATELLA_NONBLOCKING {
    return pushBy([&element](T& place) noexcept { place = element; });
  }

  /// The same with `write(T&)`, noexcept, which writes the element where it is to stand.
  template <typename Write>
  bool pushBy(Write&& write) noexcept PATELLA_NONBLOCKING {
    const std::size_t head = head_.value.load(std::memory_order_relaxed);
    if (head - head_.other > mask_) {
      head_.other = tail_.value.load(std::memory_order_acquire);
      if (head - head_.other > mask_) {
        return false;
      }
    }
    write(elements_[head & mask_]);
    head_.value.store(head + 1, std::memory_order_release);
    return true;
  }

  /// False, and `element` untouched, when the ring is empty.
  bool pop(T& element) noexcept PATELLA_NONBLOCKING {
    const std::size_t tail = tail_.value.load(std::memory_order_relaxed);
    if (tail == tail_.other) {
      tail_.other = head_.value.load(std::memory_order_acquire);
      if (tail == tail_.other) {
        return false;
      }
    }
    element = elements_[tail & mask_];
    tail_.value.store(tail + 1, std::memory_order_release);
    return true;
  }

  std::size_t capacity() const noexcept { return mask_ + 1; }

  /// Elements inside; exact for a caller that is the only one to act, otherwise a recent value.
  std::size_t size() const noexcept {
    const std::size_t tail = tail_.value.load(std::memory_order_acquire);
    return head_.value.load(std::memory_order_acquire) - tail;
  }

 private:
  /// 128 bytes: adjacent-line prefetch of x86 and the line of some aarch64 cores both fit.
  static constexpr std::size_t kLine = 128;

  /// One side's own index beside its last view of the other's, so that the other's line is only fetched when
  /// the ring looks full (or empty).
  struct alignas(kLine) Side {
    std::atomic<std::size_t> value{0};
    std::size_t other = 0;
  };

  static std::size_t checked(std::size_t capacity) {
    if (!std::has_single_bit(capacity)) {
      throw std::invalid_argument("ring capacity is " + std::to_string(capacity) +
                                  ", expected a power of two");
    }
    return capacity;
  }

  std::size_t mask_;
  std::unique_ptr<T[]> elements_;
  Side head_;
  Side tail_;
};

}  // namespace patella
