#pragma once
/// \file
/// Owns a file descriptor.

#include <unistd.h>
#include <utility>

namespace sonopose::files {

/// A descriptor that is closed with its owner.
class Descriptor {
public:
  explicit Descriptor(int number = -1) : number_{number} {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_{other.release()} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const noexcept { return number_; }
  /// Passes the duty to close it on.
  int release() noexcept { return std::exchange(number_, -1); }

private:
  int number_;
};

}  // namespace sonopose::files
