// Parses a saved state of an estimator. An accepted one is restored, and the estimator continues with events.
//
// Byte 0 selects a real state whose fields the following bytes change. 0xFF: the rest is the file's text.
// "=": the next character selects a real state, and the lines change its fields by name.

#include "evaluation/state/state_file.hpp"

#include "fused_events.hpp"
#include "support.hpp"
#include <sonopose/estimation/any_estimator.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;
using estimation::AnyEstimator;
using evaluation::SavedState;
using evaluation::StateFileError;
using nlohmann::json;

namespace {

constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
constexpr BeaconAddress address = 7;

/// A real state, and the places of its values.
struct Base {  // NOLINT(bugprone-exception-escape): of nlohmann's JSON
  json file;
  std::vector<json::json_pointer> leaves;
  std::vector<json::json_pointer> named;  ///< values outside of arrays
};

void add_leaves(const json& node, const json::json_pointer& at, std::vector<json::json_pointer>& leaves) {
  if (!node.is_structured()) {
    leaves.push_back(at);
    return;
  }
  for (const auto& [key, value] : node.items()) {
    add_leaves(value, node.is_array() ? at / std::stoul(key) : at / key, leaves);
  }
}

bool is_in_array(const json::json_pointer& leaf) {
  static const std::regex index("/[0-9]");
  return std::regex_search(leaf.to_string(), index);
}

Base base_after(settings::EngineKind engine, int events) {
  const std::vector<std::uint8_t> runs(64, 0xFF);  // only plausible events
  FuzzedDataProvider data(runs.data(), runs.size());
  settings::Settings settings;
  settings.engine.engine = engine;
  AnyEstimator estimator(settings);
  EventStream stream(data, start_ns, address);
  for (int i = 0; i < events; ++i) estimation::process(estimator, stream.next());
  Base base;
  base.file = json::parse(evaluation::state_text(
      {.snapshot = estimator.snapshot(), .sequence = 1, .beacon = address, .first_event_ns = start_ns}));
  add_leaves(base.file, json::json_pointer(), base.leaves);
  std::copy_if(base.leaves.begin(), base.leaves.end(), std::back_inserter(base.named),
               [](const json::json_pointer& leaf) { return !is_in_array(leaf); });
  return base;
}

const std::vector<Base>& bases() {
  using settings::EngineKind;
  static const std::vector<Base> all{base_after(EngineKind::kalman, 12), base_after(EngineKind::kalman, 150),
                                     base_after(EngineKind::kalman, 250),
                                     base_after(EngineKind::documented, 12),
                                     base_after(EngineKind::documented, 300)};
  return all;
}

/// Changes the structure around the value at `place`.
void change_structure(json& file, const json::json_pointer& place, bool removes) {
  json& parent = file[place.parent_pointer()];
  if (parent.empty()) return;
  if (parent.is_array()) {
    if (removes) {
      parent.erase(parent.size() - 1);
    } else {
      parent.push_back(parent.back());
    }
  } else if (removes) {
    parent.erase(place.back());
  } else {
    parent["other"] = 0;
  }
}

/// Returns a file with some changed values.
std::string changed(const Base& base, FuzzedDataProvider& data) {
  json file = base.file;
  const int changes = data.ConsumeIntegralInRange(0, 3);
  for (int i = 0; i < changes; ++i) {
    const auto& places = data.ConsumeBool() ? base.named : base.leaves;
    const json::json_pointer& place = places[data.ConsumeIntegralInRange<std::size_t>(0, places.size() - 1)];
    json& value = file[place];
    switch (data.ConsumeIntegralInRange(0, 12)) {
      case 0:
        value = data.ConsumeFloatingPoint<double>();
        break;
      case 1:
        value = data.ConsumeIntegral<std::int64_t>();
        break;
      case 2:
        value = data.ConsumeBool();
        break;
      case 3:
        value = nullptr;
        break;
      case 4:
        if (value.is_number()) value = value.get<double>() * data.ConsumeFloatingPointInRange(-1e3, 1e3);
        break;
      case 5:
        if (value.is_number_integer())
          value = value.get<std::int64_t>() / 2 + data.ConsumeIntegral<std::int32_t>();
        break;
      case 6:
        value = data.ConsumeIntegralInRange(-1, 30);
        break;
      case 7:
        value = "other";
        break;
      case 8:
        value = json::object();
        break;
      case 9:
        value = json::array({0, 0, 0});
        break;
      case 10:
        change_structure(file, place, true);
        break;
      case 11:
        change_structure(file, place, false);
        break;
      default:
        value = 0;
    }
  }
  return file.dump();
}

/// Returns a real state changed by lines such as "/state/trust 2"; one without a value removes the field.
std::string assigned(std::string_view lines) {
  if (lines.empty()) return {};
  json file = bases()[static_cast<unsigned char>(lines.front()) % bases().size()].file;
  lines.remove_prefix(1);
  try {
    while (!lines.empty()) {
      const std::string_view line = lines.substr(0, lines.find('\n'));
      lines.remove_prefix(std::min(line.size() + 1, lines.size()));
      const std::size_t space = std::min(line.find(' '), line.size());
      const json::json_pointer place{std::string(line.substr(0, space))};
      if (place.empty()) continue;
      const json value = json::parse(line.substr(space), nullptr, false);
      if (value.is_discarded()) {
        file.at(place.parent_pointer()).erase(place.back());
      } else {
        file[place] = value;
      }
    }
    return file.dump();
  } catch (const json::exception&) {
    return {};  // no such field, or invalid UTF-8
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  FuzzedDataProvider data(bytes + 1, size - 1);
  std::string text;
  if (bytes[0] == 0xFF) {
    text = data.ConsumeRemainingBytesAsString();
  } else if (bytes[0] == '=') {
    text = assigned(data.ConsumeRemainingBytesAsString());
  } else {
    text = changed(bases()[bytes[0] % bases().size()], data);
  }
  SavedState saved;
  if (!accepts<StateFileError>([&] { saved = evaluation::parse_state(text, "input"); })) return 0;
  promise(evaluation::parse_state(evaluation::state_text(saved), "again") == saved,
          "an accepted state is saved as it was read");
  AnyEstimator estimator(settings::Settings{});
  estimator.restore(saved.snapshot);
  EventStream stream(data, estimator.time_ns() > 0 ? estimator.time_ns() : start_ns, address);
  constexpr int max_events = 100;
  for (int i = 0; i < max_events && stream.has_more(); ++i) {
    check_result(estimation::process(estimator, stream.next()));
  }
  return 0;
}
