#pragma once
/// \file
/// Files of earlier recordings on the same disk.

#include <cstdint>
#include <deque>
#include <filesystem>

namespace sonopose::recorder {

/// A file of a recording.
struct RecordedFile {
  std::filesystem::path file;
  std::uint64_t bytes = 0;
};

/// Returns the files of earlier recordings, the oldest first: names like STEM_001.EXT of `file`, complete or
/// interrupted (.part, unless another recorder has written it within a minute), in its folder. Throws
/// files::IoError if the folder cannot be read. With `of_any_time`, the digits in STEM may differ: STEM has a
/// date.
std::deque<RecordedFile> find_earlier_files(const std::filesystem::path& file, bool of_any_time);

}  // namespace sonopose::recorder
