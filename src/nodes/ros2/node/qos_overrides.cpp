#include <sonopose/ros2/node/qos_overrides.hpp>

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace sonopose::ros2 {
namespace {

namespace policy = dds::policy;

[[noreturn]] void refuse(const std::string& policy, const std::string& value, const char* known) {
  throw std::invalid_argument(fmt::format("{} is '{}': it must be {}", policy, value, known));
}

std::int64_t number_of(const std::string& policy, const std::string& value, std::int64_t most,
                       const char* known) {
  std::int64_t number = 0;
  const auto [rest, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || rest != value.data() + value.size() || number < 1 || number > most) {
    refuse(policy, value, known);
  }
  return number;
}

dds::core::Duration duration_of(const std::string& policy, const std::string& value) {
  return dds::ext::to_duration(std::chrono::nanoseconds(number_of(
      policy, value, std::numeric_limits<std::int64_t>::max(), "a positive number of nanoseconds")));
}

}  // namespace

QosOverrides::Change QosOverrides::change_of(const std::string& policy, const std::string& value) {
  if (value == "system_default") return [](dds::Qos&) {};
  if (policy == "reliability") {
    if (value == "reliable") return [](dds::Qos& qos) { qos << policy::Reliability::Reliable(); };
    if (value == "best_effort") return [](dds::Qos& qos) { qos << policy::Reliability::BestEffort(); };
    refuse(policy, value, "reliable, best_effort or system_default");
  }
  if (policy == "durability") {
    if (value != "volatile" && value != "transient_local") {
      refuse(policy, value, "volatile, transient_local or system_default");
    }
    const auto kind =
        value == "volatile" ? policy::DurabilityKind::VOLATILE : policy::DurabilityKind::TRANSIENT_LOCAL;
    return [kind](dds::Qos& qos) { qos << policy::Durability(kind); };
  }
  if (policy == "history") {
    if (value != "keep_last" && value != "keep_all") {
      refuse(policy, value, "keep_last, keep_all or system_default");
    }
    const auto kind = value == "keep_all" ? policy::HistoryKind::KEEP_ALL : policy::HistoryKind::KEEP_LAST;
    return [kind](dds::Qos& qos) { qos << qos.policy_or_default<policy::History>().kind(kind); };
  }
  if (policy == "depth") {
    constexpr std::int64_t max_depth = 1'000'000;
    const auto depth =
        static_cast<std::int32_t>(number_of(policy, value, max_depth, "a number from 1 to 1000000"));
    return [depth](dds::Qos& qos) { qos << qos.policy_or_default<policy::History>().depth(depth); };
  }
  if (policy == "deadline") {
    return [period = duration_of(policy, value)](dds::Qos& qos) { qos << policy::Deadline(period); };
  }
  if (policy == "lifespan") {
    return [duration = duration_of(policy, value)](dds::Qos& qos) { qos << policy::Lifespan(duration); };
  }
  if (policy == "liveliness") {
    if (value != "automatic" && value != "manual_by_topic") {
      refuse(policy, value, "automatic, manual_by_topic or system_default");
    }
    const auto kind =
        value == "automatic" ? policy::LivelinessKind::AUTOMATIC : policy::LivelinessKind::MANUAL_BY_TOPIC;
    return [kind](dds::Qos& qos) { qos << qos.policy_or_default<policy::Liveliness>().kind(kind); };
  }
  if (policy == "liveliness_lease_duration") {
    return [lease = duration_of(policy, value)](dds::Qos& qos) {
      qos << qos.policy_or_default<policy::Liveliness>().lease_duration(lease);
    };
  }
  throw std::invalid_argument(fmt::format(
      "'{}' is not one of the policies reliability, durability, history, depth, deadline, lifespan, "
      "liveliness and liveliness_lease_duration",
      policy));
}

bool QosOverrides::add(const std::string& parameter, const std::string& value) {
  constexpr std::string_view prefix = "qos_overrides.";
  if (!parameter.starts_with(prefix)) return false;
  const std::size_t policy_at = parameter.rfind('.');
  const std::size_t endpoint_at = parameter.rfind('.', policy_at - 1);
  if (endpoint_at < prefix.size())
    throw std::invalid_argument("it must be qos_overrides.TOPIC.publisher.POLICY");
  const std::string topic = parameter.substr(prefix.size(), endpoint_at - prefix.size());
  const std::string endpoint = parameter.substr(endpoint_at + 1, policy_at - endpoint_at - 1);
  if (!topic.starts_with('/')) {
    throw std::invalid_argument(fmt::format("'{}' is not the whole name of a topic, as /odom", topic));
  }
  if (endpoint != "publisher" && endpoint != "subscription") {
    throw std::invalid_argument(fmt::format("'{}' is neither publisher nor subscription", endpoint));
  }
  const std::string policy = parameter.substr(policy_at + 1);
  const auto kind = endpoint == "publisher" ? Endpoint::publisher : Endpoint::subscription;
  changes_[{topic, kind}][policy] = change_of(policy, value);
  return true;
}

void QosOverrides::apply(const std::string& topic, Endpoint endpoint, dds::Qos& qos) const {
  const auto found = changes_.find({topic, endpoint});
  if (found == changes_.end()) return;
  for (const auto& [policy, change] : found->second) change(qos);
}

}  // namespace sonopose::ros2
