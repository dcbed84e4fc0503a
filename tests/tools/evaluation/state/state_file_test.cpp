#include "evaluation/state/state_file.hpp"

#include "evaluation/sample_log.hpp"
#include "files/error.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <limits>
#include <utility>

namespace state_file_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
using nlohmann::json;

/// A state in which every group has changed.
evaluation::SavedState busy_state(settings::EngineKind engine = settings::EngineKind::documented) {
  evaluation::RunOptions options;
  options.settings.engine.engine = engine;
  options.until_s = 14.0;
  return evaluation::run(sample_log("outlier_bursts"), options).end;
}

/// Error message after `change` of the file.
template <class Change>
std::string error_message_after(const Change& change) {
  json file = json::parse(evaluation::state_text(busy_state()));
  change(file);
  try {
    evaluation::parse_state(file.dump(), "s.json");
  } catch (const evaluation::StateFileError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST_CASE("a state comes back from its file to the last bit") {
  const TemporaryFolder folder;
  const auto engine = GENERATE(settings::EngineKind::documented, settings::EngineKind::kalman);
  const evaluation::SavedState saved = busy_state(engine);
  evaluation::save_state(folder / "state.json", saved);
  CHECK(evaluation::load_state(folder / "state.json") == saved);
  evaluation::save_state(folder / "state.json", {});  // replaces the file
  CHECK(evaluation::load_state(folder / "state.json") == evaluation::SavedState{});
}

TEST_CASE("a run that continues from a file ends like the whole run") {
  const TemporaryFolder folder;
  const auto [engine, scenario] = GENERATE(std::pair{settings::EngineKind::documented, "outages"},
                                           std::pair{settings::EngineKind::kalman, "no_heading"});
  const recording::SensorLog log = sample_log(scenario);
  evaluation::RunOptions options;
  options.settings.engine.engine = engine;
  const auto whole = evaluation::run(log, options);
  for (const double until_s : {0.03, 1.0, 4.62, 5.01, 7.7, 7.73, 7.77}) {
    CAPTURE(until_s);
    evaluation::RunOptions first = options;
    first.until_s = until_s;
    evaluation::save_state(folder / "state.json", evaluation::run(log, first).end);
    evaluation::RunOptions second = options;
    second.start = evaluation::load_state(folder / "state.json");
    const auto rest = evaluation::run(log, second);
    CHECK(rest.end == whole.end);
    CHECK(rest.fused.position_m.max <= whole.fused.position_m.max);
  }
}

TEST_CASE("a state does not continue another engine, nor strapdown integration") {
  const recording::SensorLog log = sample_log("walk", 4.0);
  evaluation::RunOptions options;
  options.settings.engine.engine = settings::EngineKind::kalman;
  options.start = evaluation::run(log, options).end;
  options.settings.engine.engine = settings::EngineKind::documented;
  CHECK_THROWS_WITH(evaluation::run(log, options), Contains("another kind"));
  options.settings.engine.engine = settings::EngineKind::kalman;
  options.strapdown = evaluation::strapdown::Rule::previous;
  CHECK_THROWS_WITH(evaluation::run(log, options), Contains("another kind"));
}

TEST_CASE("a state fits the recording of its run, and no other") {
  const recording::SensorLog log = sample_log("walk", 2.0);
  const evaluation::SavedState saved = evaluation::run(log, {.until_s = 1.0}).end;
  CHECK_NOTHROW(evaluation::check_fits(saved, log, "s.json"));
  recording::SensorLog another = log;
  std::visit([](auto& sample) { sample.address = 9; }, another.events.front());
  CHECK_THROWS_WITH(evaluation::check_fits(saved, another, "s.json"),
                    Contains("s.json: beacon: is " + std::to_string(saved.beacon)) && Contains("is 9"));
  another = log;
  std::get<ImuSample>(another.events.front()).sensor_time_ns = 5;
  CHECK_THROWS_WITH(
      evaluation::check_fits(saved, another, "s.json"),
      Contains("s.json: first_event_ns: is " + std::to_string(saved.first_event_ns)) && Contains("is 5"));
}

TEST_CASE("a state fits no other recording that begins at the same time") {
  const evaluation::SavedState saved = evaluation::run(sample_log("walk", 6.0), {.until_s = 5.0}).end;
  CHECK_THROWS_WITH(evaluation::check_fits(saved, sample_log("kart", 6.0), "s.json"),
                    Contains("s.json: last_event: is ") && Contains("it comes from another recording"));
}

TEST_CASE("numbers that are hard to write come back as they were") {
  evaluation::SavedState saved;
  auto& state = std::get<estimation::documented::Snapshot>(saved.snapshot).state;
  state.body.position_world_m = {-0.0, 5e-324, -999999999999.99988};
  state.body.velocity_world_mps = {0.1, 1.0 / 3.0, 1e12};
  state.body.time_ns = std::numeric_limits<TimeNs>::min();
  std::get<estimation::documented::Snapshot>(saved.snapshot).counters.imu_samples =
      std::numeric_limits<std::uint64_t>::max();
  const auto read = evaluation::parse_state(evaluation::state_text(saved), "s");
  CHECK(read == saved);
  CHECK(std::signbit(
      std::get<estimation::documented::Snapshot>(read.snapshot).state.body.position_world_m.x()));
}

TEST_CASE("a number that is not finite is not saved") {
  evaluation::SavedState saved;
  auto& state = std::get<estimation::documented::Snapshot>(saved.snapshot).state;
  state.drift.weight = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH(evaluation::state_text(saved), Contains("drift.weight") && Contains("not finite"));
}

TEST_CASE("a file that is no saved state is refused with file and field") {
  CHECK(error_message_after([](json&) {}) == "no complaint");
  CHECK_THAT(error_message_after([](json& file) { file["format"] = "something"; }),
             Contains("s.json: format: is \"something\""));
  CHECK_THAT(error_message_after([](json& file) { file["version"] = 99; }),
             Contains("s.json: version: is 99, this program reads version"));
  CHECK_THAT(error_message_after([](json& file) { file["estimator"] = "guess"; }),
             Contains("s.json: estimator: is \"guess\" instead of documented or kalman"));
  CHECK_THAT(error_message_after([](json& file) { file.erase("sequence"); }),
             Contains("sequence: is missing"));
  CHECK_THAT(error_message_after([](json& file) { file["colour"] = 1; }),
             Contains("s.json: colour: is not known"));
  CHECK_THAT(error_message_after([](json& file) { file["counters"]["x"] = 1; }),
             Contains("s.json: counters: x: is not known"));
  CHECK_THAT(error_message_after([](json& file) { file["counters"] = 3; }),
             Contains("is 3 instead of an object"));
  CHECK_THROWS_WITH(evaluation::parse_state("{\"format\": ", "s.json"),
                    Contains("s.json: is not JSON: parse error at line 1"));
  CHECK_THROWS_WITH(evaluation::parse_state("[]", "s.json"), Contains("instead of an object"));
  CHECK_THROWS_AS(evaluation::load_state("/nowhere/s.json"), files::IoError);
  CHECK_THROWS_WITH(evaluation::load_state("/"), Contains("/: is a folder, not a file"));
}

TEST_CASE("a field that is missing, unknown, of the wrong kind or impossible is named") {
  const auto state = [](const char* field, const json& value) {
    return error_message_after([&](json& file) { file["state"][field] = value; });
  };
  CHECK_THAT(error_message_after([](json& file) { file["state"].erase("trust.trust"); }),
             Contains("s.json: state: trust.trust: is missing"));
  CHECK_THAT(state("trust.unheard_of", 1.0), Contains("trust.unheard_of: is not known"));
  CHECK_THAT(state("trust.trust", "much"), Contains("trust.trust: is \"much\" instead of a number"));
  CHECK_THAT(state("trust.trust", 1.5), Contains("trust.trust: is not between 0 and 1"));
  CHECK_THAT(state("trust.trust", -0.1), Contains("trust.trust: is not between 0 and 1"));
  CHECK_THAT(error_message_after([](json& file) { file["beacon"] = 70'000; }),
             Contains("s.json: beacon: is 70000, which is no address"));
  CHECK_THAT(state("trust.forced", 1), Contains("trust.forced: is 1 instead of true or false"));
  CHECK_THAT(state("trust.rebuild_n", -1), Contains("trust.rebuild_n: is -1 instead of a count"));
  CHECK_THAT(state("trust.rebuild_n", 5'000'000'000), Contains("instead of a count below 2^31"));
  CHECK_THAT(state("body.time_ns", 1.5), Contains("body.time_ns: is 1.5 instead of a time"));
  CHECK_THAT(state("body.time_ns", 18'000'000'000'000'000'000U), Contains("body.time_ns"));
  CHECK_THAT(state("body.position_world_m", {1, 2}),
             Contains("body.position_world_m: is [1,2] instead of three"));
  CHECK_THAT(state("body.velocity_world_mps", {0, 0, 1e300}),
             Contains("body.velocity_world_mps: is beyond 1e12"));
  CHECK_THAT(state("outage.init_phase", "lost"),
             Contains("outage.init_phase") && Contains("no_position or no_velocity or tracking"));
  CHECK_THAT(state("velocity.count", 9), Contains("velocity.count: is more than the number"));
  CHECK_THAT(state("velocity.fixes", json::array()), Contains("velocity.fixes: has 0 elements instead of 8"));
  CHECK_THAT(error_message_after([](json& file) {
               file["state"]["velocity.fixes"].push_back(file["state"]["velocity.fixes"][0]);
             }),
             Contains("velocity.fixes: has 9 elements instead of 8"));
  CHECK_THAT(error_message_after([](json& file) { file["state"]["filter"]["force_age_s"] = -1e-9; }),
             Contains("filter: force_age_s") && Contains("negative"));
  CHECK_THAT(error_message_after([](json& file) { file["state"]["filter"]["bias.span_s"] = 1e10; }),
             Contains("filter: bias.span_s") && Contains("1e9"));
  CHECK_THAT(error_message_after([](json& file) { file["state"]["filter"]["kind"] = "kalman"; }),
             Contains("filter: kind") && Contains("kalman"));
  CHECK_THAT(error_message_after([](json& file) {
               file["state"]["filter"]["q_body_to_world"] = {1, 1, 0, 0};
             }),
             Contains("filter: q_body_to_world") && Contains("a unit quaternion"));
  CHECK_THAT(error_message_after([](json& file) {
               auto& points = file["state"]["body.history"];
               std::swap(points.front(), points.back());
             }),
             Contains("body.history: has times that go backward"));
}

}  // namespace state_file_test
