#include "security_options.hpp"

#include "config/fusion_config.hpp"
#include "host_seconds.hpp"
#include "logging/log.hpp"
#include "run.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/roles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <stop_token>
#include <string_view>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace sonopose::apps {
namespace {

/// Returns the name of the enclave of a program that is given none: its role.
std::string own_name(const CLI::App& app) {
  constexpr std::string_view prefix = "sonopose-";
  return std::string(security::role_of_program(app.get_name().substr(prefix.size())));
}

std::string relative(std::string name) {
  name.erase(0, name.find_first_not_of('/'));
  return name;
}

/// Returns the folder of the enclave; empty without security.
std::string selected_folder(const CLI::App& app, const BusOptions& options) {
  // ROS 2 replaces the name of its command line by the variable; here the command line has precedence.
  const std::string name = options.enclave ? relative(*options.enclave) : own_name(app);
  if (options.key_store) return (*options.key_store / "enclaves" / name).string();
  const bool is_overridden =
      !options.enclave && !dds::environment_variables({"ROS_SECURITY_ENCLAVE_OVERRIDE"}).empty();
  const std::string folder = dds::enclave_by_environment(is_overridden ? "" : name);
  if (!folder.empty()) return folder;
  if (!dds::environment_variables({"ROS_SECURITY_KEYSTORE"}).empty() &&
      dds::environment_variables({"ROS_SECURITY_ENABLE"})["ROS_SECURITY_ENABLE"] == "true") {
    logging::warning("security: ROS_SECURITY_KEYSTORE has no enclave " + name +
                     ", so this program joins without security, as ROS_SECURITY_STRATEGY=Permissive allows");
  } else if (options.enclave && own_name(app) != "ros2") {  // the relay announces the name in any case
    throw std::invalid_argument("--enclave " + *options.enclave + ": needs --security");
  }
  return {};
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
void check_enclave(const CLI::App& app, BusOptions& options) {
  try {
    options.domain.enclave_folder = selected_folder(app, options);
    if (options.domain.enclave_folder.empty()) return;
    security::read_enclave(options.domain.enclave_folder, host_now_s());
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

void add_security_options(CLI::App& app, BusOptions& options) {
  app.add_option("--security", options.key_store,
                 "Key store of DDS Security (default: ROS_SECURITY_KEYSTORE if ROS_SECURITY_ENABLE is true, "
                 "else no security)")
      ->type_name("DIR")
      ->group(bus_group);
  if (options.joins_bus) {
    app.add_option("--enclave", options.enclave, "Enclave in the key store (default: the program's role)")
        ->type_name("NAME")
        ->group(bus_group);
  }
}

void check_security(const CLI::App& app, BusOptions& options) {
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
