// sonopose-fusion: subscribes to the bridge's samples and publishes the fused pose of every beacon.

#include "fusion/fusion_node.hpp"
#include "process/service.hpp"
#include "support/bus_options.hpp"
#include "support/config_options.hpp"
#include "support/log_option.hpp"
#include "support/options_file.hpp"
#include "support/realtime_option.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <unistd.h>

namespace {

struct Options {
  sonopose::apps::BusOptions bus;
  sonopose::apps::ConfigOptions config;
  std::optional<std::string> addresses;
  std::size_t max_beacons = sonopose::presence::BeaconAdmission::default_max_beacons;
  std::int32_t standby_strength = 0;
  double warm_up_s = sonopose::fusion::StandbyOptions{}.warm_up_s;
  std::optional<std::filesystem::path> learned_file;
  bool lossless = false;
  int realtime_priority = 0;
  sonopose::logging::Level log_level = sonopose::logging::Level::info;
  bool print_config = false;
  bool check_config = false;
  bool print_settings_page = false;
};

void add_options(sonopose::apps::CommandLine& app, Options& options) {
  app.add_option("--addresses", options.addresses,
                 "Serve only these beacons: 7, 7-131 or 7-131,200 (default: all)")
      .check(sonopose::apps::readable_by(sonopose::presence::AddressSet::parse))
      .type_name("LIST");
  sonopose::apps::add_max_beacons(app, "Serve", options.max_beacons);
  auto strength = app.add_option(
      "--standby-strength", options.standby_strength,
      "Share the beacons with other fusions: the strongest one that receives a beacon serves it");
  strength.check(sonopose::apps::number_between(1, sonopose::max_fusion_strength)).type_name("N");
  app.add_option("--warm-up", options.warm_up_s,
                 "With --standby-strength: seconds of good poses before this fusion claims a beacon")
      .check(sonopose::apps::number_between(0.0, 600.0))
      .needs(strength)
      .capture_default_str();
  auto learned =
      app.add_option("--learned", options.learned_file,
                     "Save learned sensor errors to this file, and start from them (Kalman engine only)")
          .type_name("FILE");
  app.add_flag("--lossless", options.lossless,
               "Keep every event and pose and wait for slow consumers; use it for a log played at --rate 0")
      .excludes(strength)
      .excludes(learned);
  app.add_flag("--print-config", options.print_config,
               "Print settings and options as commented TOML and exit");
  app.add_flag("--check-config", options.check_config,
               "Report what is wrong with settings and options and exit");
  app.add_flag("--print-settings-page", options.print_settings_page,
               "Print the table of all settings as a page of the docs and exit")
      .group("");  // for those who change the table
}

sonopose::fusion::FusionOptions node_options(
    const Options& options, const sonopose::config::FusionConfig& config,
    const std::function<sonopose::config::FusionConfig()>& read_again) {
  using namespace sonopose::fusion;
  FusionOptions node{.domain = options.bus.domain,
                     .qos_file = options.bus.qos_file,
                     .config = config,
                     .addresses = {},
                     .max_beacons = options.max_beacons,
                     .standby = {},
                     .learned_file = options.learned_file,
                     .lossless = options.lossless,
                     .read_again = read_again};
  if (options.addresses) node.addresses = sonopose::presence::AddressSet::parse(*options.addresses);
  if (options.standby_strength > 0) node.standby = {options.standby_strength, options.warm_up_s};
  return node;
}

/// Warns if what is learned could not be saved, which no pose needs.
void check_learned(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (::access(folder.c_str(), W_OK) == 0) return;
  sonopose::logging::warning(fmt::format("--learned {}: cannot be written: {}", file.string(),
                                         std::generic_category().message(errno)));
}

int serve(const sonopose::apps::CommandLine& app, const Options& options) {
  if (options.print_settings_page) {
    sonopose::apps::print("{}", sonopose::config::settings_page());
    return 0;
  }
  const sonopose::logging::Session log(options.log_level);
  const auto config = sonopose::apps::configuration(options.config);
  if (options.print_config) {
    sonopose::apps::print("{}\n[program]\n{}", config.to_toml(), sonopose::apps::options_toml(app));
    return 0;
  }
  check_publisher(options.bus);
  if (options.learned_file) check_learned(*options.learned_file);
  if (options.check_config) return 0;  // the parsing has checked the QoS file and the enclave
  sonopose::process::StopSignal stop;
  stop.listen_to_signals();
  const auto with_config =
      node_options(options, config, [&] { return sonopose::apps::configuration(options.config); });
  if (!sonopose::apps::wait_for_network(with_config.domain, stop)) return 0;
  sonopose::fusion::FusionNode node(with_config);
  const auto realtime = sonopose::apps::realtime(options.realtime_priority);
  sonopose::logging::info("serving");
  sonopose::apps::serve([&] { node.run(stop); });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const sonopose::process::ReloadRequest reload;  // first: otherwise SIGUSR2 would end the process
  Options options;
  sonopose::apps::Program app("fusion");
  add_bus_options(app, options.bus);
  sonopose::apps::add_realtime_option(app, options.realtime_priority);
  sonopose::apps::add_log_option(app, options.log_level);
  sonopose::apps::add_config_options(app, options.config);
  add_options(app, options);
  return sonopose::apps::run(app, argc, argv, [&] { return serve(app, options); });
}
