#pragma once
// The recordings, which may be missing.

#include <filesystem>
#include <iostream>
#include <string>

namespace sonopose::test {

/// The folder of the beacon recordings, or of one of them.
inline std::filesystem::path beacon_recordings(const std::string& name = {}) {
  return std::filesystem::path(SONOPOSE_RECORDINGS) / "beacons" / name;
}

/// Returns true if the recording exists; otherwise marks the test as skipped.
inline bool is_here(const std::filesystem::path& recording) {
  if (exists(recording)) return true;
  std::cout << "skipped: no recordings in " SONOPOSE_RECORDINGS
               "; cmake --preset dev -DSONOPOSE_RECORDINGS=FOLDER uses those of another folder\n";
  return false;
}

}  // namespace sonopose::test
