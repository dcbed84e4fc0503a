#include "plots/gnuplot.hpp"
#include "plots/layout.hpp"
#include "plots/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace sonopose::plots {
namespace {

// Colours that colour-blind readers can distinguish (Okabe and Ito), and faint ones for the background.
constexpr std::string_view fused_colour = "#0072B2";
constexpr std::string_view truth_colour = "#000000";
constexpr std::string_view used_colour = "#009E73";
constexpr std::string_view outlier_colour = "#E69F00";
constexpr std::string_view rejected_colour = "#D55E00";
constexpr std::string_view faint_colour = "#B0B0B0";
constexpr std::string_view stale_colour = "#F3CFC0";
constexpr std::string_view converging_colour = "#FFF2B8";

/// A row of marks below weight and trust, and the flags that it shows.
struct FlagRow {
  std::string_view label;
  std::uint32_t fix_flags;
  std::string_view colour;
};

constexpr std::array<FlagRow, 8> flag_rows{{{"outlier", fix_outlier, outlier_colour},
                                            {"low quality", fix_low_quality, rejected_colour},
                                            {"invalid", fix_invalid, rejected_colour},
                                            {"too late", fix_too_late, rejected_colour},
                                            {"frozen", fix_frozen, rejected_colour},
                                            {"snapped", fix_snapped_over | fix_snapped_under, "#CC79A7"},
                                            {"forced", fix_stuck_forced, "#CC79A7"},
                                            {"start", fix_first | fix_stale_recovered, fused_colour}}};

void append_data(std::string& script, const PlotData& data) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$poses << END\n");
  for (const auto& moment : data.moments) {
    const bool placed =
        bit(moment.status, status_initialising) == 0;  // the position is zero before the first fix
    constexpr double unknown = PlotData::unknown;
    fmt::format_to(out, "{:.4f} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.5g} {:.4g}\n",
                   moment.time_s, placed ? moment.position_world_m.x() : unknown,
                   placed ? moment.position_world_m.y() : unknown, moment.true_position_world_m.x(),
                   moment.true_position_world_m.y(), moment.speed_mps, moment.true_speed_mps,
                   100.0 * (placed ? moment.error_m : unknown), 100.0 * moment.last_fix_error_m,
                   moment.trust);
  }
  fmt::format_to(out, "END\n$fixes << END\n");
  for (const auto& fix : data.fixes) {
    fmt::format_to(out, "{:.4f} {:.5g} {:.5g} {:.5g} {:.4g} {:.4g} {} {}\n", fix.time_s,
                   fix.position_world_m.x(), fix.position_world_m.y(), 100.0 * fix.innovation_m, fix.weight,
                   fix.speed_mps, class_of(fix.flags), fix.flags);
  }
  fmt::format_to(out, "END\n");
}

/// Writes only changes, to keep the plot of an hour small.
void append_status(std::string& script, const PlotData& data) {
  auto out = std::back_inserter(script);
  fmt::format_to(out, "$status << END\n");
  int before = -1;
  const auto* const last = data.moments.empty() ? nullptr : &data.moments.back();
  for (const auto& moment : data.moments) {
    const int stale = bit(moment.status, status_stale);
    const int converging = bit(moment.status, status_converging);
    const int now = 2 * stale + converging;
    if (now == before && &moment != last) continue;
    fmt::format_to(out, "{:.4f} {} {}\n", moment.time_s, stale, converging);
    before = now;
  }
  fmt::format_to(out, "END\n");
}

/// Plot element for the fixes of one class; `columns` is x:y.
std::string fix_points(std::string_view columns, int kind, std::string_view title) {
  constexpr std::array<std::string_view, 3> colours{used_colour, outlier_colour, rejected_colour};
  constexpr std::array<int, 3> shapes{7, 9, 2};  // disc, triangle, cross
  constexpr std::array<double, 3> sizes{0.45, 0.9, 0.9};
  const auto k = static_cast<std::size_t>(kind);
  return fmt::format("$fixes using {} with points pt {} ps {} lc rgb '{}' title {}", columns, shapes[k],
                     sizes[k], colours[k], plot_text(title));
}

/// The first `kinds` classes of fixes.
std::string fixes_by_kind(std::string_view x, std::string_view y, int kinds) {
  constexpr std::array<std::string_view, 3> titles{"fix used", "outlier", "rejected"};
  std::string text;
  for (int kind = 0; kind < kinds; ++kind) {
    text += (kind == 0 ? "" : ", \\\n  ") + fix_points(fmt::format("{}:($7=={}?{}:NaN)", x, kind, y), kind,
                                                       titles[static_cast<std::size_t>(kind)]);
  }
  return text;
}

/// Shaded time spans of the status, in the background.
std::string shades(bool with_titles) {
  const auto shade = [with_titles](int column, std::string_view colour, std::string_view title) {
    return fmt::format("$status using 1:{} axes x1y2 with fillsteps fs solid 1 noborder lc rgb '{}' {}",
                       column, colour, with_titles ? "title " + plot_text(title) : "notitle");
  };
  return shade(3, converging_colour, "converging") + ", \\\n  " + shade(2, stale_colour, "stale") +
         ", \\\n  ";
}

/// Margins of a panel, and its vertical label at a fixed distance, independent of the tic labels.
void append_frame(std::string& script, const Panel& panel, std::string_view label) {
  constexpr double label_distance = 0.056;
  fmt::format_to(
      std::back_inserter(script),
      "set lmargin at screen {}; set rmargin at screen {}; set bmargin at screen {}; set tmargin at "
      "screen {}\nset label 1 {} at screen {}, screen {} center rotate\n",
      panel.left, panel.right, panel.bottom, panel.top, plot_text(label), panel.left - label_distance,
      0.5 * (panel.bottom + panel.top));
}

