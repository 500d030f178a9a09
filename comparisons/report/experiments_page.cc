#include "comparisons/report/experiments_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "comparisons/experiments/experiments_report.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

Html badge(const std::string& verdict) {
  if (verdict == "agrees") return "<span class=\"badge good\">✓ agrees</span>";
  if (verdict == "fails") return "<span class=\"badge bad\">✕ fails</span>";
  return "<span class=\"badge failed\">cannot tell</span>";
}

std::string shown(const std::optional<double>& value, const std::string& unit) {
  return value ? experiments::shown(*value, unit) : "–";
}

/// "0.257 (0.25 to 0.26)"
std::string with_interval(const Json& object, const char* value_key, const char* interval_key) {
  const std::string unit = text(object, "unit");
  const auto low = element(child(object, interval_key), 0),
             high = element(child(object, interval_key), 1);
  const std::string value = shown(number(object, value_key), unit);
  if (low && high && *low == *high) return value;
  return fmt::format("{} ({} to {})", value, shown(low, unit), shown(high, unit));
}

Html words_heading(const char* words) {
  return html("<th scope=\"col\" class=\"words\">{}</th>", words);
}

/// @param report  of `compare`, whose page has labels for names of models; null on the page alone
Html overview(const Json& list, const Json& report) {
  Html rows;
  for (const Json& one : list) {
    const std::string id = text(one, "id");
    const Html name =
        report.is_null() ? html("<a href=\"#experiment-{0}\">{0}</a>", id) : escape(id);
    rows += html(
        "<tr><th scope=\"row\">{}<small>{}</small></th><td class=\"words\">{}<span>{}</span></td>"
        "</tr>\n",
        name, text(one, "what"), badge(text(one, "verdict")),
        with_labels(report, text(one, "sentence")));
  }
  return "<table class=\"overview sentences\"><thead><tr><th scope=\"col\">measurement</th><th "
         "scope=\"col\">theory against it</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table>\n";
}

/// A heading for each test with what was measured; below it what the theories say.
Html findings_table(const Json& findings) {
  Html rows;
  std::string test;
  for (const Json& finding : findings) {
    const std::string unit = text(finding, "unit");
    if (text(finding, "test") != test) {
      test = text(finding, "test");
      const auto measured = number(finding, "measured"),
                 uncertainty = number(finding, "measured_uncertainty");
      rows +=
          html("<tr><th scope=\"rowgroup\" colspan=\"4\">{}{}{}</th></tr>\n", test,
               measured ? ": measured " + experiments::shown(*measured, unit) : ": not measured",
               uncertainty ? " ± " + experiments::shown(*uncertainty, unit) : "");
    }
    rows += html(
        "<tr><th scope=\"row\">{}<small>{}</small></th><td>{}</td><td class=\"words\">{}</td><td "
        "class=\"words\">{}</td></tr>\n",
        text(finding, "model"), text(finding, "role"),
        with_interval(finding, "predicted", "predicted_interval"), badge(text(finding, "verdict")),
        text(finding, "reason"));
  }
  if (rows.empty()) return "";
  return scrolling_table(words_heading("test, theories") + column_heading("predicted") +
                             words_heading("verdict") + words_heading("remark"),
                         rows);
}

/// A row for each number; a column for each interpretation ("reading") of the publication.
Html inferred_table(const Json& inferred) {
  std::vector<std::string> readings;
  for (const Json& one : inferred)
    if (const std::string reading = text(one, "reading");
        std::find(readings.begin(), readings.end(), reading) == readings.end())
      readings.push_back(reading);
  Html rows;
  std::set<std::pair<std::string, std::string>> written;
  for (const Json& one : inferred) {
    const auto row = std::pair(text(one, "name"), text(one, "condition"));
    if (!written.insert(row).second) continue;
    rows += html("<tr><th scope=\"row\">{}</th><td class=\"words\">{}</td>", row.first, row.second);
    for (const std::string& reading : readings) {
      std::string value = "–";
      for (const Json& other : inferred)
        if (std::pair(text(other, "name"), text(other, "condition")) == row &&
            text(other, "reading") == reading)
          value = with_interval(other, "value", "interval");
      rows += html("<td>{}</td>", value);
    }
    rows += "</tr>\n";
  }
  if (rows.empty()) return "";
  Html head = words_heading("quantity") + words_heading("how");
  for (const std::string& reading : readings)
    head += column_heading(reading.empty() ? "value (interval)" : "if the " + reading);
  return "<h4>What follows from it</h4>\n" + scrolling_table(head, rows);
}

