#pragma once
/// \file
/// Opens and reads files that a user has given.

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

namespace sonopose::files {

/// A descriptor that is closed with its owner.
class Descriptor {
public:
  explicit Descriptor(int number) : number_{number} {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : number_{other.release()} {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  [[nodiscard]] int number() const { return number_; }
  /// Passes the duty to close it on.
  int release() { return std::exchange(number_, -1); }

private:
  int number_;
};

/// Opens a file for reading. Never waits. Throws IoError for a folder, a named pipe, a socket or a device,
/// which is not even opened; a pipe of the shell (`<(command)`) and /dev/null can be read like a file.
Descriptor open_input(const std::filesystem::path& file);

/// Limit of a file that is read as a whole, in bytes.
inline constexpr std::uintmax_t max_text_bytes = 64U << 20U;

/// Reads a whole file. Throws IoError if it cannot be opened or read, or is larger than the limit.
std::string read_text(const std::filesystem::path& file);

}  // namespace sonopose::files
