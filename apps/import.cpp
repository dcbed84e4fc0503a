// sonopose-import: makes a sensor-log folder of tables with other column names.

#include "csv/missing_columns.hpp"
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

constexpr double max_shift_s = 2e9;  // one table may begin at zero

struct Options {
  recording::TableFiles files;
  std::vector<std::string> columns;  ///< NAME=COLUMN
  std::filesystem::path out;
  double shift_s = 0;
  BeaconAddress beacon = recording::default_log_address;
};

void add_options(apps::CommandLine& app, Options& options) {
  app.add_option("--imu", options.files.imu, "Table of angular velocities w_x … and specific forces a_x …")
      .required()
      .type_name("FILE");
  app.add_option("--positions", options.files.positions,
                 "Table of positions x, y, z, and if known received and quality; it may be the IMU's table")
      .required()
      .type_name("FILE");
  app.add_option("--truth", options.files.truth, "Table of true positions p_x …, and if known q_w …, v_x …")
      .type_name("FILE");
  app.add_option(
         "--column", options.columns,
         "A column with another name, and its unit if the header has none: \"w_x [deg s^-1]=Gyro 1\"; may "
         "be repeated, and begin with the file: \"imu.csv:timestamp [ms]=t\"")
      .type_name("NAME=COLUMN")
      .allow_extra_args(false);
  app.add_option("--shift", options.shift_s,
                 "Added to the times of the positions, if their clock differs [s]")
      .check(apps::number_between(-max_shift_s, max_shift_s));
  app.add_option("--tag", options.files.tag,
                 "The device to read, if a column names several (default: that of --beacon)")
      .type_name("ID");
  app.add_option("--out", options.out, "New sensor-log folder; an existing recording is never overwritten")
      .required()
      .type_name("DIR");
  apps::add_beacon_option(app, options.beacon);
}

csv::ColumnNames names_of(const std::vector<std::string>& columns) {
  csv::ColumnNames names;
  for (const std::string& text : columns) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      apps::refuse_option("--column", "\"" + text + "\" is not NAME=COLUMN");
    }
    const std::size_t colon = text.rfind(':', equals) + 1;  // 0 without a file
    const std::string given = text.substr(0, colon) + text.substr(equals + 1);
    if (!names.own_by_given.emplace(given, text.substr(colon, equals - colon)).second) {
      apps::refuse_option("--column", "\"" + given + "\" is given twice; FILE:NAME=COLUMN is of a file");
    }
  }
  return names;
}

/// Reads the tables. An error about missing columns proposes the names to give.
recording::Tables read(const Options& options, csv::ColumnNames& names) {
  recording::TableFiles files = options.files;
  files.position_shift_ns = to_ns(options.shift_s);
  try {
    return recording::read_tables(files, names, options.beacon);
  } catch (const csv::MissingColumns& error) {
    std::string proposal;
    for (const csv::MissingColumn& missing : error.columns()) {
      std::string_view before = proposal.empty() ? "; try --column" : " --column";
      for (const std::string& candidate : missing.candidates) {
        const std::string option = fmt::format("\"{}={}\"", missing.column, candidate);
        if (proposal.find(option) != std::string::npos) continue;  // of the other table
        proposal += fmt::format("{} {}", before, option);
        before = " or";
      }
    }
    throw files::IoError(error.what() + proposal);
  }
}

int import(const Options& options) {
  recording::refuse_recording_in(options.out);
  csv::ColumnNames names = names_of(options.columns);
  const recording::Tables tables = read(options, names);
  for (const std::string& text : tables.log.warnings) logging::warning(text);
  for (const std::string& text :
       recording::input_findings(options.out.string(), tables.log.events, &names, tables.log.truth)) {
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
  apps::print("{}{}: written; sonopose-replay {} scores it\n", evaluation::import_text(tables),
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
