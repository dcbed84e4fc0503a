#include "dds/topics/serialized_fields.hpp"

namespace sonopose::dds::topics {

std::uint32_t status_of_pose(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  std::uint32_t status = 0;
  walk(cursor, "", sonopose_FusedPose{}, [&](const char* name, auto /*value*/, std::uint64_t raw) {
    if (std::string_view(name) == "status") status = static_cast<std::uint32_t>(raw);
  });
  return status;
}

std::optional<BeaconAddress> beacon_of(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  const auto address = cursor.read<std::uint16_t>();
  return cursor.is_good() ? std::optional<BeaconAddress>(address) : std::nullopt;
}

std::optional<std::uint64_t> event_sequence_of(std::span<const std::byte> sample) {
  CdrCursor cursor(sample);
  cursor.read<std::uint16_t>();  // skips the beacon
  const auto number = cursor.read<std::uint64_t>();
  return cursor.is_good() ? std::optional(number) : std::nullopt;
}

}  // namespace sonopose::dds::topics
