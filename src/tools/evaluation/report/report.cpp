#include "evaluation/report/report.hpp"

#include "evaluation/report/prediction_report.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace sonopose::evaluation {
namespace {

double times_real_time(const RunResult& result, const Timing& timing) {
  const double took_s = timing.reading_s + timing.running_s;
  return took_s > 0.0 ? result.duration_s / took_s : 0.0;
}

std::string report_line(std::string_view what, const std::string& text) {
  return fmt::format("{:<12} {}\n", what, text);
}

/// Returns a line with one value; NaN means that the truth does not contain it.
std::string figure(std::string_view what, double value, int decimals, std::string_view unit) {
  return report_line(what, std::isnan(value) ? "       - not known"
                                             : fmt::format("{:8.{}f} {} RMSE", value, decimals, unit));
}

/// Counts the flags, except "used": "2 outlier, 37 frozen".
template <class CountOf>
std::string flag_words(const CountOf& count_of) {
  std::string text;
  for (const FixFlagName& entry : fix_flag_names) {
    const std::uint64_t count = count_of(entry.bit);
    if (entry.bit == fix_used || count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, entry.name);
  }
  return text;
}

/// Lists used and rejected fixes, each with its flags.
std::string fixes_text(const RunResult& result) {
  const FixFlagCounts& rejected = result.rejected_fix_flags;
  const std::string why = flag_words([&](FixFlag bit) { return rejected.of(bit); });
  const std::string notes =
      flag_words([&](FixFlag bit) { return result.fix_flags.of(bit) - rejected.of(bit); });
  std::string text =
      report_line("fixes", fmt::format("{:8} used, {} of them down-weighted, {} rejected{}",
                                       result.counters.fixes_used, result.fixes_down_weighted,
                                       result.counters.fixes_rejected, why.empty() ? "" : " (" + why + ")"));
  if (!notes.empty()) text += report_line("", "         of the used ones: " + notes);
  return text;
}

std::string scores(const RunResult& result) {
  if (!result.has_truth) return report_line("error", "not known: the recording has no truth");
  if (result.fused.poses == 0)
    return report_line("error", "not known: no pose with a known true position was scored");
  const ErrorSummary& position_m = result.fused.position_m;
  std::string text = report_line(
      "position", fmt::format("{:8.4f} m RMSE, {:.4f} m p95, {:.4f} m max, over {}", position_m.rmse,
                              position_m.p95, position_m.max, text::count_text(result.fused.poses, "pose")));
  text += report_line(
      "no truth", fmt::format("{:8} {} not scored", result.fused.poses_without_truth,
                              result.fused.poses_without_truth == 1 ? "pose, which is" : "poses, which are"));
  text += figure("velocity", result.fused.velocity_rmse_mps, 4, "m/s");
  text += figure("yaw", result.fused.yaw_rmse_deg, 3, "deg");
  text += figure("tilt", result.fused.tilt_rmse_deg, 3, "deg");
  text += figure("last fix", result.last_fix_m.rmse, 4, "m");
  return text + figure("extrapolated", result.extrapolated_m.rmse, 4, "m");
}

std::string smoothing_text(const RunResult& result) {
  if (!result.smoothing) return "";
  const Score& engine = result.smoothing->engine;
  const estimation::offline::Noise& noise = result.smoothing->noise;
  std::string text;
  if (engine.poses > 0 && result.fused.poses > 0) {
    text += report_line("unsmoothed",
                        fmt::format("{:8.4f} m RMSE, {:.4f} m p95, {:.4f} m max", engine.position_m.rmse,
                                    engine.position_m.p95, engine.position_m.max));
    text += report_line("ratio", fmt::format("{:8.3f} position RMSE, smoothed over unsmoothed",
                                             result.fused.position_m.rmse / engine.position_m.rmse));
  }
  return text +
         report_line("noise", fmt::format("{:8.4f} m/s2/rtHz, {:.5f} rad/s/rtHz, gyro bias {:.5f} rad/s/rts, "
                                          "fixes {:.2f} x that of the engine",
                                          noise.process.accel_mps2_rthz, noise.process.gyro_radps_rthz,
                                          noise.process.gyro_bias_radps_rts, noise.fix_scale));
}

/// Share of the poses with this warning.
double share_of(const RunResult& result, PoseStatus bit) {
  const auto found = result.warned.find(bit);
  if (found == result.warned.end()) return 0.0;
  return static_cast<double>(found->second) / static_cast<double>(result.judged_poses);
}

/// Shares of the poses with a warning, unless they are few.
std::string warnings_of(const RunResult& result) {
  constexpr double min_share = 0.005;
  std::string text;
  for (const auto& [bit, name] : run_warnings) {
    const double share = share_of(result, bit);
    if (share >= min_share) text += fmt::format("{}{:.1f} % {}", text.empty() ? "" : ", ", 100 * share, name);
  }
  return text.empty() ? text : text + " of the poses";
}

/// {"imu_inconsistent": 0.1, …}
nlohmann::ordered_json warnings_json(const RunResult& result) {
  nlohmann::ordered_json shares;
  for (const auto& [bit, name] : run_warnings) {
    std::string key(name);
    std::ranges::transform(key, key.begin(), [](char c) {
      return c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    });
    shares[key] = share_of(result, bit);
  }
  return shares;
}

nlohmann::ordered_json smoothing_json(const RunResult& result) {
  if (!result.smoothing) return nullptr;
  const Score& engine = result.smoothing->engine;
  const estimation::offline::Noise& noise = result.smoothing->noise;
  return {{"unsmoothed_position_rmse_m", engine.position_m.rmse},
          {"unsmoothed_position_p95_m", engine.position_m.p95},
          {"unsmoothed_position_max_m", engine.position_m.max},
          {"unsmoothed_velocity_rmse_mps", engine.velocity_rmse_mps},
          {"unsmoothed_yaw_rmse_deg", engine.yaw_rmse_deg},
          {"unsmoothed_tilt_rmse_deg", engine.tilt_rmse_deg},
          {"position_ratio", result.fused.position_m.rmse / engine.position_m.rmse},
          {"accel_noise_mps2_rthz", noise.process.accel_mps2_rthz},
          {"gyro_noise_radps_rthz", noise.process.gyro_radps_rthz},
          {"gyro_bias_walk_radps_rts", noise.process.gyro_bias_radps_rts},
          {"fix_noise_scale", noise.fix_scale}};
}

}  // namespace

