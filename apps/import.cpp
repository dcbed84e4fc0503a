// sonopose-import: makes a sensor-log folder of tables with other column names.

#include "evaluation/calibration/import_text.hpp"
#include "logging/log.hpp"
#include "recording/input_check.hpp"
#include "recording/log_writer.hpp"
#include "recording/part_folder.hpp"
#include "recording/tables.hpp"
#include "support/config_options.hpp"
#include "support/run.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace sonopose;

struct Options {
  recording::TableFiles files;
  std::vector<std::string> columns;  ///< NAME=COLUMN
  std::filesystem::path out;
  BeaconAddress beacon = recording::default_log_address;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--imu", options.files.imu, "Table of angular velocities w_x … and specific forces a_x …")
      ->required()
      ->type_name("FILE");
  app.add_option("--positions", options.files.positions,
                 "Table of positions x, y, z, and if known received and quality; it may be the IMU's table")
      ->required()
      ->type_name("FILE");
  app.add_option("--truth", options.files.truth, "Table of true positions p_x …, and if known q_w …, v_x …")
      ->type_name("FILE");
  app.add_option(
         "--column", options.columns,
         "A column with another name, and its unit if the header has none: \"w_x [deg s^-1]=Gyro 1\"; may "
         "be repeated")
      ->type_name("NAME=COLUMN")
      ->allow_extra_args(false);
  app.add_option("--out", options.out, "New sensor-log folder; an existing recording is never overwritten")
      ->required()
      ->type_name("DIR");
  apps::add_beacon_option(app, options.beacon);
}

files::ColumnNames names_of(const std::vector<std::string>& columns) {
  files::ColumnNames names;
  for (const std::string& text : columns) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw CLI::ValidationError("--column", "\"" + text + "\" is not NAME=COLUMN");
    }
    if (!names.own_by_given.emplace(text.substr(equals + 1), text.substr(0, equals)).second) {
      throw CLI::ValidationError("--column", "\"" + text.substr(equals + 1) + "\" is given twice");
    }
  }
  return names;
}

/// Reads the tables. An error about a missing column proposes the names to give.
recording::Tables read(const Options& options) {
  files::ColumnNames names = names_of(options.columns);
  try {
    return recording::read_tables(options.files, names, options.beacon);
  } catch (const files::MissingColumn& error) {
    std::string proposal;
    for (const std::string& candidate : error.candidates()) {
      proposal += fmt::format("{}--column \"{}={}\"", proposal.empty() ? "; try " : " or ", error.column(),
                              candidate);
    }
    throw files::IoError(error.what() + proposal);
  }
}

int import(const Options& options) {
  recording::refuse_recording_in(options.out);
  const recording::Tables tables = read(options);
  for (const std::string& text : tables.log.warnings) logging::warning(text);
  for (const std::string& text : recording::input_findings(options.out.string(), tables.log.events)) {
    logging::warning(text);
  }
  const recording::PartFolder folder(options.out);
  {
    recording::SensorLogWriter log(folder.part(), {{"imu_table", options.files.imu.string()},
                                                   {"positions_table", options.files.positions.string()}});
    for (const Event& event : tables.log.events) log.write(event);
    for (const TruthSample& sample : tables.log.truth) log.write(sample);
    log.flush();
  }
  folder.commit();
  fmt::print("{}{}: written; sonopose-replay {} scores it\n", evaluation::import_text(tables),
             options.out.string(), options.out.string());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  apps::Program app("import");
  add_options(app, options);
  return apps::run(app, argc, argv, [&options] { return import(options); });
}
