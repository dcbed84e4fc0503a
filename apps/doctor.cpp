// sonopose-doctor: reports problems of the running system, and remedies.

#include "doctor/probe/doctor_node.hpp"
#include "doctor/rules/report.hpp"
#include "logging/log.hpp"
#include "support/bus_options.hpp"
#include "support/progress.hpp"
#include "support/waiting.hpp"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>

int main(int argc, char** argv) {
  sonopose::apps::BusOptions bus;
  sonopose::doctor::probe::DoctorOptions options;
  bool json = false;
  bool verbose = false;
  sonopose::apps::Program app("doctor", "The exit code is 0 if no problems are found, 1 otherwise.");
  add_bus_options(app, bus);
  auto as_json = app.add_flag("--json", json, "Print one JSON object instead of text");
  app.add_flag("--verbose", verbose, "Print what is well of each beacon and line, too").excludes(as_json);
  add_max_beacons(app, "Examine", options.max_beacons);
  app.add_option("--duration", options.duration_s, "Seconds to observe the system")
      .check(sonopose::apps::number_between(0.5, 3600.0))
      .capture_default_str();
  return sonopose::apps::run(app, argc, argv, [&] {
    options.domain = bus.domain;
    options.qos_file = bus.qos_file;
    const sonopose::logging::Session log(sonopose::logging::Level::info);
    sonopose::process::StopSignal stop;
    stop.listen_to_signals();
    std::optional<sonopose::apps::Waiting> waiting;
    waiting.emplace("observing the system", options.duration_s);
    std::optional<sonopose::apps::Progress> fits;
    options.on_fit = [&](double share) {
      waiting.reset();
      if (!fits) fits.emplace();
      fits->at(share, "fitting the motion of each beacon");
    };
    const auto observations = observe(options, stop);
    waiting.reset();
    fits.reset();
    constexpr double min_window_s = 0.5;
    if (stop.requested() && observations.window_s < min_window_s) {
      throw std::runtime_error("stopped before it could observe the system");
    }
    const auto findings = diagnose(observations);
    if (json) {
      sonopose::apps::print("{}\n", json_of(findings));
    } else {
      sonopose::apps::print("{}", report_of(findings, verbose));
    }
    return has_problems(findings) ? 1 : 0;
  });
}
