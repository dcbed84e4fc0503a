#include "presence/address_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace sonopose::presence {
namespace {

BeaconAddress address_in(std::string_view text, std::string_view part) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || value >= all_beacons) {
    throw std::invalid_argument(fmt::format(
        "'{}' is not a beacon address or a range of addresses: use numbers from 0 to {}, as in 7 or 7-131",
        part, all_beacons - 1));
  }
  return static_cast<BeaconAddress>(value);
}

std::pair<BeaconAddress, BeaconAddress> range_in(std::string_view part) {
  const std::size_t dash = part.find('-');
  const BeaconAddress first = address_in(part.substr(0, dash), part);
  if (dash == std::string_view::npos) return {first, first};
  const BeaconAddress last = address_in(part.substr(dash + 1), part);
  if (last < first) {
    throw std::invalid_argument(fmt::format(
        "the range '{}' ends before it begins: write the lower address first, as in 7-131", part));
  }
  return {first, last};
}

}  // namespace

AddressSet AddressSet::parse(std::string_view text) {
  AddressSet set;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    set.ranges_.push_back(range_in(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return set;
}

bool AddressSet::only_one() const {
  const auto is_first = [this](const auto& range) {
    return range.first == ranges_.front().first && range.second == ranges_.front().first;
  };
  return !ranges_.empty() && std::all_of(ranges_.begin(), ranges_.end(), is_first);
}

}  // namespace sonopose::presence
