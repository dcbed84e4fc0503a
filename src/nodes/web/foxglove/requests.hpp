#pragma once
/// \file
/// Client requests of Foxglove's WebSocket protocol (protocol.hpp).

#include "web/foxglove/protocol.hpp"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sonopose::web::foxglove {

struct Subscribe {
  struct Item {
    SubscriptionId id = 0;
    ChannelId channel_id = 0;
  };
  std::vector<Item> items;
};
struct Unsubscribe {
  std::vector<SubscriptionId> ids;
};
/// A request that is malformed or not supported.
struct Refused {
  std::string reason;
};
using Request = std::variant<Subscribe, Unsubscribe, Refused>;

/// Parses a text message. Never throws for a client's input.
Request parse_request(std::string_view text);

}  // namespace sonopose::web::foxglove
