#pragma once
/// \file
/// The news about messages that the line to an autopilot did not take.

#include "transport/byte_source.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

namespace sonopose::mavlink::sender {

/// Tells from the counts of a line that it begins to drop messages, for another reason than before, or takes
/// all of them again.
class UnsentReport {
public:
  struct News {
    bool is_warning = false;
    std::string text;
  };
  /// Returns what has changed, if anything. `full` is ByteLink::unsent(). Call it about once a second.
  std::optional<News> update(std::uint64_t full, const transport::SendFailures& failures);

private:
  enum class State : std::uint8_t { sends, is_full, fails };

  std::uint64_t full_ = 0;
  std::uint64_t failed_ = 0;
  State state_ = State::sends;  ///< between the last two calls
  std::errc reason_{};          ///< set while `state_` is `fails`
};

}  // namespace sonopose::mavlink::sender
