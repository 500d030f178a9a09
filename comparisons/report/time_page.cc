#include "comparisons/report/time_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "comparisons/report/embedded.h"
#include "comparisons/report/html.h"
#include "comparisons/report/page.h"

namespace softfinger::report {
namespace {

constexpr double kChartWidth = 420, kChartHeight = 230, kLeft = 56, kRight = 20, kTop = 14,
                 kBottom = 40;

/// A straight axis from numbers to pixels.
struct TimeAxis {
  double least, most, first_pixel, last_pixel;
  double operator()(double value) const {
    return first_pixel + (value - least) / (most - least) * (last_pixel - first_pixel);
  }
};

/// Four to eight round numbers within the range.
std::vector<double> round_ticks(double least, double most) {
  double step = std::pow(10, std::floor(std::log10((most - least) / 4)));
  for (const double factor : {2., 5., 10.})
    if ((most - least) / step > 8) step *= factor == 5 ? 2.5 : 2;
  std::vector<double> ticks;
  for (double at = std::ceil(least / step) * step; at <= most + step * 1e-6; at += step)
    ticks.push_back(std::abs(at) < step * 1e-6 ? 0 : at);
  return ticks;
}

std::vector<double> time_ticks(const TimeSeries& series, const TimeAxis& axis) {
  if (!series.is_logarithmic) return round_ticks(axis.least, axis.most);
  std::vector<double> decades;
  for (double k = std::ceil(axis.least); k <= axis.most; ++k) decades.push_back(k);
  return decades;
}

struct TimeLine {
  const std::vector<double>& values;
  double factor;  ///< from SI
  bool is_dashed = false;
};

/// Without the zeros that rounding leaves.
Html tick_text(double value) { return html("{}", plain(std::stod(fmt::format("{:.4g}", value)))); }

Html chart(const TimeSeries& series, const char* heading, const char* unit,
           const std::vector<TimeLine>& lines) {
  const auto place = [&](double time_s) {
    return series.is_logarithmic ? std::log10(time_s) : time_s;
  };
  // On a logarithmic axis the time 0 has no place.
  const std::size_t first = series.is_logarithmic && series.time_s.front() <= 0 ? 1 : 0;
  if (series.time_s.size() < first + 2) return "";
  double least = lines[0].values[first] * lines[0].factor, most = least;
  for (const TimeLine& line : lines)
    for (std::size_t i = first; i < line.values.size(); ++i) {
      least = std::min(least, line.values[i] * line.factor);
      most = std::max(most, line.values[i] * line.factor);
    }
  // A quantity that stays is a line in the middle, not noise over the whole height.
  const double margin = std::max(0.08 * (most - least), 0.02 * std::abs(most));
  const TimeAxis x{place(series.time_s[first]), place(series.time_s.back()), kLeft,
                   kChartWidth - kRight};
  const TimeAxis y{std::max(0., least - margin), most + margin, kChartHeight - kBottom, kTop};
  Html shapes;
  for (const double tick : time_ticks(series, x))
    shapes += html(
        "<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"currentColor\" stroke-opacity=\".12\"/><text "
        "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
        x(tick), kTop, kChartHeight - kBottom, x(tick), kChartHeight - kBottom + 16,
        tick_text(series.is_logarithmic ? std::pow(10, tick) : tick));
  for (const double tick : round_ticks(y.least, y.most))
    shapes += html(
        "<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"currentColor\" stroke-opacity=\".12\"/><text "
        "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
        kLeft, y(tick), kChartWidth - kRight, kLeft - 6, y(tick) + 4, tick_text(tick));
  if (std::isfinite(series.marked_s) && series.marked_s > 0 && place(series.marked_s) >= x.least &&
      place(series.marked_s) <= x.most)
    shapes +=
        html("<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"currentColor\" stroke-dasharray=\"2 3\"/>",
             x(place(series.marked_s)), kTop, kChartHeight - kBottom);
  for (const TimeLine& line : lines) {
    Html path;
    for (std::size_t i = first; i < line.values.size(); ++i)
      path += html("{}{:.1f} {:.1f}", i == first ? "M" : "L", x(place(series.time_s[i])),
                   y(line.values[i] * line.factor));
    shapes += html(
        "<path d=\"{}\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.6\" "
        "stroke-dasharray=\"{}\"/>",
        path, line.is_dashed ? "5 4" : "none");
  }
  return html(
             "<figure style=\"display:inline-block;margin:0 1em 1em 0;max-width:100%\">"
             "<figcaption><b>{}</b>, {}</figcaption>"
             "<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" style=\"max-width:100%;font-size:"
             "12px;fill:currentColor\" role=\"img\" aria-label=\"{} against time\">",
             heading, unit, kChartWidth, kChartHeight, kChartWidth, heading) +
         shapes +
         html("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">time, s</text></svg></figure>\n",
              kChartWidth - kRight, kChartHeight - 6);
}

Html numbers_of(const TimeSeries& series) {
  constexpr std::size_t kMostRows = 25;
  const std::size_t count = series.time_s.size();
  const std::size_t step = std::max<std::size_t>(1, (count + kMostRows - 1) / kMostRows);
  Html rows;
  for (std::size_t i = 0; i < count; i = i + step < count || i + 1 == count ? i + step : count - 1)
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>"
        "\n",
        significant(series.time_s[i], 4), significant(series.load_N[i], 4),
        significant(1e3 * series.length_m[i], 4), significant(1e3 * series.width_m[i], 4),
        significant(1e3 * series.indentation_m[i], 4),
        significant(1e3 * series.max_torque_Nm[i], 4));
  return details("The numbers",
                 scrolling_table(column_heading("time", "s") + column_heading("load", "N") +
                                     column_heading("2a", "mm") + column_heading("2b", "mm") +
                                     column_heading("indentation", "mm") +
                                     column_heading("largest torque", "mN·m"),
                                 rows));
}

Html section_of(const TimeSeries& series) {
  if (series.time_s.empty()) return html("<h2>{}</h2>\n<p>Nothing touches.</p>\n", series.title);
  return html("<h2>{}</h2>\n<p>By the model {}.{}</p>\n", series.title, series.model,
              series.marked_s > 0 && std::isfinite(series.marked_s)
                  ? Html(" The dotted line is the time that was asked for.")
                  : Html("")) +
         chart(series, "Contact", "2a and, dashed, 2b, mm",
               {{series.length_m, 1e3}, {series.width_m, 1e3, true}}) +
         chart(series, "Indentation", "mm", {{series.indentation_m, 1e3}}) +
         chart(series, "Largest torque", "mN·m", {{series.max_torque_Nm, 1e3}}) +
         chart(series, "Load", "N", {{series.load_N, 1}}) + numbers_of(series);
}

}  // namespace

std::string time_page(const TimePage& content) {
  Page page;
  page.title = html("{} over time", content.case_id);
  page.styles = {embedded::report_css};
  page.body = html(
      "<h1>{}: contact over time</h1>\n<pre>{}</pre>\n<p>{}</p>\n<p>The rubber relaxes by its "
      "modulus (constant Poisson’s ratio); the contact is the elastic one under the load that "
      "makes it as large (Lee and Radok), while it shrinks by Ting’s rule. A curve ends where "
      "nothing touches or the contact would grow a second time.</p>\n",
      content.case_id, content.answers, content.facts);
  for (const TimeSeries& series : content.series) page.body += section_of(series);
  page.body +=
      provenance_section(html("<dt>program</dt><dd>{}</dd>", content.version), content.command, "");
  page.data = Json::object();
  return render_page(page);
}

}  // namespace softfinger::report
