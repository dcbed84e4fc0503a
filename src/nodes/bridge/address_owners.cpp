#include "bridge/address_owners.hpp"

#include "logging/later.hpp"
#include "logging/log.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace sonopose::bridge {

bool AddressOwners::accepts(std::optional<std::uint8_t> address, const transport::Sender& sender,
                            SteadyTime now) {
  Owner& owner = address ? owners_[*address] : map_owner_;
  if (!owner.exists || (owner.sender != sender && now - owner.heard >= release_ns)) {
    owner = {true, false, sender, now};
  }
  if (owner.sender == sender) {
    owner.heard = now;
    if (map_owner_.sender == sender) map_owner_.heard = now;
    return true;
  }
  if (!std::exchange(owner.reported, true)) {
    logging::later([address, sender, first = owner.sender] {
      const std::string what =
          address ? fmt::format("packets of beacon {}", *address) : "maps of the stationary beacons";
      logging::warning(fmt::format("{} from {} are ignored, because {} sends {}; --from selects the sender",
                                   what, transport::text_of(sender), transport::text_of(first),
                                   address ? "it" : "them"));
    });
  }
  return false;
}

}  // namespace sonopose::bridge
