#include "ros2/relay/input_option.hpp"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace sonopose::ros2 {
namespace {

const char* word(Ros2Input::Kind kind) {
  return kind == Ros2Input::Kind::imu ? "--imu-in" : "--fix-in";
}

void check_pair(const Ros2Input& one, const Ros2Input& other) {
  if (one.kind != other.kind || one.address != other.address) return;
  throw std::invalid_argument(fmt::format("{} and {}: beacon {} has one source of {} alone", text_of(one),
                                          text_of(other), one.address,
                                          one.kind == Ros2Input::Kind::imu ? "IMU samples" : "fixes"));
}

}  // namespace

std::string text_of(const Ros2Input& input) {
  return fmt::format("{} {}={}", word(input.kind), input.topic, input.address);
}

Ros2Input Ros2Input::parse(Kind kind, std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{} {}: {}; as in /imu/data=7", word(kind), text, why));
  };
  if (equals == std::string_view::npos || equals == 0) fail("a topic, '=' and a beacon's address are needed");
  const std::string_view number = text.substr(equals + 1);
  std::uint32_t address = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), address);
  if (error != std::errc() || rest != number.data() + number.size() || address >= all_beacons) {
    fail(fmt::format("'{}' is no address of 0 to {}", number, all_beacons - 1));
  }
  return {kind, std::string(text.substr(0, equals)), static_cast<BeaconAddress>(address)};
}

void check(const std::vector<Ros2Input>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t j = i + 1; j < inputs.size(); ++j) check_pair(inputs[i], inputs[j]);
  }
}

}  // namespace sonopose::ros2
