#include "comparisons/report/select_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <vector>

#include "comparisons/report/atlas_sections.h"
#include "comparisons/report/case_section.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/style.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 6> kErrorColumns{
    {{"a", "a"},
     {"b", "b"},
     {"area", "area"},
     {"indentation", "indentation"},
     {"peak_pressure", "peak pressure"},
     {"max_torque", "largest torque"}}};

double worst_of(const Json& candidate) { return number(candidate, "worst").value_or(NAN); }

const Json& candidate_named(const Json& choice, const std::string& model) {
  for (const Json& candidate : child(choice, "candidates"))
    if (text(candidate, "model") == model) return candidate;
  return child(Json(), "");
}

std::string tolerance_text(const Json& selection) {
  return plain(tolerance(selection), 100) + "\u00a0%";
}

/// A reason as a sentence of its own.
std::string sentence(std::string words) {
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z') words[0] += 'A' - 'a';
  return words + ".";
}

std::string time_of(const Json& candidate) {
  const auto cost_us = number(candidate, "cost_us");
  return cost_us ? duration(1e-6 * *cost_us) : "–";
}

/// The models that are chosen at any load.
std::vector<std::string> chosen_models(const Json& selection) {
  std::vector<std::string> models;
  for (const Json& choice : child(selection, "choices"))
    if (const std::string model = text(choice, "model"); !model.empty()) models.push_back(model);
  return models;
}

/// `Bonded layer: within 3.1 %, 0.4 µs`
Html described(const Json& report, const Json& choice, const std::string& model) {
  if (model.empty()) return "none";
  const Json& candidate = candidate_named(choice, model);
  return html("{}<small>within {} at {}</small>", model_key(report, model),
              percent(worst_of(candidate)), time_of(candidate));
}

Html select_lead(const Json& selection) {
  const Json& choices = child(selection, "choices");
  const std::string within = tolerance_text(selection);
  std::set<std::string> chosen;
  for (const Json& choice : choices) chosen.insert(text(choice, "model"));
  Html sentence;
  if (chosen.size() == 1 && chosen.count("")) {
    sentence = html("No allowed model is known to be within {}{}", within,
                    choices.size() > 1 ? " at any of the loads." : ".");
  } else if (chosen.size() == 1) {
    double worst = 0, slowest_us = 0;
    for (const Json& choice : choices) {
      const Json& candidate = candidate_named(choice, *chosen.begin());
      worst = std::fmax(worst, worst_of(candidate));
      slowest_us = std::fmax(slowest_us, number(candidate, "cost_us").value_or(0));
    }
    sentence = html(
        "<b>{}</b> is the cheapest model that is accurate enough{}: its stated error is at most "
        "{}, an "
        "answer takes {}.",
        label(*chosen.begin()), choices.size() > 1 ? " at every load" : "", percent(worst),
        duration(1e-6 * slowest_us));
  } else {
    std::vector<Html> loads;
    for (const Json& choice : choices) {
      const std::string model = text(choice, "model");
      loads.push_back(html("<b>{}</b> at {}", model.empty() ? "none" : label(model),
                           newton(number(choice, "load_N").value_or(NAN))));
    }
    sentence = html("The cheapest model that is accurate enough depends on the load: {}.",
                    joined(loads, ", "));
  }
  return "<p class=\"lead\">" + sentence + "</p>\n";
}

