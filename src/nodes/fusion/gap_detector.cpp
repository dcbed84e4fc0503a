#include "fusion/gap_detector.hpp"

#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

namespace sonopose::fusion {

std::optional<std::string> GapDetector::on(BeaconAddress address,
                                           const std::optional<collation::LosslessCollator::Gap>& gap,
                                           SteadyTime now) {
  if (!gap) {
    waits_.erase(address);
    return std::nullopt;
  }
  const auto [found, first] = waits_.try_emplace(address, Wait{gap->missing, now, false});
  Wait& wait = found->second;
  if (wait.missing != gap->missing) wait = {gap->missing, now, false};
  if (first || wait.reported || now - wait.since < timeout_ns) return std::nullopt;
  wait.reported = true;
  return fmt::format("beacon {}: waiting for event {}, {} waiting; --lossless is for a bridge with --rate 0",
                     address, gap->missing, text::count_text(gap->waiting, "event"));
}

}  // namespace sonopose::fusion
