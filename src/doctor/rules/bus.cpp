#include "doctor/rules/rules.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::doctor::doctor {
namespace {

bool is_native(const Observations& seen, const EndpointObservation& endpoint) {
  return std::any_of(seen.native_topics.begin(), seen.native_topics.end(),
                     [&](const NativeTopic& topic) { return topic.name == endpoint.topic; });
}

bool anybody(const Observations& seen) {
  const auto native = [&](const EndpointObservation& endpoint) { return is_native(seen, endpoint); };
  return std::any_of(seen.writers.begin(), seen.writers.end(), native) ||
         std::any_of(seen.readers.begin(), seen.readers.end(), native);
}

void check_network(const BusObservation& bus, Findings& findings) {
  findings.push_back(
      {Severity::ok,
       "bus",
       fmt::format("domain {}, {} ({})", bus.domain_id,
                   bus.loopback_only ? "this machine alone" : "the network", bus.interfaces_in_use),
       {}});
  if (bus.peers_named) return;
  for (const InterfaceObservation& interface : bus.interfaces) {
    if (interface.multicast) continue;
    const std::string what = fmt::format(
        "CYCLONEDDS_URI names the interface {}, which has no multicast, and no peers: ", interface.name);
    if (interface.loopback) {
      findings.push_back(
          {Severity::note, "bus",
           what + "programs of other makers find nobody there (sonopose's own ask 127.0.0.1)",
           "add <Discovery><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery> to theirs"});
    } else {
      findings.push_back({Severity::warning, "bus", what + "nobody on other machines can be found",
                          "add <Discovery><Peers><Peer address=\"…\"/></Peers></Discovery> with the other "
                          "machines' addresses"});
    }
  }
}

/// "beacons are published in domain 5: use --domain 5"; empty where there are none.
std::string found_elsewhere(const BusObservation& bus) {
  std::string text;
  for (const DomainObservation& domain : bus.other_domains) {
    const char* const what = domain.beacons ? "beacons are published"
                             : domain.poses ? "a fusion runs"
                                            : "processes of sonopose run";
    text += fmt::format("{}{} in domain {}: use --domain {}", text.empty() ? "" : "; ", what, domain.id,
                        domain.id);
  }
  return text;
}

std::string remedy(const BusObservation& bus, const std::string& otherwise) {
  const std::string elsewhere = found_elsewhere(bus);
  return elsewhere.empty() ? otherwise : elsewhere;
}

void look_for_processes(const Observations& seen, Findings& findings) {
  const BusObservation& bus = seen.bus;
  const std::string lan =
      !bus.loopback_only ? ""
      : bus.interfaces.empty()
          ? "; what runs on other machines is seen with --network lan alone, on both sides"
          : "; what runs on other machines is not seen, as CYCLONEDDS_URI says";
  if (!anybody(seen)) {
    findings.push_back({Severity::error, "bus",
                        fmt::format("no sonopose process in domain {}{}", bus.domain_id,
                                    bus.looked_elsewhere && bus.other_domains.empty()
                                        ? ", nor in the others that were looked at"
                                        : ""),
                        remedy(bus, "start sonopose-bridge and sonopose-fusion" + lan)});
    return;
  }
  if (on_topic(seen.writers, "sonopose/imu").empty()) {
    findings.push_back({Severity::error, "sonopose/imu",
                        fmt::format("nobody publishes beacons in domain {}", bus.domain_id),
                        remedy(bus, fmt::format("start sonopose-bridge --domain {}{}", bus.domain_id, lan))});
  }
  if (on_topic(seen.writers, "sonopose/pose").empty()) {
    findings.push_back({Severity::error, "sonopose/pose",
                        fmt::format("no fusion runs in domain {}", bus.domain_id),
                        remedy(bus, fmt::format("start sonopose-fusion --domain {}{}", bus.domain_id, lan))});
  } else if (on_topic(seen.readers, "sonopose/pose").empty()) {
    findings.push_back({Severity::note, "sonopose/pose", "nobody listens to the poses",
                        "start a consumer, such as sonopose-monitor"});
  }
}

}  // namespace

void check_bus(const Observations& seen, Findings& findings) {
  check_network(seen.bus, findings);
  look_for_processes(seen, findings);
}

}  // namespace sonopose::doctor::doctor