void append_path(std::string& script, const PlotData& data) {
  const Box box = path_box(data);
  append_frame(script, path_panel, "y [m]");
  const std::string truth = fmt::format(
      "$poses using 4:5 with lines lw 1.2 dt (8,5) lc rgb '{}' title 'truth', \\\n  ", truth_colour);
  fmt::format_to(
      std::back_inserter(script),
      "set size ratio -1\nset xlabel 'x [m]'\nset xrange [{:.5g}:{:.5g}]; set yrange [{:.5g}:{:.5g}]\n"
      "plot {}, \\\n  {}$poses using 2:3 with lines lw 1.6 lc rgb '{}' title 'fused'\n"
      "unset xlabel\nset size noratio\n",
      box.low.x(), box.high.x(), box.low.y(), box.high.y(), fixes_by_kind("2", "$3", 3),
      data.has_truth ? truth : std::string(), fused_colour);
}

void append_errors(std::string& script, const PlotData& data) {
  const bool errors = data.has_truth;
  append_frame(script, error_panel, errors ? "position error [cm]" : "innovation of fixes [cm]");
  script += (errors ? axis_of_errors(data) : axis_of_innovations(data)) + "plot " + shades(true);
  if (!errors) {
    script += fixes_by_kind("1", "$4", 2) + "\n";
    return;
  }
  fmt::format_to(std::back_inserter(script),
                 "$poses using 1:9 with lines lw 1 lc rgb '{}' title 'last fix', \\\n"
                 "  $poses using 1:8 with lines lw 1.4 lc rgb '{}' title 'fused'\n",
                 faint_colour, fused_colour);
}

void append_speed(std::string& script, const PlotData& data) {
  append_frame(script, speed_panel, "speed [m/s]");
  fmt::format_to(std::back_inserter(script), "unset logscale y\nset yrange [0:{:.4g}]\nplot {}",
                 top_of_speeds_mps(data), shades(false));
  if (data.has_truth) {
    fmt::format_to(std::back_inserter(script),
                   "$poses using 1:7 with lines lw 1.6 lc rgb '{}' title 'truth', \\\n  ", truth_colour);
  } else {
    fmt::format_to(std::back_inserter(script),
                   "$fixes using 1:6 with points pt 7 ps 0.3 lc rgb '{}' title 'between used fixes', \\\n  ",
                   faint_colour);
  }
  fmt::format_to(std::back_inserter(script), "$poses using 1:6 with lines lw 1.4 lc rgb '{}' title 'fused'\n",
                 fused_colour);
}

/// Weight and trust, and below them a row of marks for each flag that occurred.
void append_fix_flags(std::string& script, const PlotData& data) {
  constexpr double row_height = 0.2;
  std::string tics = "'0' 0, '0.5' 0.5, '1' 1";
  std::string marks;
  double y = 0.0;
  for (const FlagRow& row : flag_rows) {
    const bool occurred = std::any_of(data.fixes.begin(), data.fixes.end(),
                                      [&row](const auto& fix) { return (fix.flags & row.fix_flags) != 0; });
    if (!occurred) continue;
    y -= row_height;
    tics += fmt::format(", {} {:.1f}", plot_text(row.label), y);
    marks += fmt::format(
        ", \\\n  $fixes using 1:((int($8)&{})?{:.1f}:NaN) with points pt 2 ps 0.7 lc rgb '{}' notitle",
        row.fix_flags, y, row.colour);
  }
  append_frame(script, fix_flag_panel, "fix flags           weight, trust");
  fmt::format_to(
      std::back_inserter(script),
      "set ytics ({})\nset yrange [{:.1f}:1.05]\nset xlabel 'time [s]'\nset format x '%g'\nplot {}", tics,
      y - row_height, shades(false));
  fmt::format_to(
      std::back_inserter(script),
      "$poses using 1:10 with steps lw 1.4 lc rgb '{}' title 'trust', \\\n  "
      "$fixes using 1:($7==2?NaN:$5) with points pt 7 ps 0.3 lc rgb '{}' title 'weight of a fix'{}\n",
      fused_colour, used_colour, marks);
}

}  // namespace

std::string gnuplot_script(const PlotData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending) {
  const bool png = ending == ".png";
  const double end_s = data.moments.empty() ? 1.0 : data.moments.back().time_s;
  const double begin_s = data.moments.empty() ? 0.0 : data.moments.front().time_s;
  std::string script;
  append_data(script, data);
  append_status(script, data);
  fmt::format_to(
      std::back_inserter(script),
      "set terminal {} size {},{} font 'sans,12' background rgb 'white' noenhanced\n"
      "set output {}\nset datafile missing 'nan'\nset multiplot title {} font 'sans,14' noenhanced\n"
      "set grid xtics ytics lt 1 lw 0.7 lc rgb '#E4E4E4'\nset tics nomirror\nset border 3 lc rgb '#444444'\n"
      "set key at graph 0, graph 1.0 left bottom Left reverse horizontal samplen 1.6 width 0.5\n",
      png ? "pngcairo" : "svg", plot_width, plot_height, plot_text(file.string()), plot_text(data.title));
  append_path(script, data);
  fmt::format_to(std::back_inserter(script),
                 "set xrange [{:.4f}:{:.4f}]\n"
                 "set y2range [0:1]\nunset y2tics\nset format x ''\n",
                 begin_s, std::max(end_s, begin_s + 1e-3));
  append_errors(script, data);
  append_speed(script, data);
  append_fix_flags(script, data);
  script += "unset multiplot\nunset output\n";
  return script;
}

}  // namespace sonopose::plots
