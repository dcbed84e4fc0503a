#pragma once
// The recordings, which need not be here.

#include <filesystem>
#include <iostream>
#include <string>

namespace sonopose::test {

/// A folder of recordings, or one of them.
inline std::filesystem::path beacon_recordings(const std::string& name = {}) {
  return std::filesystem::path(SONOPOSE_RECORDINGS) / "beacons" / name;
}

/// Whether it is there; otherwise marks the test as skipped.
inline bool is_here(const std::filesystem::path& recording) {
  if (exists(recording)) return true;
  std::cout << "skipped: no recordings in " SONOPOSE_RECORDINGS
               "; cmake --preset dev -DSONOPOSE_RECORDINGS=FOLDER uses those of another folder\n";
  return false;
}

}  // namespace sonopose::test
