#include "evaluation/state/state_file.hpp"

#include "evaluation/state/state_reader.hpp"
#include "files/error.hpp"
#include "files/input_file.hpp"
#include "files/replacement.hpp"
#include <sonopose/estimation/snapshot_fields.hpp>

#include <cmath>
#include <type_traits>

namespace sonopose::evaluation {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view format_name = "sonopose estimator state";
constexpr int format_version = 18;

double finite(const char* name, double value) {
  if (std::isfinite(value)) return value;
  throw StateFileError(std::string(name) + ": is not finite and cannot be saved");
}

OrderedJson json_of(const char* name, const Vector3d& value) {
  return {finite(name, value.x()), finite(name, value.y()), finite(name, value.z())};
}

/// Writes a state's fields of every type into an object.
struct FieldWriter {
  OrderedJson& object;

  void operator()(const char* name, double value) const { object[name] = finite(name, value); }
  void operator()(const char* name, bool value) const { object[name] = value; }
  void operator()(const char* name, int value) const { object[name] = value; }
  void operator()(const char* name, TimeNs value) const { object[name] = value; }
  template <class Choice>
  requires std::is_enum_v<Choice>
  void operator()(const char* name, Choice value) const {
    object[name] = choices_of(value).at(static_cast<std::size_t>(value));
  }
  void operator()(const char* name, const Vector3d& value) const { object[name] = json_of(name, value); }
  void operator()(const char* name, const Quaterniond& q) const {
    object[name] = {finite(name, q.w()), finite(name, q.x()), finite(name, q.y()), finite(name, q.z())};
  }
  template <int size>
  void operator()(const char* name, const Eigen::Matrix<double, size, size>& value) const {
    object[name] = OrderedJson::array();
    for (const auto& row : value.rowwise()) {
      OrderedJson& numbers = object[name].emplace_back(OrderedJson::array());
      for (const double number : row) numbers.push_back(finite(name, number));
    }
  }
  void operator()(const char* name, attitude::AnyFilter filter) const {
    OrderedJson& fields = object[name];
    fields["kind"] = choices_of(filter.kind()).at(static_cast<std::size_t>(filter.kind()));
    filter.for_each_field(FieldWriter{fields});
  }
  template <class Record>
  requires requires(const Record& record) {
    for_each_field(record, [](const char*, const auto&) {});
  }
  void operator()(const char* name, const Record& record) const {
    for_each_field(record, FieldWriter{object[name]});
  }
  template <class Sequence>
  requires std::is_class_v<typename Sequence::value_type>
  void operator()(const char* name, const Sequence& records) const {
    object[name] = OrderedJson::array();
    for (std::size_t i = 0; i < records.size(); ++i) {
      for_each_field(records[i], FieldWriter{object[name].emplace_back()});
    }
  }
};

void check_format(StateReader& file) {
  if (const auto format = file.text("format"); format != format_name) {
    file.fail("format", "is \"" + format + "\" instead of \"" + std::string(format_name) + "\"");
  }
  if (const auto version = file.count("version"); version != format_version) {
    file.fail("version", "is " + std::to_string(version) + ", this program reads version " +
                             std::to_string(format_version));
  }
}

}  // namespace

std::string state_text(const SavedState& saved) {
  const settings::EngineKind kind = estimation::kind_of(saved.snapshot);
  OrderedJson file;
  file["format"] = format_name;
  file["version"] = format_version;
  file["sequence"] = saved.sequence;
  file["beacon"] = saved.beacon;
  file["first_event_ns"] = saved.first_event_ns;
  file["last_event"] = saved.last_event;
  file["estimator"] = choices_of(kind).at(static_cast<std::size_t>(kind));
  file["reset_counter"] = estimation::reset_counter_of(saved.snapshot);
  for_each_counter(estimation::counters_of(saved.snapshot),
                   [&file](const char* name, std::uint64_t value) { file["counters"][name] = value; });
  estimation::for_each_field(saved.snapshot, FieldWriter{file["state"]});
  return file.dump(1) + "\n";
}

SavedState parse_state(std::string_view text, const std::string& name) {
  StateReader file = StateReader::parsed(text, name);
  check_format(file);
  SavedState saved;
  saved.sequence = file.count("sequence");
  const std::uint64_t beacon = file.count("beacon");
  saved.beacon = static_cast<BeaconAddress>(beacon);
  if (saved.beacon != beacon) file.fail("beacon", "is " + std::to_string(beacon) + ", which is no address");
  file.read("first_event_ns", saved.first_event_ns);
  saved.last_event = file.count("last_event");
  settings::EngineKind kind{};
  file.read("estimator", kind);
  saved.snapshot = estimation::initial_snapshot(kind);
  estimation::reset_counter_of(saved.snapshot) = file.count32("reset_counter");
  StateReader counters = file.object("counters");
  for_each_counter(estimation::counters_of(saved.snapshot),
                   [&counters](const char* field, std::uint64_t& value) { value = counters.count(field); });
  counters.finish();
  StateReader state = file.object("state");
  estimation::for_each_field(saved.snapshot,
                             [&state](const char* field, auto& value) { state.read(field, value); });
  if (const auto fault = estimation::find_fault(saved.snapshot)) {
    state.fail(std::string(fault->field), std::string(fault->fault));
  }
  state.finish();
  file.finish();
  return saved;
}

void save_state(const std::filesystem::path& file, const SavedState& saved) {
  std::string text;
  try {
    text = state_text(saved);
  } catch (const StateFileError& error) {
    throw StateFileError(file.string() + ": " + error.what());
  }
  files::write_whole(file, text);
}

SavedState load_state(const std::filesystem::path& file) {
  return parse_state(files::read_text(file), file.string());
}

void check_fits(const SavedState& saved, const recording::SensorLog& log, const std::string& name) {
  if (log.events.empty()) return;
  const auto differs = [&name](const std::string& field, auto stored, auto own) {
    throw StateFileError(name + ": " + field + ": is " + std::to_string(stored) +
                         ", but the recording's is " + std::to_string(own) +
                         ": it comes from another recording");
  };
  const Event& first = log.events.front();
  if (saved.beacon != address_of(first)) differs("beacon", saved.beacon, address_of(first));
  if (saved.first_event_ns != available_at_ns(first)) {
    differs("first_event_ns", saved.first_event_ns, available_at_ns(first));
  }
  for (const Event& event : log.events) {
    if (sequence_of(event) != saved.sequence) continue;
    if (digest_of(event) != saved.last_event) differs("last_event", saved.last_event, digest_of(event));
  }
}

}  // namespace sonopose::evaluation
