#pragma once
/// \file
/// All settings of one engine, a group per stage, and the table made from their declarations.

#include <sonopose/attitude/any_filter.hpp>
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/documented/admission.hpp>
#include <sonopose/estimation/documented/alignment.hpp>
#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/drift.hpp>
#include <sonopose/estimation/documented/frozen.hpp>
#include <sonopose/estimation/documented/heading.hpp>
#include <sonopose/estimation/documented/motion.hpp>
#include <sonopose/estimation/documented/outage.hpp>
#include <sonopose/estimation/documented/output.hpp>
#include <sonopose/estimation/documented/preset.hpp>
#include <sonopose/estimation/documented/runaway.hpp>
#include <sonopose/estimation/documented/startup.hpp>
#include <sonopose/estimation/documented/trust.hpp>
#include <sonopose/estimation/documented/uncertainty.hpp>
#include <sonopose/estimation/documented/velocity.hpp>

#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sonopose::settings {

/// Every setting at its default.
struct Settings {
  estimation::documented::PresetSettings preset;
  estimation::documented::DriftSettings drift;
  estimation::documented::VelocitySettings velocity;
  estimation::documented::AlignmentSettings alignment;
  estimation::documented::HeadingSettings heading;
  estimation::documented::DelaySettings delay;
  estimation::documented::OutageSettings outage;
  estimation::documented::AdmissionSettings admission;
  estimation::documented::TrustSettings trust;
  estimation::documented::RunawaySettings runaway;
  estimation::documented::MotionSettings motion;
  attitude::Settings attitude;
  estimation::documented::StartupSettings startup;
  estimation::documented::FrozenSettings frozen;
  estimation::documented::UncertaintySettings uncertainty;
  estimation::documented::OutputSettings output;
  calibration::Settings calibration;
};

/// The settings as the engine uses them: the preset (item 1) has been put in the place of items 2, 3 and 4.
Settings resolved(Settings settings);

/// A value of any kind of setting; choices are their names.
using SettingValue = std::variant<bool, int, double, std::string>;

/// One declared setting, for everything that lists or checks settings.
struct SettingInfo {
  int item;           ///< number in the fusion document, or own_setting
  std::string key;    ///< "group.name"
  std::string group;  ///< "group"; may itself have dots
  std::string name;
  SettingValue initial;
  SettingValue minimum;  ///< of an int or double
  SettingValue maximum;
  std::vector<std::string_view> choices;  ///< of a choice, else empty
  std::string unit;
  std::string sentence;

  /// What is allowed, in words: "0 … 50 1/s", "true or false", "low, medium, high or user".
  [[nodiscard]] std::string allowed() const;
};

/// A setting that cannot be: the message names key, value and what is allowed.
class SettingError : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// Every setting, in the order of the groups above.
const std::vector<SettingInfo>& setting_table();

/// The row of `key`. Throws SettingError, naming the nearest key, where there is none.
const SettingInfo& setting_info(std::string_view key);

/// The value of `key`. Throws SettingError for an unknown key.
SettingValue get(const Settings& settings, std::string_view key);

/// Sets `key`. An int is accepted for a double. Throws SettingError for an unknown key, a value of the wrong
/// kind or one out of range, and then changes nothing.
void set(Settings& settings, std::string_view key, const SettingValue& value);

/// Reads a value as it is typed on a command line ("true", "12", "0.5", "medium") for `key`.
/// Throws SettingError where it is not of the key's kind.
SettingValue parse_value(std::string_view key, std::string_view text);

/// The value as it is typed.
std::string to_text(const SettingValue& value);

}  // namespace sonopose::settings
