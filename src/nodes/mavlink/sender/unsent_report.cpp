#include "mavlink/sender/unsent_report.hpp"

#include <utility>

namespace sonopose::mavlink::sender {

std::optional<UnsentReport::News> UnsentReport::update(std::uint64_t full,
                                                       const transport::SendFailures& failures) {
  const bool is_full = std::exchange(full_, full) != full;
  const bool fails = std::exchange(failed_, failures.count) != failures.count;
  const State state = fails ? State::fails : is_full ? State::is_full : State::sends;
  const std::errc reason = fails ? failures.reason : std::errc{};
  if (state == state_ && reason == reason_) return std::nullopt;
  state_ = state;
  reason_ = reason;
  if (fails) return News{true, "sending fails: " + std::make_error_code(reason).message()};
  if (is_full) return News{true, "the line is full, messages are dropped: lower --rate or use a faster line"};
  return News{false, "sending works again"};
}

}  // namespace sonopose::mavlink::sender
