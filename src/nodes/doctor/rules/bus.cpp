#include "doctor/rules/checks.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace sonopose::doctor::rules {
namespace {

bool is_native(const Observations& observations, const EndpointObservation& endpoint) {
  return std::any_of(observations.native_topics.begin(), observations.native_topics.end(),
                     [&](const NativeTopic& topic) { return topic.name == endpoint.topic; });
}

bool any_native_endpoint(const Observations& observations) {
  const auto native = [&](const EndpointObservation& endpoint) { return is_native(observations, endpoint); };
  return std::any_of(observations.writers.begin(), observations.writers.end(), native) ||
         std::any_of(observations.readers.begin(), observations.readers.end(), native);
}

/// Reports gaps in the observations themselves.
void check_coverage(const Observations& observations, Findings& findings) {
  if (observations.cut_from_s) {
    findings.push_back({Severity::note,
                        "doctor",
                        fmt::format("stopped after {:.1f} s of {:g} s: later problems were not observed",
                                    observations.window_s, *observations.cut_from_s),
                        {}});
  }
  if (observations.beacons_not_fitted > 0) {
    findings.push_back({Severity::note, "doctor",
                        fmt::format("mount, delay and signs of {} were not checked, or only in part",
                                    text::count_text(observations.beacons_not_fitted, "beacon")),
                        observations.cut_from_s ? "run it again without stopping it"
                                                : "run it again, with fewer beacons or on a faster machine"});
  }
}

void check_security(const BusObservation& bus, Findings& findings) {
  if (bus.is_secured) findings.push_back({Severity::ok, "bus", "DDS Security is in use", {}});
  if (!bus.is_secured && !bus.loopback_only) {
    findings.push_back({Severity::note, "bus",
                        "no security: anybody on the network can write poses and change settings",
                        "let all processes use --security (SECURITY.md), or keep strangers off the network"});
  }
  for (const std::string& text : bus.refused) {
    const bool is_unsecured = text.find("no certificate") != std::string::npos;
    findings.push_back({Severity::warning, "bus", "DDS Security refused " + text,
                        is_unsecured ? "if it is yours, give it --security with the same key store"
                                     : "if it is yours, run sonopose-security check, copy its enclave from "
                                       "this key store again, and restart it"});
  }
  for (const std::string& text : bus.expiring) {
    findings.push_back({Severity::warning, "bus", text, "sonopose-security renew, and restart the programs"});
  }
}

void check_network(const BusObservation& bus, Findings& findings) {
  if (bus.is_network_missing) {
    findings.push_back(
        {Severity::error, "bus", bus.interfaces_in_use,
         "connect it; processes with --network lan or --interface wait for it at their start"});
    return;
  }
  findings.push_back(
      {Severity::ok,
       "bus",
       fmt::format("domain {}, {}: {}", bus.domain_id,
                   bus.loopback_only ? "this machine only" : "the network", bus.interfaces_in_use),
       {}});
  if (bus.has_peers) return;
  for (const InterfaceObservation& interface : bus.interfaces) {
    if (interface.multicast) continue;
    const std::string what = fmt::format(
        "CYCLONEDDS_URI names the interface {}, which has no multicast, and no peers: ", interface.name);
    if (interface.loopback) {
      findings.push_back(
          {Severity::note, "bus",
           what + "other DDS programs discover no process on it (sonopose's own use the peer 127.0.0.1)",
           "add <Discovery><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery> to their configuration"});
    } else {
      findings.push_back({Severity::warning, "bus", what + "processes on other machines cannot be discovered",
                          "add <Discovery><Peers><Peer address=\"…\"/></Peers></Discovery> with the other "
                          "machines' addresses"});
    }
  }
}

std::string place_of(const DomainObservation& domain) {
  return domain.on_loopback ? "on loopback of this machine" : fmt::format("in domain {}", domain.id);
}

/// "beacons are published in domain 5: use --domain 5"; empty if there are none.
std::string other_domains_text(const BusObservation& bus) {
  std::string text;
  for (const DomainObservation& domain : bus.other_domains) {
    const char* const what = domain.beacons ? "beacons are published"
                             : domain.poses ? "a fusion runs"
                                            : "sonopose processes run";
    text += fmt::format("{}{} {}: use {}", text.empty() ? "" : "; ", what, place_of(domain),
                        domain.on_loopback ? "--network loopback" : fmt::format("--domain {}", domain.id));
  }
  return text;
}

/// Text about the other domains: empty ones, and those not checked.
std::string search_text(const BusObservation& bus) {
  if (!bus.searched_other_domains) return "";
  std::string text = bus.other_domains.empty() ? ", nor in the other domains checked" : "";
  if (bus.domains_not_searched > 0) {
    text += fmt::format(
        " ({} other domains could not be checked in the time and with the file descriptors of `ulimit -n`)",
        bus.domains_not_searched);
  }
  return text;
}

/// Advice for a part that is missing here but found in another domain, as `what` says; otherwise `fallback`.
std::string remedy(const BusObservation& bus, bool DomainObservation::*missing, const char* what,
                   const std::string& fallback) {
  for (const DomainObservation& domain : bus.other_domains) {
    if (!(domain.*missing)) continue;
    return fmt::format("{} {}: start both bridge and fusion with the same {}", what, place_of(domain),
                       domain.on_loopback ? "--network" : "--domain");
  }
  return fallback;
}

void check_processes(const Observations& observations, Findings& findings) {
  const BusObservation& bus = observations.bus;
  const std::string lan = !bus.loopback_only || bus.is_network_missing ? ""
                          : bus.interfaces.empty()
                              ? "; to reach other machines, use --network lan on both sides"
                              : "; other machines are not reachable, because CYCLONEDDS_URI selects loopback";
  if (!any_native_endpoint(observations)) {
    const std::string other_domains = other_domains_text(bus);
    if (bus.without_topics > 0 && !bus.is_secured) {
      findings.push_back({Severity::error, "bus",
                          fmt::format("{} in domain {} {} no topics: secured?",
                                      text::count_text(bus.without_topics, "process", "processes"),
                                      bus.domain_id, bus.without_topics == 1 ? "shows" : "show"),
                          "use --security with their key store" +
                              (other_domains.empty() ? "" : "; otherwise " + other_domains)});
      return;
    }
    findings.push_back(
        {Severity::error, "bus",
         fmt::format("no sonopose process in domain {}{}", bus.domain_id, search_text(bus)),
         other_domains.empty() ? "start sonopose-bridge and sonopose-fusion" + lan : other_domains});
    return;
  }
  if (on_topic(observations.writers, "sonopose/imu").empty()) {
    findings.push_back({Severity::error, "sonopose/imu",
                        fmt::format("no bridge publishes in domain {}{}", bus.domain_id, search_text(bus)),
                        remedy(bus, &DomainObservation::beacons, "beacons are published",
                               fmt::format("start sonopose-bridge --domain {}{}", bus.domain_id, lan))});
  }
  if (on_topic(observations.writers, "sonopose/pose").empty()) {
    findings.push_back({Severity::error, "sonopose/pose",
                        fmt::format("no fusion runs in domain {}{}", bus.domain_id, search_text(bus)),
                        remedy(bus, &DomainObservation::poses, "a fusion runs",
                               fmt::format("start sonopose-fusion --domain {}{}", bus.domain_id, lan))});
  } else if (on_topic(observations.readers, "sonopose/pose").empty()) {
    findings.push_back({Severity::note, "sonopose/pose", "no process subscribes to the poses",
                        "start a consumer, such as sonopose-monitor"});
  }
}

}  // namespace

void check_bus(const Observations& observations, Findings& findings) {
  check_coverage(observations, findings);
  check_network(observations.bus, findings);
  check_security(observations.bus, findings);
  check_processes(observations, findings);
  if (observations.beacons_refused) {
    findings.push_back({Severity::warning, "bus", *observations.beacons_refused,
                        "raise --max-beacons above the number of your beacons; if you have fewer, a process "
                        "forges addresses"});
  }
  for (const std::string& text : observations.not_observed) {
    findings.push_back({Severity::warning, "bus", text,
                        "end those that you do not need; if you have fewer, a "
                        "process forges them"});
  }
}

}  // namespace sonopose::doctor::rules
