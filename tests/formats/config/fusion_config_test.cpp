/// Settings from TOML and the command line: valid ones are applied, invalid ones named.

#include "config/fusion_config.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <unistd.h>

namespace fusion_config_test {

using namespace sonopose;
using Catch::Matchers::Contains;
using config::ConfigError;
using config::FusionConfig;

/// A file that lives as long as the object.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string& text)
      : path_{std::filesystem::temp_directory_path() /
              ("sonopose_config_" + std::to_string(::getpid()) + "_" + std::to_string(++count) + ".toml")} {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  static inline int count = 0;
  std::filesystem::path path_;
};

FusionConfig loaded(const std::string& text) {
  return FusionConfig::load(TemporaryFile(text).path());
}

/// Message of the error when loading this text.
std::string refusal(const std::string& text) {
  const TemporaryFile file(text);
  try {
    FusionConfig::load(file.path());
  } catch (const ConfigError& error) {
    CHECK_THAT(error.what(), Contains(file.path().filename().string() + ":"));
    return error.what();
  }
  FAIL("loaded: " << text);
  return {};
}

bool same_everywhere(const settings::Settings& a, const settings::Settings& b) {
  for (const auto& row : settings::setting_table()) {
    if (settings::get(a, row.key) != settings::get(b, row.key)) return false;
  }
  return true;
}

TEST_CASE("an empty file leaves every default") {
  CHECK(same_everywhere(loaded("").for_beacon(7), settings::Settings{}));
}

TEST_CASE("a file's values reach every beacon") {
  const FusionConfig config = loaded(R"([documented]
imu_weight = "high"
[documented.trust]
sigma_m = 0.08
n_base = 5
enabled = false
[documented.attitude.mahony]
kp = 2
)");
  for (const BeaconAddress address : std::initializer_list<BeaconAddress>{0, 7, 65534}) {
    const settings::Settings settings = config.for_beacon(address);
    CHECK(settings.preset.imu_weight == settings::ImuWeight::high);
    CHECK(settings.trust.sigma_m == 0.08);
    CHECK(settings.trust.n_base == 5);
    CHECK_FALSE(settings.trust.enabled);
    CHECK(settings.attitude.mahony.kp == 2.0);
    CHECK(settings.drift.velocity_smooth_rate_hz == settings::DriftSettings{}.velocity_smooth_rate_hz);
  }
}

TEST_CASE("one beacon's own values stand above those for all, wherever they stand in the file") {
  const FusionConfig config = loaded(R"([beacon.7.documented.drift]
velocity_smooth_rate_hz = 25.0
[beacon.7.documented.attitude.mahony]
ki = 0.005
[documented.drift]
velocity_smooth_rate_hz = 12.0
)");
  CHECK(config.for_beacon(7).drift.velocity_smooth_rate_hz == 25.0);
  CHECK(config.for_beacon(7).attitude.mahony.ki == 0.005);
  CHECK(config.for_beacon(8).drift.velocity_smooth_rate_hz == 12.0);
  CHECK(config.for_beacon(8).attitude.mahony.ki == attitude::MahonySettings{}.ki);
}

TEST_CASE("an error names file, line, key, value and what is allowed") {
  SECTION("a misspelt key") {
    CHECK_THAT(refusal("[documented.drift]\n\ndecay_rate = 2.0\n"),
               Contains(":3:") && Contains("drift.decay_rate") && Contains("documented.drift.decay_rate_hz"));
  }
  SECTION("a misspelt group") {
    CHECK_THAT(refusal("[drfit]\njump_alpha = 0.5\n"),
               Contains(":2:") && Contains("documented.drift.jump_alpha"));
  }
  SECTION("out of range") {
    CHECK_THAT(
        refusal("[documented.drift]\njump_alpha = 1.5\n"),
        Contains(":2:") && Contains("documented.drift.jump_alpha") && Contains("1.5") && Contains("0 … 1"));
    CHECK_THAT(refusal("[documented.drift]\njump_alpha = nan\n"), Contains("0 … 1"));
    CHECK_THAT(refusal("[documented.drift]\njump_alpha = -inf\n"), Contains("0 … 1"));
    CHECK_THAT(refusal("[documented.trust]\nn_base = 99999999999999\n"),
               Contains("documented.trust.n_base") && Contains("1 … 1000"));
  }
  SECTION("of the wrong type") {
    CHECK_THAT(refusal("[documented.trust]\nsigma_m = \"small\"\n"),
               Contains(":2:") && Contains("small") && Contains("wrong type"));
    CHECK_THAT(refusal("[documented.trust]\nn_base = 2.5\n"), Contains("wrong type") && Contains("1 … 1000"));
    CHECK_THAT(refusal("[documented.trust]\nenabled = 1\n"), Contains("true or false"));
    CHECK_THAT(refusal("[documented]\nimu_weight = \"heavy\"\n"),
               Contains("heavy") && Contains("low, medium, high or user"));
    CHECK_THAT(refusal("[documented.trust]\nsigma_m = [0.1, 0.2]\n"),
               Contains(":2:") && Contains("documented.trust.sigma_m"));
    CHECK_THAT(refusal("[documented.trust]\nsigma_m = 2024-05-01\n"), Contains("documented.trust.sigma_m"));
  }
  SECTION("in a beacon's own table") {
    CHECK_THAT(refusal("[beacon.7.documented.trust]\nsigma = 0.1\n"),
               Contains(":2:") && Contains("documented.trust.sigma_m"));
    CHECK_THAT(refusal("[beacon.7.documented.trust]\nsigma_m = -1.0\n"),
               Contains("documented.trust.sigma_m") && Contains("-1"));
    CHECK_THAT(refusal("[beacon.seven.trust]\nsigma_m = 0.1\n"),
               Contains("beacon.seven") && Contains("65534"));
    CHECK_THAT(refusal("[beacon.65535.documented.trust]\nsigma_m = 0.1\n"), Contains("65534"));
    CHECK_THAT(refusal("[beacon.99999.documented.trust]\nsigma_m = 0.1\n"), Contains("65534"));
    CHECK_THAT(refusal("[beacon]\nsigma_m = 0.1\n"), Contains("beacon.ADDRESS"));
  }
  SECTION("not TOML") {
    CHECK_THAT(refusal("[drift\n"), Contains(":1:"));
    CHECK_THAT(refusal("[documented.drift]\njump_alpha = 0.1\njump_alpha = 0.2\n"), Contains(":3:"));
  }
}

TEST_CASE("a file that is not there is an error that names it") {
  CHECK_THROWS_WITH(FusionConfig::load("/nonexistent/fusion.toml"), Contains("/nonexistent/fusion.toml"));
}

TEST_CASE("a folder in place of a file is an error that names it") {
  const std::string folder = std::filesystem::temp_directory_path().string();
  CHECK_THROWS_WITH(FusionConfig::load(folder), Contains(folder) && Contains("folder"));
}

/// A dotted key "a.a.a" with this many parts.
std::string key_of_parts(int parts) {
  std::string key = "a";
  for (int i = 1; i < parts; ++i) key += ".a";
  return key;
}

TEST_CASE("a key of any number of parts, however they are written, is refused with its line") {
  CHECK_THAT(refusal("\n" + key_of_parts(60'000) + " = 1\n"), Contains(":2: ") && Contains("32 dots"));
  CHECK_THAT(refusal("\n[" + key_of_parts(60'000) + "]\n"), Contains(":2: ") && Contains("32 dots"));
  CHECK_THAT(refusal("\n" + key_of_parts(20) + " = 1\n"), Contains(":2: ") && Contains("16 parts"));
  SECTION("in nested tables") {
    std::string text = "a = ";
    for (int i = 0; i < 50'000; ++i) text += "{a = ";
    CHECK_THAT(refusal(text), Contains(":1: "));
  }
  SECTION("in nested tables on lines of their own") {
    std::string text = "a = ";
    std::string end;
    constexpr int deepest = 120;  // the parser's limit, with an array and a table per level
    for (int i = 0; i < deepest; ++i) {
      text += "[\n{" + key_of_parts(30) + " = ";
      end += "}]";
    }
    CHECK_THAT(refusal(text + "1" + end + "\n"), Contains(":1: ") || Contains("nest"));
  }
}

TEST_CASE("a comment may have as many dots as it likes in a row") {
  CHECK(same_everywhere(loaded("# " + std::string(80, '.') + "\n").for_beacon(7), settings::Settings{}));
}

TEST_CASE("an assignment (--set) takes a value for all or for one beacon") {
  FusionConfig config;
  config.assign("documented.drift.velocity_smooth_rate_hz=20");
  config.assign("beacon.7.documented.trust.n_base=9");
  config.assign("documented.imu_weight=low");
  CHECK(config.for_beacon(3).drift.velocity_smooth_rate_hz == 20.0);
  CHECK(config.for_beacon(7).trust.n_base == 9);
  CHECK(config.for_beacon(3).trust.n_base == settings::TrustSettings{}.n_base);
  CHECK(config.for_beacon(3).preset.imu_weight == settings::ImuWeight::low);
  config.assign("beacon.7.documented.trust.n_base=11");  // the last assignment wins
  CHECK(config.for_beacon(7).trust.n_base == 11);
}

TEST_CASE("an assignment (--set) refuses with key, value and what is allowed, and changes nothing") {
  FusionConfig config;
  const auto refused = [&config](const char* assignment) -> std::string {
    try {
      config.assign(assignment);
    } catch (const ConfigError& error) {
      CHECK_THAT(error.what(), Contains(assignment));
      return error.what();
    }
    FAIL("accepted: " << assignment);
    return {};
  };
  CHECK_THAT(refused("documented.drift.jump_alpha=2"), Contains("0 … 1"));
  CHECK_THAT(refused("documented.drift.jump_alpha=nan"), Contains("0 … 1"));
  CHECK_THAT(refused("drift.jump_alfa=0.5"), Contains("documented.drift.jump_alpha"));
  CHECK_THAT(refused("documented.drift.jump_alpha=half"), Contains("half"));
  CHECK_THAT(refused("documented.drift.jump_alpha"), Contains("GROUP.KEY=VALUE"));
  CHECK_THAT(refused("=0.5"), Contains("GROUP.KEY=VALUE"));
  CHECK_THAT(refused("beacon.x.drift.jump_alpha=0.5"), Contains("beacon.ADDRESS"));
  CHECK_THAT(refused("beacon.7.documented.drift.jump_alpha=5"), Contains("0 … 1"));
  CHECK(same_everywhere(config.for_beacon(7), settings::Settings{}));
  CHECK(config.warnings().empty());
}

TEST_CASE("what is printed loads back to the same, beacons included") {
  FusionConfig config;
  for (const auto* assignment :
       {"fusion.engine=documented", "documented.imu_weight=user", "documented.drift.jump_alpha=1",
        "documented.drift.decay_rate_hz=1e-05", "documented.trust.n_base=7", "documented.trust.enabled=false",
        "delay.source=fixed", "admission.max_position_m=1e+06", "beacon.7.documented.drift.jump_alpha=0.125",
        "beacon.7.documented.attitude.mahony.kp=3", "beacon.12.documented.imu_weight=low",
        "beacon.7.documented.drift.jump_alpha=0.25"}) {
    config.assign(assignment);
  }
  const FusionConfig again = loaded(config.to_toml());
  for (const BeaconAddress address : std::initializer_list<BeaconAddress>{1, 7, 12}) {
    CHECK(same_everywhere(again.for_beacon(address), config.for_beacon(address)));
  }
  CHECK(again.to_toml() == config.to_toml());
  CHECK(again.warnings() == config.warnings());
}

TEST_CASE("what was given is printed alone, and loads back to the same") {
  FusionConfig config;
  CHECK(config.given_toml().empty());
  config.assign("documented.trust.n_base=7");
  config.assign("documented.trust.enabled=false");
  config.assign("beacon.7.documented.attitude.mahony.kp=3");
  CHECK(config.given_toml() ==
        "\n[documented.trust]\nenabled = false\nn_base = 7\n\n[beacon.7.documented.attitude.mahony]\nkp = "
        "3.0\n");
  CHECK(loaded(config.given_toml()).to_toml() == config.to_toml());
}

TEST_CASE("the printed configuration shows every setting with its item and range") {
  std::string text = FusionConfig{}.to_toml();
  constexpr std::string_view line_break = "\n# ";
  for (std::size_t at = 0; (at = text.find(line_break)) != std::string::npos;)
    text.replace(at, line_break.size(), " ");
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    CHECK(text.find(row.sentence + " (" + row.allowed() + ")") != std::string::npos);
    CHECK(text.find(row.name + " = ") != std::string::npos);
  }
  for (int item = 1; item <= 37; ++item) {
    CHECK(text.find("Item " + std::to_string(item) + ". ") != std::string::npos);
  }
}

TEST_CASE("item 1: a preset beside items 2, 3 or 4 is a warning that names them") {
  SECTION("for all") {
    const auto warnings = loaded(
                              "[fusion]\nengine = \"documented\"\n[documented]\nimu_weight = "
                              "\"low\"\n[documented.drift]\njump_alpha = 0.9\n")
                              .warnings();
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], Contains("documented.drift.jump_alpha") && Contains("low") && Contains("user"));
  }
  SECTION("also beside the preset that holds by default") {
    CHECK(loaded("[fusion]\nengine = \"documented\"\n[documented.drift]\njump_alpha = 0.9\ndecay_rate_hz = "
                 "1.0\n[documented.velocity]\nblend_weight = 0.1\n")
              .warnings()
              .size() == 3);
  }
  SECTION("for one beacon") {
    const auto warnings = loaded(
                              "[fusion]\nengine = \"documented\"\n[documented]\nimu_weight = "
                              "\"user\"\n[documented.drift]\njump_alpha = 0.9\n"
                              "[beacon.7.documented]\nimu_weight = "
                              "\"low\"\n[beacon.7.documented.velocity]\nblend_weight = 0.9\n")
                              .warnings();
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], Contains("beacon.7.documented.velocity.blend_weight"));
  }
  SECTION("none where the user's values are used, or where there are none") {
    CHECK(loaded("[fusion]\nengine = \"documented\"\n[documented]\nimu_weight = "
                 "\"user\"\n[documented.drift]\njump_alpha = 0.9\n")
              .warnings()
              .empty());
    CHECK(
        loaded("[fusion]\nengine = \"documented\"\n[documented]\nimu_weight = \"low\"\n").warnings().empty());
  }
}

TEST_CASE("settings that contradict each other are a warning that names both with their values") {
  const auto warnings_of = [](std::initializer_list<const char*> assignments) {
    FusionConfig config;
    config.assign("fusion.engine=documented");
    for (const char* assignment : assignments) config.assign(assignment);
    return config.warnings();
  };
  const auto only = [&](std::initializer_list<const char*> assignments) {
    const auto warnings = warnings_of(assignments);
    REQUIRE(warnings.size() == 1);
    return warnings.front();
  };
  CHECK(warnings_of({}).empty());
  CHECK_THAT(only({"documented.velocity.interval_max_s=0.2", "documented.velocity.interval_min_s=0.3"}),
             Contains("documented.velocity.interval_min_s = 0.3") &&
                 Contains("documented.velocity.interval_max_s = 0.2") && Contains("never corrected"));
  CHECK_THAT(only({"documented.velocity.interval_wanted_s=1.6"}),
             Contains("documented.velocity.interval_wanted_s = 1.6") &&
                 Contains("documented.velocity.interval_max_s"));
  CHECK_THAT(only({"documented.trust.n_min=50"}),
             Contains("documented.trust.n_min = 50") && Contains("documented.trust.n_max"));
  CHECK_THAT(only({"documented.trust.n_max=40", "documented.trust.stuck_n=40"}),
             Contains("documented.trust.stuck_n = 40") && Contains("documented.trust.n_max = 40") &&
                 Contains("never forced"));
  CHECK_THAT(
      only({"documented.motion.gyro_gate_projection_radps=7", "documented.motion.gyro_gate_freeze_radps=6"}),
      Contains("projection_radps = 7") && Contains("freeze_radps = 6") && Contains("never projected"));
  SECTION("values at the limit and disabled features cause no warning") {
    CHECK(warnings_of({"documented.velocity.interval_wanted_s=0.5", "documented.velocity.interval_max_s=0.5"})
              .empty());
    CHECK(
        warnings_of({"documented.trust.n_max=40", "documented.trust.stuck_n=39", "documented.trust.n_min=40"})
            .empty());
    CHECK(warnings_of({"documented.trust.enabled=false", "documented.trust.n_min=50"}).empty());
    CHECK(warnings_of({"documented.motion.gyro_gate=false", "documented.motion.gyro_gate_freeze_radps=1"})
              .empty());
  }
  SECTION("it names its origin: for all, or for the beacon that brings it about") {
    const auto warnings =
        warnings_of({"documented.trust.n_max=30", "documented.trust.stuck_n=20",
                     "beacon.7.documented.trust.stuck_n=35", "beacon.8.documented.trust.sigma_m=0.2"});
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0],
               Contains("beacon.7.documented.trust.stuck_n = 35") && Contains("documented.trust.n_max = 30"));
    CHECK_THAT(only({"documented.trust.n_max=30", "documented.trust.stuck_n=35",
                     "beacon.8.documented.trust.sigma_m=0.2"}),
               !Contains("beacon"));
  }
}

TEST_CASE("what is printed gives no warnings of its own when it is loaded") {
  FusionConfig config;
  config.assign("fusion.engine=documented");
  for (const auto* weight : {"low", "medium", "high", "user"}) {
    config.assign(std::string("documented.imu_weight=") + weight);
    INFO(weight);
    CHECK(loaded(config.to_toml()).warnings().empty());
    CHECK(same_everywhere(loaded(config.to_toml()).for_beacon(1), config.for_beacon(1)));
  }
}

TEST_CASE("the printed defaults give no warning although one engine does not read all of them") {
  CHECK(loaded(FusionConfig{}.to_toml()).warnings().empty());
}

TEST_CASE("drop-ins replace the values of their file, in the order of their names") {
  const TemporaryFile file("[admission]\nmin_quality_percent = 10\n[program]\nrealtime = 50\n");
  const std::filesystem::path drop_ins = file.path().string() + ".d";
  std::filesystem::create_directory(drop_ins);
  std::ofstream(drop_ins / "90-b.toml") << "[admission]\nmin_quality_percent = 30\n";
  std::ofstream(drop_ins / "50-a.toml") << "[admission]\nmin_quality_percent = 20\n";
  std::ofstream(drop_ins / "95-c.txt") << "no TOML";
  const auto quality = [](const FusionConfig& config) {
    return settings::to_text(settings::get(config.for_beacon(7), "admission.min_quality_percent"));
  };
  CHECK(quality(FusionConfig::load(file.path())) == "30");
  CHECK(quality(FusionConfig::load(file.path(), drop_ins / "90-b.toml")) == "20");
  std::filesystem::remove_all(drop_ins);
}

TEST_CASE("a key of an earlier version is a warning with its successor, and the rest is used") {
  const FusionConfig config = loaded("[trust]\nsigma_m = 0.5\n[admission]\nmin_quality_percent = 10\n");
  const auto warnings = config.warnings();
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Contains(".toml:2: ") && Contains("'documented.trust.sigma_m'"));
  CHECK(settings::to_text(settings::get(config.for_beacon(7), "admission.min_quality_percent")) == "10");
}

