#pragma once
/// \file
/// Common parts of the fuzzers: promises, declared errors, and files for parsers that read files.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

namespace sonopose::fuzz {

/// Ends the fuzzer, which then saves its input, if a promise is broken.
inline void promise(bool kept, const char* what) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// Returns true if `parse` returns, false if it throws the declared error. Any other exception ends the
/// fuzzer.
template <class DeclaredError, class Parse>
bool accepts(const Parse& parse) {
  try {
    parse();
    return true;
  } catch (const DeclaredError& error) {
    promise(*error.what() != '\0', "an error has a message");
    return false;
  }
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// A folder of this process in the system's temporary folder.
class ScratchFolder {
public:
  explicit ScratchFolder(const std::string& ending = {})
      : path_(std::filesystem::temp_directory_path() /
              ("sonopose-fuzz-" + std::to_string(::getpid()) + ending)) {
    std::filesystem::create_directory(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  [[nodiscard]] std::filesystem::path write(std::string_view name, std::string_view text) const {
    std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
    return file;
  }

private:
  std::filesystem::path path_;
};

}  // namespace sonopose::fuzz
