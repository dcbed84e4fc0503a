/// Each setting belongs to one stage: its group's fields are read in that stage's source and nowhere else.

#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace stages_test {

namespace fs = std::filesystem;

/// Source files of the engine, the filters and the calibration, by stem.
std::map<std::string, std::string> sources() {
  std::map<std::string, std::string> texts;
  for (const char* const folder : {"src/estimation", "src/estimation/documented", "src/settings",
                                   "src/attitude", "src/calibration/model"}) {
    for (const auto& entry : fs::directory_iterator(fs::path(SONOPOSE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp" || entry.path().stem() == "settings_table") continue;
      std::ifstream stream(entry.path());
      texts[entry.path().stem().string()] = {std::istreambuf_iterator<char>(stream), {}};
    }
  }
  return texts;
}

/// "trust" for trust.sigma_m and "mahony" for attitude.mahony.kp. The group of the preset is called "fusion"
/// in the document, the group "attitude" itself selects the filter, and gyroscope and accelerometer share a
/// model.
std::string stage_of(const std::string& group) {
  if (group == "fusion") return "preset";
  if (group == "attitude") return "any_filter";
  if (group == "output") return "prediction";
  if (group == "calibration") return "axes";
  if (group == "calibration.gyroscope" || group == "calibration.accelerometer") return "inertial";
  return group.substr(group.rfind('.') + 1);
}

TEST_CASE("each of the 37 items is read by its own stage and by no other") {
  const auto texts = sources();
  REQUIRE(texts.size() > 10);
  for (const auto& row : sonopose::settings::setting_table()) {
    if (row.key == "fusion.engine") continue;  // it selects among engines: AnyEstimator reads it
    if (row.read_by == sonopose::settings::ReadBy::kalman) continue;  // no stage of the documented engine
    const std::string stage = stage_of(row.group);
    // In its stage a group is called `settings`, the preset's `preset`.
    const std::regex own("\\b(settings|preset)\\." + row.name + "\\b");
    const std::regex foreign(R"(\bsettings_?\.\w+\.)" + row.name + R"(\b)");
    INFO("item " << row.item << ", " << row.key);
    REQUIRE(texts.contains(stage));
    CHECK(std::regex_search(texts.at(stage), own));
    for (const auto& [stem, text] : texts) {
      if (text.find(row.name) == std::string::npos) continue;  // much faster than a regular expression
      INFO("in " << stem << ".cpp");
      if (stem != "preset") CHECK_FALSE(std::regex_search(text, foreign));  // it replaces items 2, 3 and 4
      if (stem != stage)
        CHECK_FALSE(
            (std::regex_search(text, own) && text.find("documented/" + stage + ".hpp") != std::string::npos));
    }
  }
}

}  // namespace stages_test
