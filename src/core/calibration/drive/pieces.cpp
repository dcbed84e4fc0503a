#include "calibration/drive/pieces.hpp"

#include <algorithm>
#include <iterator>

namespace sonopose::calibration::drive::detail {
namespace {

bool is_silence(const ImuMeasurement& before, const ImuMeasurement& after) {
  return seconds_between(before.time_ns, after.time_ns) > min_silence_s;
}

template <class Measurement>
std::vector<Measurement> between(const std::vector<Measurement>& all, TimeNs first_ns, TimeNs last_ns) {
  std::vector<Measurement> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found),
               [&](const Measurement& each) { return each.time_ns >= first_ns && each.time_ns <= last_ns; });
  return found;
}

}  // namespace

void append_pieces(const Measurements& log, std::vector<Measurements>& pieces) {
  for (auto begin = log.imu.begin(); begin != log.imu.end();) {
    const auto last = std::adjacent_find(begin, log.imu.end(), is_silence);
    const auto end = last == log.imu.end() ? last : last + 1;
    if (seconds_between(begin->time_ns, (end - 1)->time_ns) >= min_piece_s) {
      const TimeNs first_ns = saturated_sum(begin->time_ns, to_ns(margin_s));
      const TimeNs last_ns = saturated_sum((end - 1)->time_ns, -to_ns(margin_s));
      pieces.push_back({.imu = {begin, end},
                        .fixes = between(log.fixes, first_ns, last_ns),
                        .headings = between(log.headings, first_ns, last_ns),
                        .recording = log.recording});
    }
    begin = end;
  }
}

Measurements set_back(Measurements log, double delay_s) {
  for (Fix& fix : log.fixes) fix.time_ns = saturated_sum(fix.time_ns, -to_ns(delay_s));
  for (Heading& heading : log.headings) {
    heading.time_ns = saturated_sum(heading.time_ns, -to_ns(delay_s));
  }
  return log;
}

std::size_t silences_in(const Measurements& log) {
  std::size_t count = 0;
  for (std::size_t i = 1; i < log.imu.size(); ++i) count += is_silence(log.imu[i - 1], log.imu[i]) ? 1U : 0U;
  return count;
}

double duration_s(std::span<const Measurements> pieces) {
  double sum_s = 0;
  for (const Measurements& piece : pieces) {
    sum_s += seconds_between(piece.imu.front().time_ns, piece.imu.back().time_ns);
  }
  return sum_s;
}

}  // namespace sonopose::calibration::drive::detail
