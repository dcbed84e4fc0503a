// Parses arguments of --set, and addresses of --udp: one per line.

#include "config/fusion_config.hpp"
#include "support.hpp"
#include "transport/udp_listener.hpp"

#include <set>
#include <stdexcept>
#include <string>
#include <tuple>

using namespace sonopose;
using namespace sonopose::fuzz;
using config::ConfigError;
using config::FusionConfig;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = text_of(data, size);
  FusionConfig config;
  std::set<std::string> keys;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    const std::size_t beacons = config.beacons().size();
    if (accepts<ConfigError>([&] { config.assign(line); })) {
      if (config.beacons().empty()) keys.emplace(line.substr(0, line.find('=')));
    } else {
      promise(config.beacons().size() == beacons, "a refused assignment changes nothing");
    }
    accepts<std::invalid_argument>([&] { transport::parse_endpoint(line); });
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  accepts<ConfigError>([&] { config.check(); });
  std::ignore = config.warnings();
  FusionConfig again;
  for (const std::string& key : keys) {
    const auto value = settings::get(config.for_beacon(all_beacons), key);
    again.assign(key + "=" + settings::to_text(value));
    promise(settings::get(again.for_beacon(all_beacons), key) == value,
            "a setting's text reads back to the same value");
  }
  return 0;
}
