#include "bridge/line_beacons.hpp"

namespace sonopose::bridge {

bool LineBeacons::accepts(std::uint8_t address, SteadyTime now) {
  if (!admission_.accepts(address)) return false;
  Heard& heard = heard_[address];
  heard.latest = now;
  ++heard.packets;
  return true;
}

std::vector<std::uint8_t> LineBeacons::remove_gone(SteadyTime now) {
  std::vector<std::uint8_t> gone;
  std::erase_if(heard_, [&](const auto& entry) {
    const auto& [address, heard] = entry;
    if (!process::is_gone(now - heard.latest, heard.packets)) return false;
    admission_.forget(address);
    gone.push_back(address);
    return true;
  });
  return gone;
}

}  // namespace sonopose::bridge
