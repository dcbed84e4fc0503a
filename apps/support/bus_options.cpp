#include "bus_options.hpp"

#include "choice.hpp"
#include "clocks/clocks.hpp"
#include "config/fusion_config.hpp"
#include "logging/log.hpp"
#include "process/service.hpp"
#include "security_options.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/network_interfaces.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/samples/samples.hpp>

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace sonopose::apps {
namespace {

void log_message(dds::MessageLevel level, std::string_view message) {
  const bool is_own = message.starts_with("security: ");  // already in our words
  const std::string text = (is_own ? "" : "DDS: ") + std::string(message);
  // ROS 2's distributions announce nodes in two layouts, and none reads that of the other.
  if (message.find("deserialization ros_discovery_info/") != message.npos) return logging::debug(text);
  switch (level) {
    case dds::MessageLevel::info:
      return logging::info(text);
    case dds::MessageLevel::warning:
      return logging::warning(text);
    case dds::MessageLevel::error:
      return logging::error(text);
    case dds::MessageLevel::fatal:
      return logging::failure(text);
  }
}

/// Throws config::ConfigError for a file of SONOPOSE_QOS that cannot be used. That of --qos is checked
/// already. A program that joins no bus may start others that use the file.
void check_qos_of_environment(const BusOptions& options) {
  if (options.qos_file) return;
  try {
    const dds::qos::Provider provider;
  } catch (const dds::qos::FileError& error) {
    throw config::ConfigError(error.what());
  }
}

}  // namespace

void add_bus_options(CommandLine& app, BusOptions& options) {
  dds::send_messages_to(log_message);
  app.add_option_function<std::uint32_t>(
         "--domain", [&options](std::uint32_t id) { options.domain.domain_id = id; },
         "DDS domain (default: ROS_DOMAIN_ID, else 0)")
      .check(number_between(0U, dds::max_domain_id))
      .group(bus_group);
  add_choice<dds::Network>(app, "--network", options.domain.network,
                           {{"loopback", dds::Network::loopback}, {"lan", dds::Network::lan}},
                           "loopback: only this machine; lan: the interface with the default route, else "
                           "the most likely one (CYCLONEDDS_URI overrides both)")
      .group(bus_group);
  app.add_option("--interface", options.domain.interfaces,
                 "Use this network interface instead, such as wlan0, or lo for this machine; may be repeated")
      .type_name("NAME")
      .check({[](const std::string& name) {
                return name.empty() ? std::string("the name of an interface is empty") : std::string();
              },
              ""})
      .group(bus_group)
      .allow_extra_args(false);
  app.add_option(
         "--partition", options.domain.partition,
         "DDS partition to read and write; a reader may use a pattern: hall-* (default: no partition)")
      .type_name("NAME")
      .group(bus_group);
  app.add_option("--qos", options.qos_file,
                 "File of QoS policies that override the project's (default: SONOPOSE_QOS, else none)")
      .check(readable_by([](const std::string& file) { dds::qos::Provider{file}; }))
      .type_name("FILE")
      .group(bus_group);
  add_security_options(app, options);
  app.final_callback([&app, &options] {
    check_qos_of_environment(options);
    check_security(app, options);
  });
}

bool wait_for_network(const dds::DomainOptions& domain, const process::StopSignal& stop, double duration_s) {
  const SteadyTime began = clocks::steady_now();
  constexpr TimeNs period_ns = 500'000'000;
  watch_expiry(domain);
  std::string missing;
  dds::NetworkChoice choice = dds::choose_network(domain);
  for (; !choice.is_ready; choice = dds::choose_network(domain)) {
    // Otherwise the service manager would end the start, or the process.
    process::report_ready();
    process::report_progress(clocks::steady_now());
    if (missing != choice.text) {
      process::report_status("waiting for the network: " + choice.text);
      logging::warning("waiting for the network: " + choice.text);
    }
    missing = choice.text;
    if (duration_s > 0.0 && seconds_between(began, clocks::steady_now()) >= duration_s) {
      throw std::runtime_error(
          fmt::format("waited for the network for the {} s of --duration: {}", duration_s, missing));
    }
    if (stop.wait_until(clocks::steady_now() + period_ns)) return false;
  }
  if (!missing.empty()) process::report_status("network: " + choice.text);
  const bool is_loopback_alone = domain.network == dds::Network::ros_subnet && domain.interfaces.empty() &&
                                 choice.interfaces.size() == 1;
  if (is_loopback_alone) {
    logging::warning("network: " + choice.text + "; other machines are found only after a restart");
    return true;
  }
  const bool is_default = domain.network == dds::Network::loopback && domain.interfaces.empty();
  logging::write(is_default ? logging::Level::debug : logging::Level::info, "network: " + choice.text);
  return true;
}

void add_max_beacons(CommandLine& app, const std::string& verb, std::size_t& max_beacons) {
  app.add_option("--max-beacons", max_beacons,
                 verb + " at most this many beacons at a time: the first ones that are heard")
      .check(number_between(std::size_t{1}, std::size_t{all_beacons}))
      .type_name("N")
      .capture_default_str();
}

void check_publisher(const BusOptions& options) {
  const std::string& partition = options.domain.partition;
  if (partition.find_first_of("*?[") == std::string::npos) return;
  throw std::invalid_argument(
      "--partition " + partition +
      ": a program that publishes needs a single partition; only readers can use patterns (* ? [)");
}

}  // namespace sonopose::apps
