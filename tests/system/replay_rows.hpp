#pragma once
/// \file
/// Rows of pose.csv as bits, to compare with poses.

#include "support/bits.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <charconv>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace sonopose::test {

/// Time, position, attitude, velocity and status of a pose.
inline Bits row_bits_of(const FusedPose& pose) {
  Bits bits{static_cast<std::uint64_t>(pose.time_ns)};
  detail::append(bits, pose.position_world_m);
  const Quaterniond& q = pose.q_body_to_world;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) detail::append(bits, value);
  detail::append(bits, pose.velocity_world_mps);
  bits.push_back(pose.status);
  return bits;
}

/// The same for every row of a pose.csv.
inline std::vector<Bits> pose_rows(const std::filesystem::path& file) {
  std::istringstream lines(read_text(file));
  std::vector<Bits> rows;
  std::string line;
  REQUIRE(std::getline(lines, line));  // the header
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    Bits& bits = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) {
      const bool whole = bits.empty() || bits.size() == 11;  // time and status
      std::int64_t integer = 0;
      double number = 0.0;
      const char* const end = cell.data() + cell.size();
      REQUIRE((whole ? std::from_chars(cell.data(), end, integer).ptr
                     : std::from_chars(cell.data(), end, number).ptr) == end);
      if (whole) {
        bits.push_back(static_cast<std::uint64_t>(integer));
      } else {
        detail::append(bits, number);
      }
    }
  }
  return rows;
}

}  // namespace sonopose::test
