/// Generated files in the repository match the declarations that they are generated from.

#include "config/fusion_config.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <sstream>

namespace generated_files_test {

using namespace sonopose;

std::string text_of(const std::string& path_in_project) {
  const std::ifstream file(std::string(SONOPOSE_SOURCE_DIR) + "/" + path_in_project);
  REQUIRE(file.good());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST_CASE("config/fusion.toml is the defaults as --print-config prints them") {
  CHECK(text_of("config/fusion.toml") == config::FusionConfig{}.to_toml());
}

TEST_CASE("config/tuned.toml loads, without a warning, and leaves the typical ranges where it says so") {
  const auto config = config::FusionConfig::load(std::string(SONOPOSE_SOURCE_DIR) + "/config/tuned.toml");
  CHECK(config.warnings().empty());
  const settings::Settings tuned = config.for_beacon(7);
  CHECK(tuned.trust.sigma_m > 0.15);
  CHECK(tuned.drift.velocity_smooth_rate_hz < 10.0);
}

TEST_CASE("docs/settings.md is the page of the declarations") {
  CHECK(text_of("docs/settings.md") == config::settings_page());
}

TEST_CASE("the programs' help has a line for every setting, with item, default and range") {
  const std::string help = config::settings_help();
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    const auto begin = help.find("  " + row.key + " ");
    REQUIRE(begin != std::string::npos);
    const std::string line = help.substr(begin, help.find('\n', begin) - begin);
    CHECK(line.find(settings::to_text(row.initial)) != std::string::npos);
    CHECK(line.find(row.allowed()) != std::string::npos);
    if (row.item != 0) CHECK(line.ends_with("item " + std::to_string(row.item)));
  }
}

TEST_CASE("the programs' help can be limited to a group or a setting") {
  CHECK(config::settings_help("documented.drift").find("  heading.") == std::string::npos);
  CHECK(config::settings_help("documented.drift").find("  documented.drift.jump_alpha ") !=
        std::string::npos);
  CHECK(config::settings_help("documented.drift.jump_alpha").find("  documented.drift.jump_alpha ") !=
        std::string::npos);
  CHECK(config::settings_help("dri").empty());
  const auto groups = config::settings_groups();
  for (const std::string& group : groups) CHECK_FALSE(config::settings_help(group).empty());
  CHECK(std::find(groups.begin(), groups.end(), "documented.attitude.mahony") != groups.end());
}

TEST_CASE("the page names every setting") {
  const std::string page = config::settings_page();
  for (const auto& row : settings::setting_table()) {
    INFO(row.key);
    CHECK(page.find("`" + row.key + "`") != std::string::npos);
    CHECK(page.find(row.sentence) != std::string::npos);
  }
}

}  // namespace generated_files_test
