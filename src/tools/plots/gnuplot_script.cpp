#include "plots/data_blocks.hpp"
#include "plots/gnuplot.hpp"
#include "plots/layout.hpp"
#include "plots/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::plots {
namespace {

// Colours that colour-blind readers can distinguish (Okabe and Ito), and faint ones for the background.
constexpr std::array<std::string_view, 2> run_colours{"#0072B2", "#CC79A7"};
constexpr std::array<std::string_view, 2> band_colours{"#CFE4F2", "#F5DFEA"};
constexpr std::string_view truth_colour = "#000000";
constexpr std::string_view used_colour = "#009E73";
constexpr std::string_view outlier_colour = "#E69F00";
constexpr std::string_view rejected_colour = "#D55E00";
constexpr std::string_view faint_colour = "#B0B0B0";
constexpr std::string_view stale_colour = "#F3CFC0";
constexpr std::string_view converging_colour = "#FFF2B8";
constexpr std::string_view silent_colour = "#DDDDDD";

/// A row of marks below weight and trust, and its flags.
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
                                            {"first", fix_first | fix_stale_recovered, run_colours[0]}}};

using Elements = std::vector<std::string>;

bool compares(const PlotData& data) {
  return data.runs.size() > 1;
}

/// Returns a curve of each run: `columns` of its block `block`, named after the run, or `name` if there is
/// one run.
Elements curves(const PlotData& data, std::string_view block, std::string_view columns,
                std::string_view style, std::string_view name) {
  Elements elements;
  for (std::size_t i = 0; i < data.runs.size(); ++i) {
    elements.push_back(fmt::format("${}{} using {} with {} lc rgb '{}' title {}", block, i, columns, style,
                                   run_colours.at(i),
                                   plot_text(compares(data) ? data.runs[i].name() : name)));
  }
  return elements;
}

/// Returns the ±3σ band of each run; `columns` is x:low:high.
Elements bands(const PlotData& data, std::string_view block, std::string_view columns) {
  Elements elements;
  for (std::size_t i = 0; i < data.runs.size(); ++i) {
    elements.push_back(fmt::format("${}{} using {} with filledcurves fs solid 0.5 noborder lc rgb '{}' {}",
                                   block, i, columns, band_colours.at(i),
                                   compares(data) ? "notitle" : "title '±3σ'"));
  }
  return elements;
}

std::string truth_curve(std::string_view columns, std::string_view block) {
  return fmt::format("${}0 using {} with lines lw 1.2 dt (8,5) lc rgb '{}' title 'truth'", block, columns,
                     truth_colour);
}

/// Returns the fixes of the first run by class, without classes that have none. `x` and `y` are columns.
Elements fixes_by_kind(const PlotData& data, std::string_view x, std::string_view y) {
  constexpr std::array<std::string_view, 3> titles{"fix used", "down-weighted", "rejected"};
  constexpr std::array<std::string_view, 3> colours{used_colour, outlier_colour, rejected_colour};
  constexpr std::array<int, 3> shapes{7, 9, 2};  // disc, triangle, cross
  constexpr std::array<double, 3> sizes{0.4, 0.8, 0.8};
  Elements elements;
  const auto& fixes = data.runs.front().fixes();
  for (std::size_t k = 0; k < titles.size(); ++k) {
    const int kind = static_cast<int>(k);
    const auto is_of_kind = [kind](const FixMark& fix) { return static_cast<int>(fix.verdict) == kind; };
    if (std::none_of(fixes.begin(), fixes.end(), is_of_kind)) continue;
    elements.push_back(
        fmt::format("$fixes0 using {}:($11=={}?{}:NaN) with points pt {} ps {} lc rgb '{}' title {}", x, kind,
                    y, shapes[k], sizes[k], colours[k], plot_text(titles[k])));
  }
  return elements;
}

void append(Elements& elements, const Elements& more) {
  elements.insert(elements.end(), more.begin(), more.end());
}

/// Returns a shaded time span for the background. `columns` is time:height.
std::string shade(std::string_view columns, std::string_view colour, std::string_view title) {
  return fmt::format("{} axes x1y2 with fillsteps fs solid 1 noborder lc rgb '{}' {}", columns, colour,
                     title.empty() ? "notitle" : "title " + plot_text(title));
}

