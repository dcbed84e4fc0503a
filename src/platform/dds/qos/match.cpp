#include <sonopose/dds/qos/match.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <fnmatch.h>
#include <utility>

namespace sonopose::dds::qos {
namespace {

constexpr const char* no_less = "a reader must not request less than is offered";
constexpr const char* no_more = "a reader must not request more than is offered";
constexpr const char* the_same = "both endpoints must have the same value";

/// The names of an enumeration, in numerical order.
template <std::size_t N>
using Names = std::array<const char*, N>;

constexpr Names<2> reliability_names{"best effort", "reliable"};
constexpr Names<4> durability_names{"volatile", "transient local", "transient", "persistent"};
constexpr Names<3> liveliness_names{"automatic", "manual by participant", "manual by topic"};
constexpr Names<2> ownership_names{"shared", "exclusive"};
constexpr Names<2> order_names{"by reception", "by source"};
constexpr Names<3> scope_names{"instance", "topic", "group"};
constexpr Names<2> switch_names{"no", "yes"};

class Comparison {
public:
  Comparison(const Qos& writer, const Qos& reader) : writer_(writer.get()), reader_(reader.get()) {}

  std::vector<Mismatch> result() && { return std::move(found_); }

  void reliability() {
    const auto kind = [](const dds_qos_t* qos, dds_reliability_kind_t otherwise) {
      dds_duration_t blocking = 0;
      dds_qget_reliability(qos, &otherwise, &blocking);
      return otherwise;
    };
    at_most({DDS_RELIABILITY_QOS_POLICY_ID, "reliability"}, reliability_names,
            kind(writer_, DDS_RELIABILITY_RELIABLE), kind(reader_, DDS_RELIABILITY_BEST_EFFORT));
  }

  void durability() {
    const auto kind = [](const dds_qos_t* qos) {
      dds_durability_kind_t value = DDS_DURABILITY_VOLATILE;
      dds_qget_durability(qos, &value);
      return value;
    };
    at_most({DDS_DURABILITY_QOS_POLICY_ID, "durability"}, durability_names, kind(writer_), kind(reader_));
  }

  void deadline() {
    at_least({DDS_DEADLINE_QOS_POLICY_ID, "deadline"}, duration(writer_, dds_qget_deadline, DDS_INFINITY),
             duration(reader_, dds_qget_deadline, DDS_INFINITY));
  }

  void latency_budget() {
    at_least({DDS_LATENCYBUDGET_QOS_POLICY_ID, "latency budget"},
             duration(writer_, dds_qget_latency_budget, 0), duration(reader_, dds_qget_latency_budget, 0));
  }

  void liveliness() {
    const auto value = [](const dds_qos_t* qos) {
      std::pair<dds_liveliness_kind_t, dds_duration_t> read{DDS_LIVELINESS_AUTOMATIC, DDS_INFINITY};
      dds_qget_liveliness(qos, &read.first, &read.second);
      return read;
    };
    const auto [offered, offered_lease] = value(writer_);
    const auto [requested, requested_lease] = value(reader_);
    at_most({DDS_LIVELINESS_QOS_POLICY_ID, "liveliness"}, liveliness_names, offered, requested);
    at_least({DDS_LIVELINESS_QOS_POLICY_ID, "liveliness lease"}, offered_lease, requested_lease);
  }

  void ownership() {
    const auto kind = [](const dds_qos_t* qos) {
      dds_ownership_kind_t value = DDS_OWNERSHIP_SHARED;
      dds_qget_ownership(qos, &value);
      return value;
    };
    const auto offered = kind(writer_);
    const auto requested = kind(reader_);
    if (offered == requested) return;
    add({DDS_OWNERSHIP_QOS_POLICY_ID, "ownership"}, ownership_names.at(offered),
        ownership_names.at(requested), the_same);
  }

  void destination_order() {
    const auto kind = [](const dds_qos_t* qos) {
      dds_destination_order_kind_t value = DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP;
      dds_qget_destination_order(qos, &value);
      return value;
    };
    at_most({DDS_DESTINATIONORDER_QOS_POLICY_ID, "destination order"}, order_names, kind(writer_),
            kind(reader_));
  }

  void presentation() {
    struct Presentation {
      dds_presentation_access_scope_kind_t scope = DDS_PRESENTATION_INSTANCE;
      bool coherent = false;
      bool ordered = false;
    };
    const auto value = [](const dds_qos_t* qos) {
      Presentation read;
      dds_qget_presentation(qos, &read.scope, &read.coherent, &read.ordered);
      return read;
    };
    const Presentation offered = value(writer_);
    const Presentation requested = value(reader_);
    constexpr std::uint32_t id = DDS_PRESENTATION_QOS_POLICY_ID;
    at_most({id, "presentation scope"}, scope_names, offered.scope, requested.scope);
    at_most({id, "coherent access"}, switch_names, offered.coherent, requested.coherent);
    at_most({id, "ordered access"}, switch_names, offered.ordered, requested.ordered);
  }

  void partition();
  void data_representation();

private:
  struct Subject {
    std::uint32_t id;
    const char* name;
  };

