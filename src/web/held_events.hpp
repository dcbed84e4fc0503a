#pragma once
/// \file
/// The changes of state that the page sees in the poses, until it is known whether a fusion logs them.

#include "transitions/line.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::web {

/// Events wait for two calls of `take_due`: the line of a fusion may arrive later than its pose, or earlier.
class HeldEvents {
public:
  static constexpr std::size_t most = 200;          ///< events at a time; of more, the latest
  static constexpr std::size_t most_logged = 1000;  ///< changes between two calls; more are not recognised

  /// `line_text`: what a log would have; `event`: what the page gets.
  void hold(std::string_view line_text, std::string event) {
    if (new_.size() == most) {
      new_.erase(new_.begin());
      ++dropped_;
    }
    new_.push_back({std::string(transitions::change_of(line_text)), std::move(event)});
  }

  /// A fusion has logged this line.
  void on_logged(std::string_view line_text) {
    if (logged_.front().size() < most_logged) logged_.front().emplace(transitions::change_of(line_text));
  }

  /// The events that were held at the call before, without those of changes that a fusion has logged. Once a
  /// second.
  std::vector<std::string> take_due() {
    std::vector<std::string> events;
    for (Held& held : due_) {
      const bool is_logged = std::any_of(logged_.begin(), logged_.end(),
                                         [&](const auto& each) { return each.contains(held.change); });
      if (!is_logged) events.push_back(std::move(held.event));
    }
    due_ = std::exchange(new_, {});
    std::rotate(logged_.begin(), logged_.end() - 1, logged_.end());
    logged_.front().clear();
    return events;
  }

  /// How many found no space since the last call.
  std::uint64_t take_dropped() { return std::exchange(dropped_, 0); }

private:
  struct Held {
    std::string change;
    std::string event;
  };

  std::vector<Held> new_;
  std::vector<Held> due_;
  std::uint64_t dropped_ = 0;
  /// The changes of the time since the last call first, then those before the last and the one before it.
  std::array<std::set<std::string, std::less<>>, 3> logged_;
};

}  // namespace sonopose::web