/// Returns the shaded silences of the IMU. `top`: upper end of the second y axis.
Elements silences(const PlotData& data, bool with_title = false, int top = 1) {
  if (data.runs.front().silences().empty()) return {};
  return {
      shade(fmt::format("$silences using 1:({}*$2)", top), silent_colour, with_title ? "IMU silent" : "")};
}

/// Returns shaded time spans of the status, for the background.
Elements shades(const PlotData& data, bool with_titles) {
  const auto& moments = data.runs.front().moments();
  const auto occurs = [&moments](PoseStatus bit) {
    return std::any_of(moments.begin(), moments.end(),
                       [bit](const Moment& moment) { return (moment.status & bit) != 0U; });
  };
  Elements elements;
  if (occurs(status_converging))
    elements.push_back(shade("$status using 1:3", converging_colour, with_titles ? "converging" : ""));
  if (occurs(status_stale)) {
    elements.push_back(shade("$status using 1:2", stale_colour, with_titles ? "stale" : ""));
  }
  append(elements, silences(data, with_titles));
  return elements;
}

/// Sets the margins of a panel, and its vertical label at a fixed distance, independent of the tic labels.
void append_frame(std::string& script, const Panel& panel, std::string_view label) {
  constexpr double label_distance = 0.052;
  fmt::format_to(
      std::back_inserter(script),
      "set lmargin at screen {}; set rmargin at screen {}; set bmargin at screen {}; set tmargin at "
      "screen {}\nset label 1 {} at screen {}, screen {} center rotate\n",
      panel.left, panel.right, panel.bottom, panel.top, plot_text(label), panel.left - label_distance,
      0.5 * (panel.bottom + panel.top));
}

void append_plot(std::string& script, const Elements& elements) {
  fmt::format_to(std::back_inserter(script), "plot {}\n", fmt::join(elements, ", \\\n  "));
}

void append_path(std::string& script, const PlotData& data) {
  const Box box = path_box(data);
  append_frame(script, path_panel, "y [m]");
  fmt::format_to(
      std::back_inserter(script),
      "set size ratio -1\nset xlabel 'x [m]'\nset xrange [{:.3f}:{:.3f}]; set yrange [{:.3f}:{:.3f}]\n",
      box.low.x(), box.high.x(), box.low.y(), box.high.y());
  Elements elements = fixes_by_kind(data, "2", "$3");
  if (data.has_truth) elements.push_back(truth_curve("3:4", "path"));
  append(elements, curves(data, "path", "1:2", "lines lw 1.6", "fused"));
  if (!compares(data)) {
    elements.push_back(fmt::format(
        "$ellipses0 using 1:2:3:4:5 with ellipses units xx fs empty border lc rgb '{}' title '3σ'",
        run_colours[0]));
  }
  append_plot(script, elements);
  script += "unset xlabel\nset size noratio\n";
}

void append_histograms(std::string& script, const PlotData& data) {
  double half_width_m = 0;
  for (const RunCurves& run : data.runs) half_width_m = std::max(half_width_m, run.histogram().half_width_m);
  const auto draw = [&](const Panel& panel, std::string_view column, std::string_view title) {
    append_frame(script, panel, panel.left < 0.2 ? "share of used fixes [%]" : "");
    fmt::format_to(std::back_inserter(script),
                   "set xlabel {}\nset xrange [*:*]; set yrange [0:*]\nset xtics {:.4g}\n", plot_text(title),
                   tic_step(200.0 * half_width_m));
    append_plot(script, curves(data, "histogram", fmt::format("1:{}", column),
                               compares(data) ? "histeps lw 1.5" : "boxes fs solid 0.5 noborder", ""));
  };
  draw(along_histogram_panel, "2", "innovation along the track [cm]");
  draw(left_histogram_panel, "3", "innovation to the left [cm]");
  script += "unset xlabel\nset xtics auto\n";
}

// Panels over time

void plot_errors(std::string& script, const PlotData& data) {
  script += axis_of_errors(data);
  Elements elements = shades(data, true);
  elements.push_back(
      fmt::format("$poses0 using 1:5 with lines lw 1 lc rgb '{}' title 'last fix'", faint_colour));
  if (!compares(data)) {
    elements.push_back(
        fmt::format("$poses0 using 1:11 with lines lw 1 dt (3,3) lc rgb '{}' title '3σ'", run_colours[0]));
  }
  append(elements, curves(data, "poses", "1:4", "lines lw 1.4", "fused"));
  append_plot(script, elements);
  script += "unset logscale y\n";
}

