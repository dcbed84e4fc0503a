#include "recording/log_meta.hpp"

#include "files/missing.hpp"
#include "files/replacement.hpp"
#include "recording/log_columns.hpp"
#include "toml/leaves.hpp"
#include "toml/quoted.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::recording {
namespace {

using toml::Leaf;

constexpr std::string_view meaning_key = "imu_meaning";
constexpr std::string_view address_key = "beacon_address";
constexpr std::string_view version_key = "program_version";
constexpr std::string_view settings_table = "settings";

std::string word_of(ImuMeaning meaning) {
  return std::string(imu_meaning_words.at(static_cast<std::size_t>(meaning)));
}

/// Reads the leaves of one file.
class MetaReader {
public:
  explicit MetaReader(const std::filesystem::path& file) : file_(file) {}

  LogMeta read() {
    for (const Leaf& leaf : toml::read_leaves(file_)) take(leaf);
    return std::move(meta_);
  }

private:
  void take(const Leaf& leaf) {
    if (leaf.key == meaning_key) {
      meta_.imu_meaning = meaning_of(leaf);
    } else if (leaf.key == address_key) {
      meta_.beacon_address = address_of(leaf);
    } else if (leaf.key == version_key) {
      meta_.program_version = text_of(leaf);
    } else if (const std::string table(settings_table); leaf.key.starts_with(table + ".")) {
      meta_.settings.emplace_back(leaf.key.substr(table.size() + 1), text_of(leaf));
    } else {
      fail(leaf, "unknown key; the keys are " + std::string(meaning_key) + ", " + std::string(address_key) +
                     ", " + std::string(version_key) + ", " + std::string(settings_table) + ".NAME");
    }
  }

  [[nodiscard]] ImuMeaning meaning_of(const Leaf& leaf) const {
    const auto* const word = std::get_if<std::string>(&leaf.value);
    const auto* const known = word == nullptr
                                  ? imu_meaning_words.end()
                                  : std::find(imu_meaning_words.begin(), imu_meaning_words.end(), *word);
    if (known == imu_meaning_words.end()) {
      fail(leaf,
           fmt::format("{} is not one of {}", toml::text_of(leaf.value), fmt::join(imu_meaning_words, ", ")));
    }
    return static_cast<ImuMeaning>(known - imu_meaning_words.begin());
  }

  [[nodiscard]] BeaconAddress address_of(const Leaf& leaf) const {
    const auto* const number = std::get_if<std::int64_t>(&leaf.value);
    if (number == nullptr || *number < 0 || *number >= all_beacons) {
      fail(leaf,
           toml::text_of(leaf.value) + " is not a whole number from 0 to " + std::to_string(all_beacons - 1));
    }
    return static_cast<BeaconAddress>(*number);
  }

  [[nodiscard]] std::string text_of(const Leaf& leaf) const {
    const auto* const text = std::get_if<std::string>(&leaf.value);
    if (text == nullptr) fail(leaf, toml::text_of(leaf.value) + " is not a text in quotes");
    return *text;
  }

  [[noreturn]] void fail(const Leaf& leaf, const std::string& why) const {
    throw files::IoError(file_.string() + ":" + std::to_string(leaf.line) + ": " + leaf.key + ": " + why);
  }

  const std::filesystem::path& file_;
  LogMeta meta_;
};

}  // namespace

std::string program_version() {
  return SONOPOSE_VERSION;
}

LogMeta read_log_meta(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / meta_file;
  return files::is_present(file) ? MetaReader(file).read() : LogMeta{};
}

void write_log_meta(const std::filesystem::path& folder, const LogMeta& meta) {
  std::string text = "# What the other files of this folder do not say.\n";
  text.append(meaning_key).append(" = \"" + word_of(meta.imu_meaning) + "\"\n");
  if (meta.beacon_address) {
    text.append(address_key).append(" = " + std::to_string(*meta.beacon_address) + "\n");
  }
  if (!meta.program_version.empty()) {
    text.append(version_key).append(" = ").append(toml::quoted(meta.program_version)).append("\n");
  }
  if (!meta.settings.empty()) text.append("\n[").append(settings_table).append("]\n");
  for (const auto& [name, value] : meta.settings) {
    text.append(name).append(" = ").append(toml::quoted(value)).append("\n");
  }
  files::write_whole(folder / meta_file, text);
}

}  // namespace sonopose::recording