  static dds_duration_t duration(const dds_qos_t* qos, bool (*get)(const dds_qos_t*, dds_duration_t*),
                                 dds_duration_t otherwise) {
    get(qos, &otherwise);
    return otherwise;
  }

  void add(const Subject& subject, std::string offered, std::string requested, const char* rule) {
    found_.push_back({subject.id, subject.name, std::move(offered), std::move(requested), rule});
  }

  template <std::size_t N, class Kind>
  void at_most(const Subject& subject, const Names<N>& names, Kind offered, Kind requested) {
    if (requested <= offered) return;
    add(subject, names.at(static_cast<std::size_t>(offered)), names.at(static_cast<std::size_t>(requested)),
        no_more);
  }

  void at_least(const Subject& subject, dds_duration_t offered, dds_duration_t requested) {
    if (requested >= offered) return;
    add(subject, text_of(std::chrono::nanoseconds(offered)), text_of(std::chrono::nanoseconds(requested)),
        no_less);
  }

  const dds_qos_t* writer_;
  const dds_qos_t* reader_;
  std::vector<Mismatch> found_;
};

bool is_pattern(const std::string& name) {
  return name.find_first_of("*?") != std::string::npos;
}

/// A pattern matches names, never another pattern.
bool meet(const std::string& a, const std::string& b) {
  if (is_pattern(a) == is_pattern(b)) return !is_pattern(a) && a == b;
  return is_pattern(a) ? fnmatch(a.c_str(), b.c_str(), 0) == 0 : fnmatch(b.c_str(), a.c_str(), 0) == 0;
}

std::vector<std::string> partitions_of(const dds_qos_t* qos) {
  policy::Partition partition;  // by default, of the name ""
  core::detail::read(partition, qos);
  return partition.name().empty() ? core::StringSeq{""} : partition.name();
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

void Comparison::partition() {
  const auto offered = partitions_of(writer_);
  const auto requested = partitions_of(reader_);
  for (const std::string& a : offered) {
    if (std::any_of(requested.begin(), requested.end(), [&a](const auto& b) { return meet(a, b); })) return;
  }
  add({DDS_PARTITION_QOS_POLICY_ID, "partition"}, listed(offered), listed(requested),
      "the endpoints must share one");
}

/// Returns empty if the QoS leaves the representation to the type.
std::vector<dds_data_representation_id_t> representations_of(const dds_qos_t* qos) {
  std::uint32_t count = 0;
  dds_data_representation_id_t* values = nullptr;
  if (!dds_qget_data_representation(qos, &count, &values)) return {};
  std::vector<dds_data_representation_id_t> result(values, values + count);
  dds_free(values);
  return result;
}

std::string representation_names(const std::vector<dds_data_representation_id_t>& values) {
  constexpr Names<3> names{"XCDR1", "XML", "XCDR2"};
  std::string text;
  for (const auto value : values) {
    const auto index = static_cast<std::size_t>(value);
    text += (text.empty() ? "" : ", ") +
            (value >= 0 && index < names.size() ? std::string(names.at(index)) : std::to_string(value));
  }
  return text;
}

void Comparison::data_representation() {
  const auto offered = representations_of(writer_);
  const auto requested = representations_of(reader_);
  // A writer sends the first representation that it offers.
  if (offered.empty() || requested.empty() ||
      std::find(requested.begin(), requested.end(), offered.front()) != requested.end()) {
    return;
  }
  add({DDS_DATA_REPRESENTATION_QOS_POLICY_ID, "data representation"}, representation_names(offered),
      representation_names(requested), "the reader must accept what the writer sends");
}

}  // namespace

std::vector<Mismatch> mismatches(const Qos& writer, const Qos& reader) {
  Comparison comparison(writer, reader);
  comparison.reliability();
  comparison.durability();
  comparison.presentation();
  comparison.deadline();
  comparison.latency_budget();
  comparison.ownership();
  comparison.liveliness();
  comparison.destination_order();
  comparison.partition();
  comparison.data_representation();
  return std::move(comparison).result();
}

std::string text_of(const Mismatch& mismatch) {
  return mismatch.policy + ": offered " + mismatch.offered + ", requested " + mismatch.requested + ": " +
         mismatch.rule;
}

std::string text_of(std::chrono::nanoseconds duration) {
  if (duration == std::chrono::nanoseconds::max()) return "infinite";
  if (duration == std::chrono::nanoseconds::zero()) return "0";
  struct Unit {
    std::int64_t ns;
    const char* name;
  };
  constexpr std::array units{Unit{1'000'000'000, " s"}, Unit{1'000'000, " ms"}, Unit{1'000, " µs"},
                             Unit{1, " ns"}};
  const auto* const unit = std::find_if(units.begin(), units.end() - 1, [&](const Unit& candidate) {
    return duration.count() >= candidate.ns;
  });
  std::array<char, 40> digits{};
  const double value = static_cast<double>(duration.count()) / static_cast<double>(unit->ns);
  const auto end = std::to_chars(digits.begin(), digits.end(), value, std::chars_format::general, 12).ptr;
  return std::string(digits.begin(), end) + unit->name;
}

}  // namespace sonopose::dds::qos