/// `column`: that of the innovation; its 3σ is two columns further.
void plot_innovations(std::string& script, const PlotData& data, int column) {
  script += axis_of_innovations(data);
  Elements elements = shades(data, !data.has_truth && column == 5);
  if (compares(data)) {
    append(elements, curves(data, "fixes", fmt::format("1:{}", column), "points pt 7 ps 0.3", ""));
  } else {
    for (const std::string_view sign : {"", "-"}) {
      elements.push_back(fmt::format("$fixes0 using 1:({}${}) with lines lw 1 lc rgb '{}' {}", sign,
                                     column + 2, faint_colour, sign.empty() ? "title '±3σ'" : "notitle"));
    }
    append(elements, fixes_by_kind(data, "1", fmt::format("${}", column)));
  }
  append_plot(script, elements);
}

void plot_heights(std::string& script, const PlotData& data) {
  script += axis_of_heights(data);
  Elements elements = silences(data);
  append(elements, bands(data, "poses", "1:8:9"));
  elements.push_back(fmt::format(
      "$fixes0 using 1:($11==0?$4:NaN) with points pt 7 ps 0.25 lc rgb '{}' title 'fix used'", used_colour));
  if (data.has_truth) elements.push_back(truth_curve("1:10", "poses"));
  append(elements, curves(data, "poses", "1:7", "lines lw 1.4", "fused"));
  append_plot(script, elements);
  script += "set ytics auto\n";
}

void plot_yaws(std::string& script, const PlotData& data) {
  script += "set yrange [-180:180]; set ytics 90\n";
  Elements elements = silences(data);
  append(elements, bands(data, "yaw", "1:3:4"));
  if (!data.arrivals.headings.empty()) {
    elements.push_back(fmt::format(
        "$headings using 1:2 with points pt 7 ps 0.25 lc rgb '{}' title 'pair − mount offset'", used_colour));
  }
  if (data.has_truth) elements.push_back(truth_curve("1:5", "yaw"));
  append(elements, curves(data, "yaw", "1:2", "lines lw 1.4", "fused"));
  append_plot(script, elements);
  script += "set ytics auto\n";
}

void plot_speeds(std::string& script, const PlotData& data) {
  script += axis_of_speeds(data);
  Elements elements = silences(data);
  elements.push_back(
      data.has_truth
          ? truth_curve("1:3", "poses")
          : fmt::format("$fixes0 using 1:10 with points pt 7 ps 0.25 lc rgb '{}' title 'between used fixes'",
                        faint_colour));
  append(elements, curves(data, "poses", "1:2", "lines lw 1.4", "fused"));
  append_plot(script, elements);
}

void plot_delays(std::string& script, const PlotData& data) {
  script += axis_of_delays(data);
  constexpr int top_percent = 105;
  fmt::format_to(std::back_inserter(script), "set y2tics 50 textcolor rgb '{}'\nset y2range [0:{}]\n",
                 outlier_colour, top_percent);
  Elements elements = silences(data, false, top_percent);
  elements.push_back(fmt::format(
      "$arrivals using 1:2 with points pt 7 ps 0.25 lc rgb '{}' title 'delay of a fix'", used_colour));
  elements.push_back(
      fmt::format("$arrivals using 1:3 axes x1y2 with points pt 7 ps 0.25 lc rgb '{}' title 'quality [%]'",
                  outlier_colour));
  append_plot(script, elements);
  script += "unset y2tics\nset y2range [0:1]\nset ytics auto\n";
}

/// Plots weight and trust, and below them a row of marks for each flag that occurred.
void plot_fix_flags(std::string& script, const PlotData& data) {
  constexpr double row_height = 0.25;
  std::string tics = "'0' 0, '1' 1";
  Elements elements = shades(data, false);
  append(elements, curves(data, "poses", "1:6", "steps lw 1.4", "trust"));
  if (!compares(data)) {
    elements.push_back(fmt::format(
        "$fixes0 using 1:($11==2?NaN:$9) with points pt 7 ps 0.25 lc rgb '{}' title 'weight of a fix'",
        used_colour));
  }
  double y = 0.0;
  const auto& fixes = data.runs.front().fixes();
  for (const FlagRow& row : flag_rows) {
    const bool occurred = std::any_of(fixes.begin(), fixes.end(), [&row](const FixMark& fix) {
      return (fix.seen_flags & row.fix_flags) != 0;
    });
    if (!occurred) continue;
    y -= row_height;
    tics += fmt::format(", {} {:.2f}", plot_text(row.label), y);
    elements.push_back(
        fmt::format("$fixes0 using 1:((int($12)&{})?{:.2f}:NaN) with points pt 2 ps 0.6 lc rgb '{}' notitle",
                    row.fix_flags, y, row.colour));
  }
  fmt::format_to(std::back_inserter(script),
                 "set ytics ({})\nset yrange [{:.2f}:1.05]\nset xlabel 'time [s]'\nset format x '%g'\n", tics,
                 y - row_height);
  append_plot(script, elements);
}

