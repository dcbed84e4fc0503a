#include "player/gaps.hpp"

#include "logging/log.hpp"
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sonopose::player {
namespace {

constexpr double ns_per_s = 1e9;

}  // namespace

Gaps::Gaps(std::optional<double> max_gap_s, double rate, std::uint64_t begin_ns)
    : max_gap_s_(max_gap_s), rate_(rate), begin_ns_(begin_ns) {
  if (max_gap_s && (!std::isfinite(*max_gap_s) || *max_gap_s < 0.0)) {
    throw std::invalid_argument(fmt::format("max_gap_s = {}: must be 0 or greater", *max_gap_s));
  }
}

std::uint64_t Gaps::advance_to(std::uint64_t log_time_ns) {
  const std::uint64_t gap_ns = log_time_ns - std::min(log_time_ns, last_ns_);
  const double gap_s = static_cast<double>(gap_ns) / ns_per_s;
  const bool is_shortened = max_gap_s_ && gap_s > *max_gap_s_;
  log(gap_s, is_shortened);
  last_ns_ = std::max(last_ns_, log_time_ns);
  if (!is_shortened) return 0;
  const std::uint64_t left_out_ns = gap_ns - static_cast<std::uint64_t>(*max_gap_s_ * ns_per_s);
  ++shortened_;
  left_out_s_ += static_cast<double>(left_out_ns) / ns_per_s;
  return left_out_ns;
}

void Gaps::log(double gap_s, bool is_shortened) {
  constexpr double min_logged_wait_s = 5;
  constexpr int max_logged = 20;
  const bool is_waited_for = rate_ > 0.0 && gap_s / rate_ >= min_logged_wait_s;
  if (!is_waited_for || logged_ > max_logged) return;
  if (++logged_ > max_logged) {
    logging::warning("further gaps are not named");
    return;
  }
  const double after_s = static_cast<double>(last_ns_ - begin_ns_) / ns_per_s;
  logging::warning(fmt::format(
      "no messages for {} after {:.3f} s{}", text::duration_text(gap_s), after_s,
      is_shortened ? fmt::format(", shortened to {} s", *max_gap_s_) : "; --max-gap S shortens such gaps"));
}

}  // namespace sonopose::player
