#include "dds/binding/error.hpp"
#include "dds/binding/logged_errors.hpp"
#include "dds/binding/system_checks.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/binding/network_interfaces.hpp>

#include <charconv>
#include <cstdlib>
#include <map>
#include <mutex>
#include <stdexcept>

namespace sonopose::dds {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

struct OpenDomain {
  dds_entity_t entity = 0;
  DomainOptions options;
  int leases = 0;
};

/// Returns true if a domain with these options can be shared.
bool same_configuration(const DomainOptions& a, const DomainOptions& b) {
  return a.network == b.network && a.interfaces == b.interfaces && a.peers == b.peers && a.lease == b.lease &&
         a.wait_for_readers == b.wait_for_readers && a.batch_writes == b.batch_writes;
}

struct Registry {
  std::mutex mutex;
  std::map<std::uint32_t, OpenDomain> open;
};

Registry& registry() {
  static auto* instance = new Registry;  // never destroyed: leases may be static objects
  return *instance;
}

dds_entity_t create_domain(std::uint32_t id, const DomainOptions& options) {
  const std::string uri = environment("CYCLONEDDS_URI");
  const UserNetwork user = network_named_by(uri, id);
  std::string about = "domain " + std::to_string(id);
  check_free_descriptors(about);
  check_free_threads(about);
  check_shared_memory(about, user);
  const NetworkChoice network = choose_network(options, user, network_interfaces());
  if (!network.is_ready && !options.interfaces.empty()) {
    throw Error(about, DDS_RETCODE_PRECONDITION_NOT_MET, network.text);
  }
  if (!uri.empty()) about += ", CYCLONEDDS_URI=" + uri;
  LoggedErrors logged;
  const dds_entity_t domain = dds_create_domain(id, domain_configuration(id, options, uri, network).c_str());
  std::string reason = logged.text();
  if (reason.empty()) return check("dds_create_domain", about, domain);
  if (domain >= 0) {
    const std::string text = "domain " + std::to_string(id) + ": " + reason;
    report_error(text);
    return domain;
  }
  if (reason.find("interface") != std::string::npos) reason += "; " + interface_advice(options.network, user);
  throw Error("dds_create_domain(" + about + ")", domain, reason);
}

}  // namespace

std::uint32_t resolve_domain_id(const DomainOptions& options) {
  const auto fail = [](const std::string& name, const std::string& value) {
    throw std::invalid_argument(name + " is '" + value + "': a domain id is a whole number from 0 to " +
                                std::to_string(max_domain_id));
  };
  if (options.domain_id) {
    if (*options.domain_id > max_domain_id) fail("the domain option", std::to_string(*options.domain_id));
    return *options.domain_id;
  }
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) return 0;
  std::uint32_t id = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, id);
  if (error != std::errc() || rest != end || id > max_domain_id) fail("ROS_DOMAIN_ID", text);
  return id;
}

std::map<std::string, std::string> environment_variables(const std::vector<std::string>& names) {
  std::map<std::string, std::string> found;
  for (const std::string& name : names) {
    const std::string value = environment(name.c_str());
    if (!value.empty()) found.emplace(name, value);
  }
  return found;
}

DomainLease::DomainLease(const DomainOptions& options) : id_(resolve_domain_id(options)) {
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().open.find(id_);
  if (found == registry().open.end()) {
    // The entry follows the domain, whose creation may throw.
    const dds_entity_t entity = create_domain(id_, options);
    registry().open[id_] = {entity, options, 1};
  } else if (!same_configuration(found->second.options, options)) {
    throw Error("domain " + std::to_string(id_) +
                    " is in use in this process with another network, or another way of writing",
                DDS_RETCODE_PRECONDITION_NOT_MET);
  } else {
    ++found->second.leases;
  }
}

DomainLease::~DomainLease() {
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().open.find(id_);
  if (--found->second.leases > 0) return;
  dds_delete(found->second.entity);
  registry().open.erase(found);
}

}  // namespace sonopose::dds
