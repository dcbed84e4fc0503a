#include "security_options.hpp"

#include "config/fusion_config.hpp"
#include "configuration_errors.hpp"
#include "host_seconds.hpp"
#include "logging/log.hpp"
#include "run.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"
#include "security/roles.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fnmatch.h>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <strings.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace sonopose::apps {
namespace {

/// Returns the name of the enclave of a program that is given none: its role.
std::string own_name(const CommandLine& app) {
  constexpr std::string_view prefix = "sonopose-";
  return std::string(security::role_of_program(app.name().substr(prefix.size())));
}

std::string relative(std::string name) {
  name.erase(0, name.find_first_not_of('/'));
  return name;
}

std::string variable(const std::string& name) {
  return dds::environment_variables({name})[name];
}

/// Returns the folder of the enclave; empty without security.
std::string selected_folder(const CommandLine& app, const BusOptions& options) {
  // ROS 2 replaces the name of its command line by the variable; here the command line has precedence.
  const std::string name = options.enclave ? relative(*options.enclave) : own_name(app);
  const bool is_enabled = ::strcasecmp(variable("ROS_SECURITY_ENABLE").c_str(), "true") == 0;
  if (options.enclave && (options.key_store || is_enabled)) {
    try {
      security::check_enclave_name(name);
    } catch (const security::SecurityError& error) {
      throw std::invalid_argument(std::string("--enclave: ") + error.what());
    }
  }
  if (options.key_store) {
    if (options.key_store->empty()) throw std::invalid_argument("--security: the path is empty");
    return (*options.key_store / "enclaves" / name).string();
  }
  const std::string other = options.enclave ? "" : variable("ROS_SECURITY_ENCLAVE_OVERRIDE");
  const std::string folder = dds::enclave_by_environment(other.empty() ? name : "");
  if (!folder.empty()) return folder;
  if (is_enabled) {
    logging::warning("security: ROS_SECURITY_KEYSTORE has no enclave " +
                     relative(other.empty() ? name : other) +
                     ", so this program joins without security, as ROS_SECURITY_STRATEGY=Permissive allows");
    ::unsetenv("ROS_SECURITY_ENABLE");  // the participant would take the enclave of a consumer
  } else if (options.enclave && own_name(app) != "ros2") {  // the relay announces the name in any case
    throw std::invalid_argument("--enclave " + *options.enclave + ": needs --security");
  }
  return {};
}

bool matches_any(const std::vector<std::string>& patterns, const std::string& name) {
  return std::ranges::any_of(
      patterns, [&](const std::string& pattern) { return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
}

/// A topic without which a program is of no use. Other topics depend on its options.
struct Necessity {
  std::string_view program;
  bool writes;
  const char* topic;
};
constexpr std::array necessities{
    Necessity{"sonopose-bridge", true, "sonopose/imu"}, Necessity{"sonopose-fusion", true, "sonopose/pose"},
    Necessity{"sonopose-web", false, "sonopose/pose"}, Necessity{"sonopose-mavlink", false, "sonopose/pose"}};

/// Throws std::invalid_argument, which names the option, if the enclave is of no use here: Cyclone DDS would
/// refuse a reader or a writer later, in words that name neither.
void check_rights(const CommandLine& app, const BusOptions& options, const security::Enclave& enclave) {
  constexpr std::uint32_t highest_secured_domain = 230;  // of Cyclone DDS
  const std::uint32_t domain = dds::resolve_domain_id(options.domain);
  if (domain > highest_secured_domain) {
    throw std::invalid_argument(fmt::format("{} {}: DDS Security works in the domains 0 to {}",
                                            options.domain.domain_id ? "--domain" : "ROS_DOMAIN_ID", domain,
                                            highest_secured_domain));
  }
  const std::string& folder = options.domain.enclave_folder;
  const security::Grant& grant = enclave.grant;
  const std::string& partition = options.domain.partition;
  const bool is_permitted =
      grant.partitions.empty() ? partition.empty() : matches_any(grant.partitions, partition);
  if (!is_permitted && grant.access.writes != std::vector<std::string>{"*"}) {
    throw std::invalid_argument(fmt::format(
        "--partition{}: the enclave {} may use only {}", partition.empty() ? " is missing" : " " + partition,
        folder, grant.partitions.empty() ? "no partition" : security::partitions_text(grant)));
  }
  for (const Necessity& each : necessities) {
    const auto& topics = each.writes ? grant.access.writes : grant.access.reads;
    if (each.program != app.name() || matches_any(topics, each.topic)) continue;
    throw std::invalid_argument(
        fmt::format("--enclave {}: may not {} {}, which {} needs: give it an enclave of the role {} "
                    "(sonopose-security list)",
                    folder, each.writes ? "write" : "read", each.topic, app.name(), own_name(app)));
  }
}

/// Names the option or variable that led to an enclave which cannot be used.
std::string origin_of_enclave(const BusOptions& options) {
  if (!options.key_store) return "ROS_SECURITY_KEYSTORE";
  std::error_code error;
  const bool has_enclaves = std::filesystem::is_directory(*options.key_store / "enclaves", error);
  const bool is_absent = !std::filesystem::is_directory(options.domain.enclave_folder, error);
  return options.enclave && has_enclaves && is_absent ? "--enclave" : "--security";
}

/// Selects the enclave and checks its files. Throws config::ConfigError.
void check_enclave(const CommandLine& app, BusOptions& options) {
  try {
    options.domain.enclave_folder = selected_folder(app, options);
    if (options.domain.enclave_folder.empty()) return;
    check_rights(app, options, security::read_enclave(options.domain.enclave_folder, host_now_s()));
  } catch (const security::NotYetValid&) {
    throw;  // a service that is started again finds a better clock
  } catch (const security::SecurityError& error) {
    throw config::ConfigError(origin_of_enclave(options) + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw config::ConfigError(error.what());
  }
}

/// Warns of an expiry, and ends the program when it comes.
class ExpiryWatch {
public:
  ExpiryWatch(std::string name, std::string command, std::int64_t expires_s)
      : name_(std::move(name)),
        command_(std::move(command)),
        expires_s_(expires_s),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

private:
  void run(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wakeup;
    std::unique_lock lock(mutex);
    std::int64_t warned_s = 0;
    while (!stop.stop_requested()) {
      const std::int64_t now = host_now_s();
      const std::string warning = security::expiry_warning(expires_s_, now);
      if (now >= expires_s_) return end_program(warning);
      if (!warning.empty() && now - warned_s >= security::day_s) {
        logging::warning(fmt::format("security: enclave {} {}; run {}", name_, warning, command_));
        warned_s = now;
      }
      const std::int64_t wait_s = std::min<std::int64_t>(expires_s_ - now, 3600);
      wakeup.wait_for(lock, stop, std::chrono::seconds(wait_s), [] { return false; });
    }
  }

  void end_program(const std::string& warning) const {
    logging::failure(fmt::format("security: enclave {} {}, so the bus refuses this process; run {}", name_,
                                 warning, command_));
    end_with(wrong_configuration);
    ::kill(::getpid(), SIGTERM);
  }

  std::string name_;
  std::string command_;
  std::int64_t expires_s_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace

void add_security_options(CommandLine& app, BusOptions& options) {
  count_as_configuration_error([](const std::exception& error) {
    return dynamic_cast<const dds::ForbiddenError*>(&error) != nullptr;  // a topic is not permitted
  });
  app.add_option("--security", options.key_store,
                 "Key store of DDS Security (default: ROS_SECURITY_KEYSTORE if ROS_SECURITY_ENABLE is true, "
                 "else no security)")
      .type_name("DIR")
      .group(bus_group);
  if (options.joins_bus) {
    app.add_option("--enclave", options.enclave, "Enclave in the key store (default: the program's role)")
        .type_name("NAME")
        .group(bus_group);
  }
}

void check_security(const CommandLine& app, BusOptions& options) {
  if (options.joins_bus) check_enclave(app, options);
}

std::string announced_enclave(const BusOptions& options) {
  const std::string& folder = options.domain.enclave_folder;
  if (folder.empty()) return options.enclave.value_or("/");
  const std::string parent = "/enclaves/";
  return folder.substr(folder.rfind(parent) + parent.size() - 1);
}

void watch_expiry(const dds::DomainOptions& domain) {
  const std::string& folder = domain.enclave_folder;
  if (folder.empty()) return;
  const security::Enclave enclave = security::read_enclave(folder, host_now_s());
  const std::string name = enclave.subject.substr(enclave.subject.find('/') + 1);
  logging::info(fmt::format("security: enclave {} of {}, until {}", name, folder,
                            security::date_text(enclave.expires_s)));
  if (enclave.has_common_authority) {
    logging::warning(
        "security: one authority signs identities and permissions, so each enclave can sign its own "
        "permissions (CVE-2023-24011); sonopose-security init makes a key store with two");
  }
  static ExpiryWatch watch(name, security::command_for(folder, "renew"), enclave.expires_s);
}

}  // namespace sonopose::apps
