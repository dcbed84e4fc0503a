#include "bridge/address_owners.hpp"

#include "logging/later.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

#include <utility>

namespace sonopose::bridge {

bool AddressOwners::accepts(std::uint8_t address, const transport::Sender& sender, SteadyTime now) {
  Owner& owner = owners_[address];
  if (!owner.exists || (owner.sender != sender && now - owner.heard >= release_ns)) {
    owner = {true, false, sender, now};
  }
  if (owner.sender == sender) {
    owner.heard = now;
    return true;
  }
  if (!std::exchange(owner.reported, true)) {
    logging::later([address, sender, first = owner.sender] {
      logging::warning(fmt::format(
          "packets of beacon {} from {} are ignored, because {} sends it; --from selects the sender", address,
          transport::text_of(sender), transport::text_of(first)));
    });
  }
  return false;
}

}  // namespace sonopose::bridge
