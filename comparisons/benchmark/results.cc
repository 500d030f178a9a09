#include "comparisons/benchmark/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "comparisons/report/embedded.h"
#include "comparisons/report/html.h"
#include "comparisons/report/page.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::benchmark {
namespace {

using report::Html;
using report::html;

std::string speed(const Score& score) {
  const double steps = score.steps_per_s();
  return steps >= 1e4 ? fmt::format("{:.0f}k steps/s", steps / 1000)
                      : fmt::format("{:.2g}k steps/s", steps / 1000);
}

/// Up to three digits, and a dash for what is not finite.
std::string shown(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "none";
  if (value != 0 && std::abs(value) < 1e-4) return "0" + (unit == "°" ? unit : "\u00a0" + unit);
  if (std::abs(value) >= 1000) return fmt::format("{:.0f}\u00a0{}", value, unit);
  return fmt::format("{:.3g}{}{}", value, unit.empty() || unit == "°" ? "" : "\u00a0", unit);
}

/// A motion of what should be at rest.
std::string drift_shown(const Measured& measured) {
  return std::isfinite(measured.value) ? shown(measured.value, measured.unit) : "lost";
}

Html cell(const Problem& problem, const Score& score) {
  if (!score.failure.empty())
    return html("<td>{}<small>{}</small></td>", score.failure, speed(score));
  const std::string words = worst_in_words(problem, score);
  // An engine without a contact that holds has no error to compare.
  return html("<td>{}<small>{}</small></td>", words.empty() ? "–" : words, speed(score));
}

Html overview(const Results& results) {
  Html head = "<th scope=\"col\" class=\"words\">engine</th>";
  for (const Problem* problem : results.problems) head += report::column_heading(problem->name);
  Html rows;
  for (std::size_t i = 0; i < results.engines.size(); ++i) {
    rows += html("<tr><th scope=\"row\">{}<small>{}</small></th>", results.engines[i]->title,
                 results.engines[i]->told);
    for (std::size_t j = 0; j < results.problems.size(); ++j)
      rows += cell(*results.problems[j], results.scores[i][j]);
    rows += "</tr>\n";
  }
  return report::scrolling_table(head, rows);
}

Html problem_section(const Results& results, std::size_t problem_index) {
  const Problem& problem = *results.problems[problem_index];
  Html rows;
  for (std::size_t i = 0; i < results.engines.size(); ++i)
    // Runs that failed, for example because a body fell, have no errors to show.
    for (const Measured& measured : results.scores[i][problem_index].failure.empty()
                                        ? results.scores[i][problem_index].measured
                                        : std::vector<Measured>())
      rows += html(
          "<tr><th scope=\"row\">{}</th><td class=\"words\">{}</td><td>{}</td><td>{}</td>"
          "<td>{}</td></tr>\n",
          results.engines[i]->title, measured.what,
          problem.is_relative ? shown(measured.value, measured.unit) : drift_shown(measured),
          shown(measured.truth, measured.unit),
          measured.truth == 0             ? drift_shown(measured)
          : std::isfinite(measured.value) ? report::signed_percent(measured.error())
                                          : std::string("–"));
  return html("<section id=\"{0}\"><h3>{0}</h3>\n<p>{1} Truth: {2}.</p>\n", problem.name,
              problem.question, problem.truth) +
         report::scrolling_table(Html("<th scope=\"col\" class=\"words\">engine</th>"
                                      "<th scope=\"col\" class=\"words\">measured</th>") +
                                     report::column_heading("value") +
                                     report::column_heading("truth") +
                                     report::column_heading("error"),
                                 rows) +
         "</section>\n";
}

/// A table with a row for each engine and setting, and a column for each hold.
Html drift_section(const std::vector<Drift>& drifts) {
  using Column = std::tuple<std::string, double, double, double>;
  using Row = std::pair<std::string, std::string>;
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::map<std::pair<Row, Column>, const Drift*> cells;
  const auto add_once = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const Drift& drift : drifts) {
    const Row row{drift.engine, drift.setting};
    const Column column{drift.scene, drift.load_N, drift.from_s, drift.to_s};
    add_once(rows, row);
    add_once(columns, column);
    cells[{row, column}] = &drift;
  }
  Html head = "<th scope=\"col\" class=\"words\">engine</th>", body;
  for (const auto& [scene, load_N, from_s, to_s] : columns)
    head += report::column_heading(
        fmt::format("{}, {:g}\u00a0N, {:g} to {:g}\u00a0s", scene, load_N, from_s, to_s));
  for (const Row& row : rows) {
    body += html("<tr><th scope=\"row\">{}<small>{}</small></th>", row.first, row.second);
    for (const Column& column : columns) {
      const auto found = cells.find({row, column});
      if (found == cells.end()) {
        body += "<td>–</td>";
      } else if (!std::isfinite(found->second->moves_um_per_s)) {
        body += "<td>lost</td>";
      } else {
        body += html("<td>{}<small>{}</small></td>", shown(found->second->moves_um_per_s, "µm/s"),
                     shown(found->second->turns_mrad_per_s, "mrad/s"));
      }
    }
    body += "</tr>\n";
  }
  return "<section id=\"creep\"><h2>Creep, measured apart</h2>\n<p>How fast the holds of capsule, "
         "claw and wall move and turn, by <code>creep/creep.mjs</code> in engines that are not "
         "libraries of this program. Stiff: solref 0.004 1, solimp 0.99 0.999 0.001.</p>\n" +
         report::scrolling_table(head, body) + "</section>\n";
}

}  // namespace

