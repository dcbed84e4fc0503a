/// Output of sonopose-settings.

#include "settings_client/settings_report.hpp"

#include "config/fusion_config.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/settings/preset.hpp>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace settings_report_test {

using namespace sonopose;
using namespace sonopose::settings_client;
using Catch::Contains;

EffectiveSettings some() {
  return {7,
          1234,
          12,
          {{"documented.imu_weight", "medium"},
           {"documented.drift.jump_alpha", "0.30000000000000004"},
           {"documented.drift.decay_rate_hz", "1e-05"},
           {"documented.trust.enabled", "true"},
           {"documented.trust.n_base", "3"}}};
}

std::vector<std::string> keys_of(const EffectiveSettings& settings) {
  std::vector<std::string> keys;
  for (const auto& entry : settings.values) keys.push_back(entry.key);
  return keys;
}

config::FusionConfig loaded(const std::string& text) {
  const auto file =
      std::filesystem::temp_directory_path() / ("sonopose_report_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text;
  auto config = config::FusionConfig::load(file);
  std::filesystem::remove(file);
  return config;
}

TEST_CASE("KEY=VALUE is parsed with any value; other forms are rejected") {
  CHECK(parse_assignment("documented.drift.jump_alpha=0.5") ==
        SettingAssignment{"documented.drift.jump_alpha", "0.5"});
  CHECK(parse_assignment("a=b=c") == SettingAssignment{"a", "b=c"});
  CHECK(parse_assignment("a=") == SettingAssignment{"a", ""});
  CHECK_THROWS_WITH(parse_assignment("drift"), Contains("drift") && Contains("KEY=VALUE"));
  CHECK_THROWS_WITH(parse_assignment("=5"), Contains("KEY=VALUE"));
}

TEST_CASE("keys and groups can be selected") {
  CHECK(keys_of(selected(some(), {})).size() == 5);
  CHECK(keys_of(selected(some(), {"documented.trust"})) ==
        std::vector<std::string>{"documented.trust.enabled", "documented.trust.n_base"});
  CHECK(keys_of(selected(some(), {"documented.trust.n_base", "documented.drift.jump_alpha"})) ==
        std::vector<std::string>{"documented.drift.jump_alpha", "documented.trust.n_base"});
  CHECK_THROWS_WITH(selected(some(), {"documented.trust", "trus"}), Contains("'trus'"));
  CHECK_THROWS_AS(selected(some(), {"trust.n"}), std::invalid_argument);
}

TEST_CASE("a fusion that loads the TOML output has the same settings") {
  settings::Settings settings;
  settings.preset.imu_weight = settings::ImuWeight::user;
  settings.drift.jump_alpha = 0.1 + 0.2;
  settings.trust.enabled = false;
  const EffectiveSettings beacon{7, 0, 1, config::texts_of(settings)};
  EffectiveSettings other{8, 0, 1, {{"documented.trust.n_base", "11"}}};
  const auto config = loaded(toml_of({beacon, other}));
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    CHECK(settings::get(config.for_beacon(7), row.key) == settings::get(settings, row.key));
  }
  CHECK(config.for_beacon(8).trust.n_base == 11);
}

TEST_CASE("the settings of all beacons are at the top level") {
  settings::Settings for_all;
  for_all.trust.n_base = 9;
  const EffectiveSettings seven{7, 0, 1, {{"documented.trust.n_base", "11"}}};
  const auto config = loaded(toml_of({{all_beacons, 0, 0, config::texts_of(for_all)}, seven}));
  CHECK(config.for_beacon(8).trust.n_base == 9);
  CHECK(config.for_beacon(7).trust.n_base == 11);
}

TEST_CASE("items 2, 3 and 4 under a preset are comments, so that loading the file gives no warning") {
  settings::Settings low;
  low.engine.engine = settings::EngineKind::documented;
  low.preset.imu_weight = settings::ImuWeight::low;
  const auto texts = config::texts_of(settings::resolved(low));
  const std::vector<EffectiveSettings> settings{{all_beacons, 0, 0, texts}, {7, 0, 1, texts}};
  const auto config = loaded(toml_of(settings));
  CHECK(config.warnings().empty());
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    CHECK(settings::get(settings::resolved(config.for_beacon(7)), row.key) ==
          settings::get(settings::resolved(low), row.key));
  }
  CHECK_THAT(toml_of(settings), Contains("\n# documented.drift.jump_alpha = "));
  CHECK_THAT(toml_of(settings, {"documented.drift"}),
             Contains("\n# documented.drift.jump_alpha = "));  // even if the preset is not selected
  low.preset.imu_weight = settings::ImuWeight::user;
  CHECK_THAT(toml_of({{7, 0, 1, config::texts_of(low)}}), Contains("\ndocumented.drift.jump_alpha = "));
}