Html data_set(const Json& one) {
  Html unknown;
  for (const Json& words : child(one, "unknown"))
    if (words.is_string()) unknown += html("<li>{}</li>", words.get<std::string>());
  return html(
             "<section id=\"experiment-{0}\"><h3>{0}</h3>\n<p>{1}</p>\n<p class=\"verdict\">{2} "
             "{3}</p>\n",
             text(one, "id"), text(one, "what"), badge(text(one, "verdict")),
             text(one, "sentence")) +
         findings_table(child(one, "findings")) + inferred_table(child(one, "inferred")) +
         html("<p class=\"facts\">Source: {}. {}</p>\n", text(one, "source"),
              text(one, "certainty")) +
         (unknown.empty() ? Html("") : "<p>Not known:</p><ul>" + unknown + "</ul>\n") +
         "</section>\n";
}

std::map<std::string, int> counts(const Json& list) {
  std::map<std::string, int> found;
  for (const Json& one : list) ++found[text(one, "verdict")];
  return found;
}

Html verdict_counts(const Json& experiments) {
  const Json& list = child(experiments, "experiments");
  auto count = counts(list);
  Html out = html(
      "<p class=\"lead\">{} published data {}: the theory agrees with {} and fails at {}; {} "
      "cannot "
      "tell.</p>\n",
      list.size(), list.size() == 1 ? "set" : "sets", count["agrees"], count["fails"],
      count["cannot tell"]);
  if (const std::string noise = text(experiments, "noise_floor"); !noise.empty())
    out += html("<p>What measurements of torque are worth: {}.</p>\n", noise);
  return out;
}

constexpr char kHowToRead[] =
    "<p><i>agrees</i>: measured and predicted intervals touch, and the same test excludes a "
    "simpler theory (<i>rival</i>). <i>fails</i>: they do not touch. <i>cannot tell</i>: nothing "
    "was "
    "measured, its uncertainty is not known, or no theory is excluded. Only what the program takes "
    "unless told otherwise (<i>theory</i>) decides; what it offers beside that is an "
    "<i>option</i>. Uncertainties that no publication states are supposed, and said to be. No "
    "number "
    "was fitted by hand.</p>\n";

}  // namespace

std::string render_experiments(const nlohmann::json& experiments) {
  const Json& list = child(experiments, "experiments");
  if (!list.is_array())
    throw std::invalid_argument(
        "experiments: no array \"experiments\"; see comparisons/report/README.md");
  Html body =
      "<header><h1>Does the theory hold for rubber?</h1>\n<p class=\"subtitle\">Closed forms and "
      "bonded layer against published measurements of soft fingertips</p>\n" +
      verdict_counts(experiments) +
      "<nav><a href=\"#overview\">Overview</a> <a href=\"#sets\">Data sets</a> <a "
      "href=\"#provenance\">Provenance</a></nav></header>\n<h2 id=\"overview\">Overview</h2>\n" +
      overview(list, Json()) + Html(kHowToRead) + "<h2 id=\"sets\">Data set by data set</h2>\n";
  for (const Json& one : list) body += data_set(one);
  const Json& source = child(experiments, "provenance");
  Html rows;
  for (const char* key : {"version", "date"})
    if (const std::string value = text(source, key); !value.empty())
      rows += html("<dt>{}</dt><dd>{}</dd>", key, value);
  body += provenance_section(rows, text(source, "command"), "");
  return render_page(
      {"Does the theory hold for rubber?", {embedded::report_css}, body, Json::object(), {}});
}

Html experiments_section(const Json& report) {
  const Json& experiments = child(report, "experiments");
  const Json& list = child(experiments, "experiments");
  if (!list.is_array() || list.empty()) return "";
  return "<h2 id=\"experiments\">Against measurements</h2>\n" + verdict_counts(experiments) +
         overview(list, report) +
         "<p>All numbers: <code>softfinger experiments --page experiments.html</code>.</p>\n";
}

}  // namespace softfinger::report
