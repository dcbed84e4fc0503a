#pragma once
/// \file
/// Common functions of fuzz_make_corpus.

#include "support.hpp"
#include <sonopose/dds/psm/cdr.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
#include <span>
#include <string>
#include <vector>

namespace sonopose::fuzz {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

inline void write(const fs::path& file, std::span<const std::uint8_t> bytes) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

inline void append(Bytes& bytes, std::span<const std::uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Writes byte 0 of the input for fuzzers of serialized samples, then a sample.
template <class T>
void write_sample(const fs::path& folder, int index, const T& sample, const std::string& name) {
  const std::vector<std::byte> cdr = dds::write_cdr(sample);
  Bytes bytes{static_cast<std::uint8_t>(index)};
  append(bytes, {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()});
  write(folder / name, bytes);
}
template <class T>
void write_sample(const fs::path& folder, int index, const T& sample) {
  write_sample(folder, index, sample, std::to_string(index));
}

/// Writes MCAP files, including recordings of the bus.
void write_mcap_corpus(const fs::path& folder);

/// Writes messages of each type that a ROS 2 node sends to the relay.
void write_ros2_corpus(const fs::path& folder);

}  // namespace sonopose::fuzz