TEST_CASE("a fusion that loads the saved file has the same settings, and a change for all still applies") {
  const std::vector<EffectiveSettings> changed{{11, 0, 0, {{"heading.mount_offset_deg", "90"}}},
                                               {all_beacons,
                                                0,
                                                0,
                                                {{"admission.min_quality_percent", "60"},
                                                 {"delay.processing_s", "0.07"},
                                                 {"fusion.engine", "documented"}}}};
  const sonopose::test::TemporaryFolder folder;
  const std::string text = save(changed, folder / "tuned.toml");
  CHECK_THAT(text, Contains("tuned.toml: 4 settings that differ"));
  auto config = config::FusionConfig::load(folder / "tuned.toml");
  CHECK(config.beacons() == std::vector<BeaconAddress>{11});
  CHECK(config.for_beacon(7).admission.min_quality_percent == 60);
  CHECK(config.for_beacon(7).delay.processing_s == 0.07);
  CHECK(config.for_beacon(7).engine.engine == settings::EngineKind::documented);
  CHECK(config.for_beacon(7).heading.mount_offset_deg == 0);
  CHECK(config.for_beacon(11).heading.mount_offset_deg == 90);
  config.assign("admission.min_quality_percent=70");
  CHECK(config.for_beacon(11).admission.min_quality_percent == 70);
}

TEST_CASE("a saved file of defaults has no settings") {
  const sonopose::test::TemporaryFolder folder;
  CHECK_THAT(save({{all_beacons, 0, 0, {}}}, folder / "tuned.toml"), Contains("0 settings that differ"));
  CHECK(config::FusionConfig::load(folder / "tuned.toml").given_toml().empty());
}

TEST_CASE("names are checked against the settings table") {
  CHECK_NOTHROW(check_names({}));
  CHECK_NOTHROW(check_names(
      {"documented.trust", "documented.drift.jump_alpha", "documented", "documented.attitude.mahony"}));
  CHECK_THROWS_WITH(check_names({"documented.trust", "trust.sigma"}),
                    Contains("'trust.sigma'") && Contains("'documented.trust.sigma_m'"));
  CHECK_THROWS_WITH(check_names({"trus"}), Contains("'trus'"));
  CHECK_THROWS_AS(check_names({""}), settings::SettingError);
}

TEST_CASE("numbers are JSON numbers") {
  const auto list = nlohmann::json::parse(json_of({some()}));
  REQUIRE(list.size() == 1);
  CHECK(list[0]["beacon"] == 7);
  CHECK(list[0]["from_event"] == 12);
  CHECK(list[0]["time_ns"] == 1234);
  const auto& values = list[0]["settings"];
  CHECK(values["documented.imu_weight"] == "medium");
  CHECK(values["documented.drift.jump_alpha"] == 0.1 + 0.2);
  CHECK(values["documented.trust.enabled"] == true);
  CHECK(values["documented.trust.n_base"] == 3);
}

TEST_CASE("an observer formats changes per beacon") {
  SettingsObserver lines(false);
  SettingsObserver objects(true);
  for (auto* observer : {&lines, &objects}) {
    CHECK_FALSE(observer->has_settings_of(7));
    CHECK(observer->on(some()).empty());
    CHECK(observer->has_settings_of(7));
    CHECK(observer->on(some()).empty());
    EffectiveSettings other = some();
    other.address = 8;
    other.values[4].value = "5";
    CHECK(observer->on(other).empty());
  }
  EffectiveSettings changed = some();
  changed.from_sequence = 99;
  changed.values[0].value = "high";
  changed.values[4].value = "5";
  CHECK(lines.on(changed) ==
        "beacon.7.documented.imu_weight = \"high\"  # was \"medium\", from event 99\n"
        "beacon.7.documented.trust.n_base = 5  # was 3, from event 99\n");
  const auto object = nlohmann::json::parse(objects.on(changed));
  CHECK(object["beacon"] == 7);
  CHECK(object["from_event"] == 99);
  CHECK(object["changed"] ==
        nlohmann::json{{"documented.imu_weight", "high"}, {"documented.trust.n_base", 5}});
  CHECK(lines.on(changed).empty());
}

TEST_CASE("changes of the settings of all beacons have no beacon prefix") {
  SettingsObserver lines(false);
  SettingsObserver objects(true);
  const EffectiveSettings before{all_beacons, 0, 0, {{"documented.trust.n_base", "3"}}};
  const EffectiveSettings after{all_beacons, 0, 0, {{"documented.trust.n_base", "5"}}};
  lines.on(before);
  objects.on(before);
  CHECK(lines.on(after) == "documented.trust.n_base = 5  # was 3\n");
  CHECK(nlohmann::json::parse(objects.on(after))["beacon"] == "all");
}

TEST_CASE("a reply states when it takes effect") {
  CHECK_THAT(effective_time_text({7, 1, true, "", 12}), Contains("event 12") && Contains("beacon 7"));
  CHECK_THAT(effective_time_text({7, 1, true, "", 0}), Contains("first event of beacon 7"));
  CHECK_THAT(effective_time_text({all_beacons, 1, true, "", 12}), Contains("each") && Contains("event 12"));
  CHECK_THAT(effective_time_text({all_beacons, 1, true, "", 0}), Contains("each") && Contains("next event"));
  CHECK_THAT(effective_time_text({all_beacons, 1, true, "", 0, "7: event 812, 9: event 501"}),
             Contains("7: event 812, 9: event 501"));
  const SettingsReply some_stay{all_beacons, 1, true, "", 0, "7: event 812; unchanged: 8"};
  CHECK_THAT(effective_time_text(some_stay), Contains("next event") && Contains("unchanged: 8"));
  CHECK_FALSE(changes_no_known_beacon(some_stay));
  const SettingsReply all_stay{all_beacons, 1, true, "", 0, "unchanged: 7, 8"};
  CHECK(effective_time_text(all_stay) == "only for beacons that appear later (unchanged: 7, 8)");
  CHECK(changes_no_known_beacon(all_stay));
}

}  // namespace settings_report_test