TEST_CASE("changes have what differs from another configuration, also a value that is the default") {
  const FusionConfig base = loaded(
      "[admission]\nmin_quality_percent = 10\n[beacon.7.heading]\n"
      "mount_offset_deg = 90.0\n");
  FusionConfig live;
  live.assign("beacon.7.heading.mount_offset_deg=90");
  live.assign("beacon.8.heading.mount_offset_deg=90");
  live.assign("kalman.delay.estimate=true");
  const FusionConfig changes = live.changes_from(base);
  CHECK(changes.given() == 3);
  const std::string toml = changes.given_toml();
  CHECK_THAT(toml, Contains("[admission]\nmin_quality_percent = ") && Contains("[beacon.8.heading]") &&
                       Contains("estimate = true") && !Contains("[beacon.7"));
}

TEST_CASE("a magnetometer is refused with an engine that uses none") {
  FusionConfig config;
  config.assign("documented.attitude.magnetometer=true");
  CHECK_THROWS_WITH(config.check(), Contains("documented.attitude.magnetometer = true") &&
                                        Contains("kalman") && Contains("fusion.engine = documented"));
  config.assign("fusion.engine=documented");
  CHECK_NOTHROW(config.check());
  config.assign("beacon.9.fusion.engine=kalman");
  CHECK_THROWS_WITH(config.check(), Contains("beacon 9: "));
}

}  // namespace fusion_config_test
