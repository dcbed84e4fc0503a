// What is typed after --set, and the addresses of --udp: one per line.

#include "config/fusion_config.hpp"
#include "support.hpp"
#include "transport/udp_listener.hpp"

#include <stdexcept>
#include <tuple>

using namespace sonopose;
using namespace sonopose::fuzz;
using config::ConfigError;
using config::FusionConfig;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = text_of(data, size);
  FusionConfig config;
  int accepted = 0;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    const std::size_t beacons = config.beacons().size();
    if (accepts<ConfigError>([&] { config.assign(line); })) {
      ++accepted;
    } else {
      promise(config.beacons().size() == beacons, "a refused assignment changes nothing");
    }
    accepts<std::invalid_argument>([&] { transport::parse_endpoint(line); });
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  accepts<ConfigError>([&] { config.check(); });
  std::ignore = config.warnings();
  if (accepted == 0) return 0;
  FusionConfig again;
  for (const auto& [key, value] : config::texts_of(config.for_beacon(all_beacons))) {
    again.assign(key + "=" + value);
  }
  promise(config::texts_of(again.for_beacon(all_beacons)) == config::texts_of(config.for_beacon(all_beacons)),
          "a setting's text reads back to the same value");
  return 0;
}