Html overview(const Json& selection) {
  Html rows;
  for (const Json& choice : child(selection, "choices")) {
    const std::string model = text(choice, "model");
    rows += html(
        "<tr><th scope=\"row\">{}</th><td class=\"words\">{} {}</td><td class=\"words\">{}</td>"
        "<td class=\"words\">{}</td><td>{}</td></tr>\n",
        newton(number(choice, "load_N").value_or(NAN)),
        model.empty() ? Html("<span class=\"badge bad\">✕ none</span>")
                      : "<span class=\"badge good\">✓ enough</span>",
        described(selection, choice, model),
        described(selection, choice, text(choice, "next_cheaper")),
        described(selection, choice, text(choice, "next_better")),
        significant(number(choice, "s"), 1, 3));
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">load</th>"
         "<th scope=\"col\" class=\"words\">the choice</th><th scope=\"col\" class=\"words\">next "
         "cheaper</th><th scope=\"col\" class=\"words\">next better</th><th scope=\"col\">s = "
         "√(ab)/h</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

Html chooser(const Json& choices) {
  if (choices.size() < 2) return "";
  Html out =
      "<div class=\"loads sticky\" role=\"group\" aria-label=\"Load\" hidden><span>Load</span>";
  for (std::size_t i = 0; i < choices.size(); ++i)
    out += html("<button type=\"button\" data-load=\"{}\">{}</button>", i,
                newton(number(choices[i], "load_N").value_or(NAN)));
  return out + html(
                   "<input type=\"range\" data-loads min=\"0\" max=\"{}\" step=\"1\" "
                   "aria-label=\"Load\"></div>\n",
                   choices.size() - 1);
}

Html candidates_table(const Json& selection, const Json& choice) {
  Html head = "<th scope=\"col\">model</th><th scope=\"col\">time of one answer</th>";
  for (const auto& column : kErrorColumns) head += html("<th scope=\"col\">{}</th>", column.second);
  head += "<th scope=\"col\" class=\"words\">so</th>";
  const double limit = tolerance(selection);
  const std::string chosen = text(choice, "model");
  Html rows;
  for (const Json& candidate : child(choice, "candidates")) {
    const std::string name = text(candidate, "model");
    const Json& bound = child(candidate, "error_bound");
    rows += html("<tr{}><th scope=\"row\">{}</th><td>{}</td>",
                 name == chosen ? Html(" class=\"fem\"") : "", model_key(selection, name),
                 time_of(candidate));
    if (bound.is_null()) {
      rows += html("<td colspan=\"{}\" class=\"words\">no stated error: {}</td></tr>\n",
                   kErrorColumns.size() + 1, with_labels(selection, text(candidate, "remark")));
      continue;
    }
    for (const auto& column : kErrorColumns) {
      const auto error = number(bound, column.first);
      rows += error ? html("<td><span class=\"{}\">{}</span></td>",
                           *error <= limit ? "within" : "beyond", percent(*error))
                    : "<td>–</td>";
    }
    rows += html("<td class=\"words\">{}</td></tr>\n",
                 name == chosen                   ? Html("<b>the choice</b>")
                 : !flag(candidate, "usable")     ? Html("not accurate enough")
                 : !flag(candidate, "affordable") ? Html("too slow")
                                                  : "enough");
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table class=\"numbers\"><thead><tr>" + head +
         "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

Html causes_of_case(const Json& selection, const Json& choice) {
  const Json& causes = child(choice, "causes");
  const Json& models = child(causes, "models");
  if (!models.is_array() || models.empty()) return "";
  // A table without the choice would answer another question.
  const std::string chosen = text(choice, "model");
  if (!chosen.empty() && std::none_of(models.begin(), models.end(), [&](const Json& cause) {
        return text(cause, "model") == chosen;
      }))
    return "";
  Html rows;
  for (const Json& cause : models) {
    rows += "<tr><th scope=\"row\">" + model_key(selection, text(cause, "model")) + "</th>";
    for (const char* key : {"geometry_fit", "ellipse", "pressure", "circle_rule", "max_torque"}) {
      const auto value = number(cause, key);
      rows += html("<td>{}</td>", !value ? "–"
                                  : std::string_view(key) == "geometry_fit"
                                      ? "±\u00a0" + percent(*value)
                                      : signed_percent(*value));
    }
    rows += "</tr>\n";
  }
  const Json& run = child(causes, "nearest_run");
  return html(
             "<h4>This torque’s error by cause</h4>\n<p class=\"facts\">From the nearest "
             "finite-element run of the atlas: ν {}, R′/R″ {}, s {}. Ellipse times pressure is "
             "the torque’s error by the exact rule.{}</p>\n",
             plain(number(run, "poisson_ratio")), plain(number(run, "radii_ratio")),
             plain(number(run, "s")),
             number(causes, "ellipsoid")
                 ? html(" The friction ellipsoid is off by up to {} from the exact limit "
                        "surface of this contact.",
                        percent(*number(causes, "ellipsoid")))
                 : "") +
         "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">model</th>"
         "<th scope=\"col\">geometry fit</th><th scope=\"col\">ellipse</th><th "
         "scope=\"col\">pressure</th><th scope=\"col\">√(ab) rule instead of the exact one</th>"
         "<th scope=\"col\">torque, exact rule</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

Json selection_chart_data(const Json& selection) {
  Json loads = Json::array();
  for (const Json& choice : child(selection, "choices")) {
    Json candidates = Json::array();
    for (const Json& candidate : child(choice, "candidates"))
      candidates.push_back({{"model", text(candidate, "model")},
                            {"cost_us", child(candidate, "cost_us")},
                            {"bound", child(candidate, "error_bound")},
                            {"chosen", text(candidate, "model") == text(choice, "model")}});
    loads.push_back({{"load_N", child(choice, "load_N")}, {"candidates", candidates}});
  }
  return {{"tolerance", tolerance(selection)},
          {"styles", chart_styles(selection)},
          {"atlas", atlas_chart_data(selection)},
          {"curves", child(selection, "curves")},
          {"cases", {{{"id", text(selection, "case")}, {"loads", loads}}}}};
}

Html provenance_of(const Json& selection) {
  const Json& source = child(selection, "provenance");
  Html rows;
  for (const char* key : {"version", "date"})
    if (const std::string value = text(source, key); !value.empty())
      rows += html("<dt>{}</dt><dd>{}</dd>", key, value);
  return provenance_section(rows + atlas_provenance(selection), text(source, "command"),
                            "<p>The choices in full precision are in <code>select.json</code> "
                            "beside this page, in SI units.</p>\n");
}

Html select_body(const Json& selection) {
  const Json& choices = child(selection, "choices");
  const std::string question = text(selection, "question");
  const Html speed = speed_accuracy_section(selection);
  const std::vector<std::string> chosen = chosen_models(selection);
  const Html maps = atlas_has(selection, chosen) ? validity_map_section(selection) : Html("");
  const Html causes =
      atlas_has_causes(selection, chosen) ? error_causes_section(selection) : Html("");
  Html out = html(
      "<header><h1>Which model is enough for {} within {}?</h1>\n<p class=\"subtitle\">{}</p>\n",
      text(selection, "case"), tolerance_text(selection),
      question.empty() ? text(selection, "description") : question);
  out += select_lead(selection);
  if (!question.empty()) out += html("<p class=\"facts\">{}</p>\n", text(selection, "description"));
  if (const std::string limits = text(selection, "limits"); !limits.empty())
    out += html("<p class=\"facts\">{}</p>\n", limits);
  out += Html("<nav><a href=\"#choice\">The choice</a> ") +
         (speed.empty() ? Html("") : "<a href=\"#speed\">Speed and accuracy</a> ") +
         (maps.empty() ? Html("") : "<a href=\"#maps\">Validity maps</a> ") +
         (causes.empty() ? Html("") : "<a href=\"#causes\">Causes</a> ") +
         "<a href=\"#provenance\">Provenance</a></nav></header>\n";
  out += html("<section data-case=\"{}\">\n", text(selection, "case"));
  out +=
      "<h2 id=\"choice\">The choice, load by load</h2>\n" + overview(selection) + chooser(choices);
  std::size_t index = 0;
  for (const Json& choice : choices)
    out += html(
               "<div class=\"load\" data-load=\"{}\">\n<h4>Load {}</h4>\n<p "
               "class=\"verdict\">{}</p>\n",
               index++, newton(number(choice, "load_N").value_or(NAN)),
               sentence(with_labels(selection, text(choice, "reason")))) +
           candidates_table(selection, choice) + causes_of_case(selection, choice) + "</div>\n";
  out += text(selection, "contact") == "patch"
             ? Html(
                   "<p class=\"facts\">Stated errors are bounds against finite elements of the "
                   "whole pad, in linear theory: 95 % of runs that nothing was fitted to lie "
                   "inside. A pad has no semi-axes, and its area is that of the outline.</p>\n")
             : "<p class=\"facts\">Stated errors are bounds against the finger itself, curved and "
               "at finite strain, fitted to finite-element runs of which 95 % lie inside; what the "
               "fit of a mesh leaves open is added.</p>\n";
  const Json& curve_loads = child(child(selection, "curves"), "load_N");
  if (curve_loads.is_array() && curve_loads.size() > 1)
    out +=
        "<div class=\"charts single\"><figure data-chart=\"sweep\"><figcaption><b>Stated error "
        "over "
        "the load.</b> Where a line crosses the dashed tolerance, another model takes over; thin "
        "verticals are the case’s loads; where a line is missing, no error is "
        "known.</figcaption>"
        "<div class=\"plot\"></div></figure></div>\n";
  out += speed + maps + "</section>\n" + causes;
  if (!text(selection, "case_toml").empty())
    out += html(
        "<h2 id=\"case\">The case</h2>\n<details><summary>Case file "
        "<code>{}</code></summary>\n<pre>{}</pre></details>\n",
        text(selection, "file"), text(selection, "case_toml"));
  return out + provenance_of(selection);
}

/// "a point", as the lead says it.
std::string detail_in_words(const std::string& detail) {
  if (detail == "point") return "a point without torque";
  if (detail == "ellipsoid") return "a friction ellipsoid";
  if (detail == "six_patches") return "six patches";
  return detail == "fem_table" ? "e_n by finite elements" : "the exact limit surface";
}

Html scene_lead(const Json& selection) {
  const Json& choices = child(selection, "choices");
  if (choices.empty())
    return "<p class=\"lead\">No soft contact carries a load: <b>points are enough</b>.</p>\n";
  std::map<std::string, int> pairs_of;
  for (const Json& choice : choices) ++pairs_of[text(choice, "detail")];
  std::vector<Html> needs;
  for (const auto& [detail, count] : pairs_of)
    needs.push_back(html("{} of {} pairs {} <b>{}</b>", count, choices.size(),
                         count == 1 ? "needs" : "need", detail_in_words(detail)));
  const std::string outcome = text(selection, "outcome");
  return (outcome.empty() ? Html("") : html("<p class=\"lead\"><b>{}</b></p>\n", outcome)) +
         html(
             "<p class=\"lead\">{}.</p>\n<p><b>{}</b> A step takes {} instead of {} with {}. "
             "Against that the motion changes {}: <b>{} {}</b>.</p>\n",
             joined(needs, ", "), sentence(text(selection, "saving")),
             duration(1e-3 * number(selection, "step_ms_chosen").value_or(NAN)),
             duration(1e-3 * number(selection, "step_ms_accurate").value_or(NAN)),
             text(selection, "reference"), text(selection, "motion_change_in_words"),
             flag(selection, "motion_holds") ? "within" : "more than", tolerance_text(selection));
}

Html scene_pairs(const Json& selection) {
  Html rows, sections;
  std::size_t index = 0;
  for (const Json& choice : child(selection, "choices")) {
    std::string names;
    for (const Json& body : child(choice, "bodies"))
      names += (names.empty() ? "" : " – ") + (body.is_string() ? body.get<std::string>() : "");
    const std::string model = text(choice, "model"), reason = sentence(text(choice, "reason"));
    const Json& candidate = candidate_named(choice, model);
    rows += html(
        "<tr><th scope=\"row\"><a href=\"#pair-{}\">{}</a></th><td class=\"words\">{}</td><td "
        "class=\"words\">{}</td><td "
        "class=\"words\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        index, names, text(choice, "detail"), text(choice, "friction"),
        model == "rigid"   ? Html("none")
        : model == "table" ? Html("finite elements")
                           : model_key(selection, model),
        candidate.is_null() ? Html("–") : html("{}", percent(worst_of(candidate))),
        percent(number(choice, "utilisation").value_or(NAN)),
        newton(number(choice, "load_N").value_or(NAN)));
    sections += html("<section id=\"pair-{}\"><h3>{}</h3>\n<p class=\"verdict\">{}</p>\n", index++,
                     names, reason) +
                candidates_table(selection, choice) + "</section>\n";
  }
  if (rows.empty()) return "";
  return "<h2 id=\"choice\">Pair by pair</h2>\n<div class=\"scroll\" tabindex=\"0\"><table><thead>"
         "<tr><th scope=\"col\">bodies</th><th scope=\"col\" class=\"words\">contact</th><th "
         "scope=\"col\" class=\"words\">friction law</th><th scope=\"col\" "
         "class=\"words\">model</th><th scope=\"col\">torque within</th><th "
         "scope=\"col\">of its limit used</th><th scope=\"col\">largest load</th></tr></thead>\n"
         "<tbody>" +
         rows + "</tbody></table></div>\n" + sections;
}

}  // namespace

std::string render_scene_selection(const nlohmann::json& selection) {
  if (!child(selection, "choices").is_array())
    throw std::invalid_argument(
        "selection: no array \"choices\"; see comparisons/report/README.md");
  const std::string scene = text(selection, "scene");
  return render_page({html("What do the contacts of {} need?", scene),
                      {embedded::report_css},
                      html("<header><h1>What do the contacts of {} need, within {}?</h1>\n", scene,
                           tolerance_text(selection)) +
                          scene_lead(selection) + "</header>\n" + scene_pairs(selection) +
                          provenance_of(selection),
                      Json::object(),
                      {}});
}

std::string render_selection(const nlohmann::json& selection) {
  if (!child(selection, "choices").is_array())
    throw std::invalid_argument(
        "selection: no array \"choices\"; see comparisons/report/README.md");
  return render_page(
      {html("Which model is enough for {}?", text(selection, "case")),
       {embedded::report_css},
       select_body(selection),
       selection_chart_data(selection),
       {embedded::d3_js, embedded::plot_js, embedded::charts_js, embedded::select_js}});
}

}  // namespace softfinger::report
