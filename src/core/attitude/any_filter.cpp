#include <sonopose/attitude/any_filter.hpp>

#include <utility>

namespace sonopose::attitude {
namespace {

const Adaptive::Settings& settings_of(const Adaptive& /*filter*/, const Settings& all) {
  return all.adaptive;
}
const Mahony::Settings& settings_of(const Mahony& /*filter*/, const Settings& all) {
  return all.mahony;
}
const Complementary::Settings& settings_of(const Complementary& /*filter*/, const Settings& all) {
  return all.complementary;
}
const Ahrs::Settings& settings_of(const Ahrs& /*filter*/, const Settings& all) {
  return all.ahrs;
}
GyroSettings settings_of(const Gyro& /*filter*/, const Settings& /*all*/) {
  return {};
}

/// Default-constructs alternative number `index` in `filter`.
template <std::size_t... Index, class... Filters>
void emplace(std::variant<Filters...>& filter, std::size_t index, std::index_sequence<Index...> /*all*/) {
  ((index == Index ? static_cast<void>(filter.template emplace<Index>()) : void()), ...);
}

}  // namespace

bool has_magnetic_heading(const SelectionSettings& settings) {
  return settings.magnetometer && settings.filter != FilterKind::gyro;
}

FieldUse field_use(const SelectionSettings& settings) {
  return {settings.magnetometer, settings.north_deg};
}

void AnyFilter::reset(const Quaterniond& q_body_to_world) {
  std::visit([&](auto& filter) { filter.reset(q_body_to_world); }, filter_);
}

void AnyFilter::update(const Settings& all, const Measurement<double>& measurement) {
  const SelectionSettings& settings = all.selection;
  if (settings.filter != kind()) select(settings.filter);
  std::visit([&](auto& filter) { filter.update(settings_of(filter, all), measurement); }, filter_);
}

void AnyFilter::turn_in_world(const Vector3d& rotation_world_rad) {
  std::visit([&](auto& filter) { filter.turn_in_world(rotation_world_rad); }, filter_);
}

void AnyFilter::set_gyro_bias(const Vector3d& bias_body_radps) {
  std::visit([&](auto& filter) { filter.set_gyro_bias(bias_body_radps); }, filter_);
}

Quaterniond AnyFilter::orientation() const {
  return std::visit([](const auto& filter) { return Quaterniond(filter.orientation()); }, filter_);
}

Vector3d AnyFilter::gyro_bias_body_radps() const {
  return std::visit([](const auto& filter) { return Vector3d(filter.gyro_bias_body_radps()); }, filter_);
}

void AnyFilter::select(FilterKind kind) {
  const Quaterniond q_body_to_world = orientation();
  const Vector3d bias_body_radps = gyro_bias_body_radps();
  emplace(filter_, static_cast<std::size_t>(kind),
          std::make_index_sequence<std::variant_size_v<decltype(filter_)>>());
  reset(q_body_to_world);
  set_gyro_bias(bias_body_radps);
}

}  // namespace sonopose::attitude
