#include "ros2/relay/input_option.hpp"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace sonopose::ros2::relay {
namespace {

const char* option_name(Input::Kind kind) {
  return kind == Input::Kind::imu ? "--imu-in" : "--fix-in";
}

void check_pair(const Input& one, const Input& other) {
  if (one.kind != other.kind || one.address != other.address) return;
  throw std::invalid_argument(fmt::format("{} and {}: beacon {} can have only one source of {}", text_of(one),
                                          text_of(other), one.address,
                                          one.kind == Input::Kind::imu ? "IMU samples" : "fixes"));
}

}  // namespace

std::string text_of(const Input& input) {
  return fmt::format("{} {}={}", option_name(input.kind), input.topic, input.address);
}

Input Input::parse(Kind kind, std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{} {}: {}; example: /imu/data=7", option_name(kind), text, why));
  };
  if (equals == std::string_view::npos || equals == 0) fail("expected TOPIC=ADDRESS");
  const std::string_view number = text.substr(equals + 1);
  std::uint32_t address = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), address);
  if (error != std::errc() || rest != number.data() + number.size() || address >= all_beacons) {
    fail(fmt::format("'{}' is not an address from 0 to {}", number, all_beacons - 1));
  }
  return {.kind = kind,
          .topic = std::string(text.substr(0, equals)),
          .address = static_cast<BeaconAddress>(address)};
}

void check(const std::vector<Input>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t j = i + 1; j < inputs.size(); ++j) check_pair(inputs[i], inputs[j]);
  }
}

}  // namespace sonopose::ros2::relay