void append_time_panels(std::string& script, const PlotData& data) {
  struct TimePanel {
    std::string_view label;
    std::function<void(std::string&)> plot;
  };
  const auto with = [&data](auto plot) { return [plot, &data](std::string& text) { plot(text, data); }; };
  std::vector<TimePanel> panels;
  if (data.has_truth) panels.push_back({"position error [cm]", with(plot_errors)});
  panels.push_back({"along [cm]", [&](std::string& text) { plot_innovations(text, data, 5); }});
  panels.push_back({"left [cm]", [&](std::string& text) { plot_innovations(text, data, 6); }});
  panels.push_back({"z [m]", with(plot_heights)});
  panels.push_back({"yaw [deg]", with(plot_yaws)});
  panels.push_back({"speed [m/s]", with(plot_speeds)});
  panels.push_back({"delay [ms]", with(plot_delays)});
  panels.push_back({"", with(plot_fix_flags)});
  for (std::size_t row = 0; row < panels.size(); ++row) {
    append_frame(script, time_panel(static_cast<int>(row), static_cast<int>(panels.size())),
                 panels[row].label);
    panels[row].plot(script);
  }
}

/// Returns the recording, and below it the settings of each run, in lines that fit.
std::string title_of(const PlotData& data) {
  constexpr std::size_t max_line_bytes = 180;
  std::string title = data.title;
  for (const RunCurves& run : data.runs) {
    std::string line = compares(data) ? run.name() + ": " + run.settings_text() : run.settings_text();
    for (std::size_t end = max_line_bytes; end < line.size(); end += max_line_bytes) {
      end = line.rfind(' ', end);
      if (end == std::string::npos || end == 0) break;
      line[end] = '\n';
    }
    title += "\n" + line;
  }
  return title;
}

/// Quotes text in double quotes, in which a backslash escape breaks the line.
std::string lines_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char character : text) {
    if (character == '\n') {
      quoted += "\\n";
    } else if (character == '"' || character == '\\' || character == '`') {
      quoted += std::string("\\") + character;
    } else {
      quoted += character;
    }
  }
  return quoted + '"';
}

}  // namespace

std::string gnuplot_script(const PlotData& data, const std::filesystem::path& file,
                           const std::filesystem::path& ending) {
  const bool png = ending == ".png";
  const auto& moments = data.runs.front().moments();
  const double begin_s = moments.empty() ? 0.0 : moments.front().time_s;
  const double end_s = moments.empty() ? 1.0 : moments.back().time_s;
  std::string script = "set encoding utf8\n" + data_blocks(data);
  fmt::format_to(
      std::back_inserter(script),
      "set terminal {} size {},{} font 'sans,12' background rgb 'white' noenhanced\n"
      "set output {}\nset datafile missing 'nan'\nset multiplot title {} font 'sans,13' noenhanced\n"
      "set grid xtics ytics lt 1 lw 0.7 lc rgb '#E4E4E4'\nset tics nomirror\nset border 3 lc rgb '#444444'\n"
      "set key at graph 0, graph 1.0 left bottom Left reverse horizontal samplen 1.6 width 0.5\n",
      png ? "pngcairo" : "svg", plot_width, plot_height, plot_text(file.string()),
      lines_text(title_of(data)));
  append_path(script, data);
  append_histograms(script, data);
  fmt::format_to(std::back_inserter(script),
                 "set xrange [{:.4f}:{:.4f}]\n"
                 "set y2range [0:1]\nunset y2tics\nset format x ''\n",
                 begin_s, std::max(end_s, begin_s + 1e-3));
  append_time_panels(script, data);
  script += "unset multiplot\nunset output\n";
  return script;
}

}  // namespace sonopose::plots
