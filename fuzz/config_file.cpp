// Loads a configuration file of the fusion, in TOML.

#include "config/fusion_config.hpp"
#include "support.hpp"

#include <tuple>

using namespace sonopose;
using namespace sonopose::fuzz;
using config::ConfigError;
using config::FusionConfig;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder folder;
  const auto file = folder.write("fusion.toml", text_of(data, size));
  FusionConfig config;
  if (!accepts<ConfigError>([&] { config = FusionConfig::load(file); })) return 0;
  accepts<ConfigError>([&] { config.check(); });
  static const std::string defaults = FusionConfig().to_toml();
  const std::string printed = config.to_toml();
  if (printed == defaults) return 0;
  const FusionConfig again = FusionConfig::load(folder.write("printed.toml", printed));
  promise(again.to_toml() == printed, "what is printed loads back to the same");
  std::ignore = config.warnings();
  return 0;
}
