#include <sonopose/ros2/messages/type_hash.hpp>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace sonopose::ros2 {
namespace {

struct Row {
  std::string_view dds_type_name;
  std::string_view sha256;
};

// The number of generated rows is not known here. NOLINTNEXTLINE(modernize-avoid-c-arrays)
constexpr Row rows[] = {
#include <sonopose/idl/ros2/type_hashes.inc>
};

}  // namespace

std::string type_hash(const std::string& dds_type_name) {
  const auto* const row = std::find_if(std::begin(rows), std::end(rows),
                                       [&](const Row& each) { return each.dds_type_name == dds_type_name; });
  if (row == std::end(rows)) throw std::invalid_argument("idl/ros2 has no type '" + dds_type_name + "'");
  return "RIHS01_" + std::string(row->sha256);
}

}  // namespace sonopose::ros2