std::vector<Drift> read_drifts(const std::string& text, const std::string& where) {
  const nlohmann::json parsed = text::parse_json(text);
  std::vector<Drift> drifts;
  try {
    for (const nlohmann::json& row : parsed.at("rows")) {
      Drift drift{row.at("engine"), row.at("setting"), row.at("scene"),
                  row.at("load_N"), row.at("from_s"),  row.at("to_s")};
      if (!row.at("um_per_s").is_null() && row.at("lost_at_s").is_null()) {
        drift.moves_um_per_s = row.at("um_per_s");
        drift.turns_mrad_per_s = row.at("mrad_per_s");
      }
      drifts.push_back(std::move(drift));
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError(where, "the rows of the file", "", "what creep.mjs --json writes");
  }
  return drifts;
}

std::string worst_in_words(const Problem& problem, const Score& score) {
  const Measured* const worst = score.worst();
  if (!worst) return "";
  if (!problem.is_relative) {
    std::string words;
    for (const Measured& measured : score.measured)
      if (!measured.verb.empty())
        words += (words.empty() ? "" : ", ") + measured.verb + " " + drift_shown(measured);
    return words;
  }
  return std::isfinite(worst->error()) ? report::signed_percent(worst->error()) : "none holds";
}

nlohmann::json to_json(const Results& results) {
  nlohmann::json engines = nlohmann::json::array(), absent = nlohmann::json::array();
  for (std::size_t i = 0; i < results.engines.size(); ++i) {
    nlohmann::json problems = nlohmann::json::object();
    for (std::size_t j = 0; j < results.problems.size(); ++j) {
      const Score& score = results.scores[i][j];
      nlohmann::json measured = nlohmann::json::array();
      for (const Measured& one : score.measured)
        measured.push_back({{"what", one.what},
                            {"unit", one.unit},
                            {"value", text::finite_or_null(one.value)},
                            {"truth", text::finite_or_null(one.truth)},
                            {"error", text::finite_or_null(one.error())}});
      problems[results.problems[j]->name] = {
          {"measured", measured},
          {"steps", score.steps},
          {"wall_s", score.wall_s},
          {"steps_per_s", score.steps_per_s()},
          {"failure", score.failure.empty() ? nlohmann::json() : nlohmann::json(score.failure)}};
    }
    engines.push_back({{"name", results.engines[i]->name},
                       {"title", results.engines[i]->title},
                       {"told", results.engines[i]->told},
                       {"problems", problems}});
  }
  for (const AbsentEngine& engine : absent_engines())
    absent.push_back({{"name", engine.name}, {"package", engine.package}});
  return {
      {"engines", engines},
      {"absent", absent},
      {"provenance",
       {{"version", results.version}, {"machine", results.machine}, {"command", results.command}}}};
}

std::string render_page(const Results& results) {
  Html body =
      "<header><h1>Soft contacts in several simulators</h1>\n<p class=\"subtitle\">The same nine "
      "problems, each engine's largest error against the truth and its speed</p>\n"
      "<nav><a href=\"#overview\">Overview</a> <a href=\"#problems\">Problem by problem</a> ";
  if (!results.drifts.empty()) body += "<a href=\"#creep\">Creep</a> ";
  body +=
      "<a href=\"#provenance\">Provenance</a></nav></header>\n<h2 id=\"overview\">Overview</h2>\n";
  body += overview(results);
  body +=
      "<p>Largest error, below it the speed of the steps alone, on one core. Pinch, twist, grip "
      "and tilt "
      "are thresholds, found by bisection to 1e-4: a contact holds while the acceleration stays "
      "below 2e-4 of what it is without friction. A contact that creeps at constant velocity holds "
      "by that measure; how far it comes is in "
      "<i>held</i> and <i>stack</i>, where the truth is 0: how far a body moved and turned in a "
      "minute, and how far a box of the stack sank into those below in the second before it; in "
      "<i>capsule</i>, <i>claw</i> and <i>wall</i> how fast it creeps. All engines have steps of 1 "
      "ms, 2 ms in "
      "<i>stack</i> and these three, and their own default solver and iterations unless stated. "
      "Who is told mu e_n "
      "has that of the nominal load, and a pad is a box whose corners lie at e_n.</p>\n";
  std::string bounds;
  for (const TruthBound& truth : bounds_of_the_truth())
    bounds += fmt::format("{}{} at {:.3g} N", bounds.empty() ? "" : ", ",
                          std::isfinite(truth.bound) ? report::percent(truth.bound) : "not known",
                          truth.load_N);
  body += html(
      "<p>The truth of pinch and twist is a closed form, fitted to finite elements of whole "
      "fingers "
      "at finite strain. How far its torque is at most from theirs: {}. Numbers below 1e-4 are "
      "shown "
      "as 0.</p>\n",
      bounds);
  for (const AbsentEngine& engine : absent_engines())
    body += html("<p>Absent in this build: {} (Debian: {}).</p>\n", engine.name, engine.package);
  body += "<h2 id=\"problems\">Problem by problem</h2>\n";
  for (std::size_t j = 0; j < results.problems.size(); ++j) body += problem_section(results, j);
  if (!results.drifts.empty()) body += drift_section(results.drifts);
  Html rows;
  for (const auto& [name, value] :
       {std::pair{"version", results.version}, std::pair{"machine", results.machine}})
    if (!value.empty()) rows += html("<dt>{}</dt><dd>{}</dd>", name, value);
  body += report::provenance_section(rows, results.command, "");
  return report::render_page({"Soft contacts in several simulators",
                              {report::embedded::report_css},
                              body,
                              nlohmann::json::object(),
                              {}});
}

}  // namespace softfinger::benchmark
