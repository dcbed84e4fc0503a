#include "monitor/words.hpp"

#include "observation/status_counters.hpp"
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <vector>

namespace sonopose::monitor {
namespace {

struct Counted {
  std::uint64_t count;
  std::string_view one;
  std::string_view several;
};

/// Text such as "3 IMU deadlines missed, 1 bridge loss"; empty if all counts are 0.
std::string counted_words(const std::vector<Counted>& counts) {
  std::vector<std::string> words;
  for (const auto& [count, one, several] : counts) {
    if (count > 0) words.push_back(text::count_text(count, one, several));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

template <class Status, std::size_t Size>
std::vector<Counted> problems_in(const Status& status,
                                 const std::array<observation::StatusCounter<Status>, Size>& counters) {
  std::vector<Counted> problems;
  for (const auto& counter : counters) {
    if (!counter.problem.empty())
      problems.push_back({status.*counter.value, counter.problem, counter.problems});
  }
  return problems;
}

std::string bridge_problems(const BeaconStatus& bridge) {
  std::vector<Counted> problems = problems_in(bridge, observation::bridge_counters);
  problems.push_back({bridge.other_bridges, "other bridge", "other bridges"});
  return counted_words(problems);
}

std::string fusion_problems(const FusionStatus& fusion) {
  return counted_words(problems_in(fusion, observation::fusion_counters));
}

}  // namespace

double heading_deg(const FusedPose& pose) {
  return geometry::yaw_of(pose.q_body_to_world) / geometry::radians_per_degree;
}

std::string number(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string(unknown);
}

std::string ms(double seconds) {
  return number(seconds * 1e3, 2);
}

std::string_view role_word(FusionRole role) {
  constexpr std::array<std::string_view, 4> words{"sole", "warming up", "serving", "stalled"};
  return words[static_cast<std::size_t>(role)];
}

std::string problems_of(const observation::BeaconView& view) {
  std::string text;
  const auto add_line = [&](std::string_view process, const std::string& words) {
    if (!words.empty()) text += fmt::format("{:>6}  {}: {}\n", view.address, process, words);
  };
  if (view.bridge) add_line("bridge", bridge_problems(*view.bridge));
  for (const FusionStatus& fusion : view.fusions) {
    const std::string process = view.fusions.size() > 1 ? fmt::format("fusion of strength {} ({})",
                                                                      fusion.strength, role_word(fusion.role))
                                                        : "fusion";
    add_line(process, fusion_problems(fusion));
  }
  add_line("here", counted_words({{view.deadlines_missed, "pose deadline missed", "pose deadlines missed"},
                                  {view.losses, "pose stream loss", "pose stream losses"}}));
  return text;
}

}  // namespace sonopose::monitor
