#include "bridge/line_beacons.hpp"

namespace sonopose::bridge {

bool LineBeacons::accepts(std::uint8_t address, SteadyTime now) {
  if (!admission_.accepts(address)) return false;
  presences_[address].on_sample(now);
  return true;
}

std::vector<std::uint8_t> LineBeacons::remove_gone(SteadyTime now) {
  std::vector<std::uint8_t> gone;
  std::erase_if(presences_, [&](const auto& entry) {
    const auto& [address, presence] = entry;
    if (!presence.is_gone(now)) return false;
    admission_.forget(address);
    gone.push_back(address);
    return true;
  });
  return gone;
}

}  // namespace sonopose::bridge