std::string report_text(const RunResult& result, const Timing& timing) {
  const EstimatorCounters& counters = result.counters;
  std::string text = scores(result) + smoothing_text(result) + prediction_text(result.prediction);
  text += fixes_text(result);
  text += report_line("samples",
                      fmt::format("{:8} IMU, {}, {}, {} invalid, {} went back", counters.imu_samples,
                                  text::count_text(counters.headings, "heading"),
                                  text::count_text(counters.imu_gaps, "IMU gap"), counters.samples_invalid,
                                  text::count_text(result.imu_stamps_back, "IMU stamp")));
  if (const std::string warnings = warnings_of(result); !warnings.empty())
    text += report_line("warnings", warnings);
  if (const auto twists = counters.twists_used + counters.twists_rejected + counters.twists_unused;
      twists > 0) {
    text += report_line("velocities", fmt::format("{:8} used, {} rejected, {} not used", counters.twists_used,
                                                  counters.twists_rejected, counters.twists_unused));
  }
  text += report_line(
      "duration",
      fmt::format("{:8.2f} s, replayed at {:.0f} x real time (reading {:.3f} s, engine {:.3f} s)",
                  result.duration_s, times_real_time(result, timing), timing.reading_s, timing.running_s));
  return text + report_line("state hash", result.state_hash);
}

std::string report_json(const RunResult& result, const Timing& timing) {
  // The JSON library writes NaN (unknown) as null.
  nlohmann::ordered_json fix_flags = nlohmann::ordered_json::object();
  for (const FixFlagName& entry : fix_flag_names)
    fix_flags[std::string(entry.name)] = result.fix_flags.of(entry.bit);
  const nlohmann::ordered_json object{{"position_rmse_m", result.fused.position_m.rmse},
                                      {"position_p95_m", result.fused.position_m.p95},
                                      {"position_max_m", result.fused.position_m.max},
                                      {"yaw_rmse_deg", result.fused.yaw_rmse_deg},
                                      {"tilt_rmse_deg", result.fused.tilt_rmse_deg},
                                      {"velocity_rmse_mps", result.fused.velocity_rmse_mps},
                                      {"last_fix_rmse_m", result.last_fix_m.rmse},
                                      {"extrapolated_rmse_m", result.extrapolated_m.rmse},
                                      {"poses_scored", result.fused.poses},
                                      {"poses_without_truth", result.fused.poses_without_truth},
                                      {"smoothing", smoothing_json(result)},
                                      {"prediction", prediction_json(result.prediction)},
                                      {"fixes_used", result.counters.fixes_used},
                                      {"fixes_down_weighted", result.fixes_down_weighted},
                                      {"fixes_rejected", result.counters.fixes_rejected},
                                      {"fix_flags", std::move(fix_flags)},
                                      {"warnings", warnings_json(result)},
                                      {"imu_samples", result.counters.imu_samples},
                                      {"headings", result.counters.headings},
                                      {"twists_used", result.counters.twists_used},
                                      {"twists_rejected", result.counters.twists_rejected},
                                      {"twists_unused", result.counters.twists_unused},
                                      {"imu_gaps", result.counters.imu_gaps},
                                      {"samples_invalid", result.counters.samples_invalid},
                                      {"imu_stamps_back", result.imu_stamps_back},
                                      {"poses", result.poses},
                                      {"duration_s", result.duration_s},
                                      {"reading_s", timing.reading_s},
                                      {"running_s", timing.running_s},
                                      {"times_real_time", times_real_time(result, timing)},
                                      {"last_sequence", result.end.sequence},
                                      {"state_hash", result.state_hash}};
  return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace sonopose::evaluation
