#include "monitor/order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace sonopose::monitor {
namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();

/// Sort key: the largest comes first, an unknown one last.
double known_or_least(double value) {
  if (std::isnan(value)) return nothing;
  return value;
}

double key_of(const observation::BeaconView& view, Order order) {
  switch (order) {
    case Order::worst:
      return severity_of(view);
    case Order::address:
      return 0.0;
    case Order::error:
      return known_or_least(error_m(view));
    case Order::trust:
      return has_pose(view) ? known_or_least(-view.pose.trust) : nothing;
    case Order::latency:
      return known_or_least(view.latency.p99_s);
  }
  return 0.0;
}

}  // namespace

bool has_pose(const observation::BeaconView& view) {
  return view.pose.time_ns != 0;
}

double error_m(const observation::BeaconView& view) {
  if (view.position_error_rms_m) return *view.position_error_rms_m;
  return has_pose(view) ? position_std_m(view.pose).norm() : std::numeric_limits<double>::quiet_NaN();
}

void sort(std::vector<observation::BeaconView>& views, Order order) {
  // Sort handles: a view is large.
  std::vector<std::tuple<double, double, BeaconAddress, std::size_t>> keys;
  keys.reserve(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double second = order == Order::worst ? known_or_least(error_m(views[i])) : 0.0;
    keys.emplace_back(-key_of(views[i], order), -second, views[i].address, i);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<observation::BeaconView> sorted;
  sorted.reserve(views.size());
  for (const auto& key : keys) sorted.push_back(std::move(views[std::get<3>(key)]));
  views = std::move(sorted);
}

}  // namespace sonopose::monitor
