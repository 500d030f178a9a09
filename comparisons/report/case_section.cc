#include "comparisons/report/case_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "comparisons/exporting/mujoco_friction.h"
#include "comparisons/report/fit_section.h"
#include "comparisons/report/ladder_section.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

constexpr double kDegrees = 57.29577951308232;

/// A column of the main table: where the value lies, in which unit it is shown, and the names of
/// its relative error in the FEM's and in the models' blocks (empty: none is stated).
struct Column {
  Html heading;
  Html unit;
  const char* key;
  double factor;
  const char* error;
};
const std::array<Column, 9> kColumns{{
    {"a", "mm", "a_m", 1e3, "a"},
    {"b", "mm", "b_m", 1e3, "b"},
    {"axis", "°", "axis_rad", kDegrees, ""},
    {"area", "mm²", "area_projected_m2", 1e6, "area"},
    {"indentation", "mm", "indentation_m", 1e3, "indentation"},
    {"peak pressure", "kPa", "peak_pressure_Pa", 1e-3, "peak_pressure"},
    {"largest torque", "mN·m", "max_torque_Nm", 1e3, "max_torque"},
    {"torque, paper rule", "mN·m", "max_torque_paper_Nm", 1e3, "max_torque_paper"},
    {"e<sub>n</sub>", "mm", "eccentricity_m", 1e3, ""},
}};

Html scrolling(const Html& table) {
  return "<div class=\"scroll\" tabindex=\"0\">" + table + "</div>\n";
}

Html cell(const HtmlArgument& value) { return html("<td>{}</td>", value); }

Html heading_row(const std::vector<Html>& headings) {
  Html out = "<thead><tr>";
  for (const Html& heading : headings) out += "<th scope=\"col\">" + heading + "</th>";
  return out + "</tr></thead>\n";
}

Html with_unit(const Html& name, const Html& unit) {
  return html("{} <span class=\"unit\">{}</span>", name, unit);
}

Html radius(std::optional<double> value_m) {
  return value_m ? significant(*value_m * 1e3) + " mm" : "flat (∞)";
}

/// `12.3 ± 0.4`; a flat direction has no radius, and no uncertainty of it.
Html radius_with_std(const Json& fit, std::size_t index) {
  const auto value = element(child(fit, "radii_m"), index);
  const auto deviation = element(child(fit, "radii_std_m"), index);
  if (!value) return "flat (∞)";
  return significant(*value * 1e3) +
         (deviation ? " ±\u00a0" + significant(*deviation * 1e3, 2) : "");
}

Html reference_row(const Json& report, const Json& load) {
  Html row = "<tr class=\"fem\"><th scope=\"row\">" + model_key(report, "fem") + "</th>";
  const Json& fem = child(load, "fem");
  if (fem.is_null()) {
    const std::string why = text(load, "fem_failure");
    return row + html("<td colspan=\"{}\" class=\"words\">no reference: {}</td></tr>\n",
                      kColumns.size() + 1, why.empty() ? "no reason recorded" : why);
  }
  for (const Column& column : kColumns) {
    const Json& error = child(child(fem, "error"), column.error);
    row += cell(
        significant(number(fem, column.key), column.factor) +
        (error.is_number() ? html("<small>±\u00a0{}</small>", percent(error.get<double>())) : ""));
  }
  const auto wall = number(fem, "wall_s");
  return row + cell(wall ? duration(*wall) : "–") + "</tr>\n";
}

Html deviation(double error, double limit) {
  return html("<small class=\"{}\">{}</small>", std::abs(error) <= limit ? "within" : "beyond",
              signed_percent(error));
}

bool holds(const Json& model) {
  const Json& checks = child(model, "validity");
  return std::all_of(checks.begin(), checks.end(),
                     [](const Json& check) { return flag(check, "holds"); });
}

/// Some messages begin with what is said before them.
std::string without_verdict(const std::string& message) {
  const std::string verdict = "no answer: ";
  return message.rfind(verdict, 0) == 0 ? message.substr(verdict.size()) : message;
}

Html model_row(const Json& report, const Json& model) {
  Html row = html("<tr{}><th scope=\"row\">{}{}</th>",
                  flag(model, "sound") ? Html("") : " class=\"outside\"",
                  model_key(report, text(model, "model")),
                  !flag(model, "has_answer") || holds(model) ? Html("")
                  : flag(model, "sound") ? Html("<small>beyond its limits, measured here</small>")
                                         : Html("<small>outside its range</small>"));
  if (!flag(model, "has_answer"))
    return row +
           html("<td colspan=\"{}\" class=\"words\">no answer</td></tr>\n", kColumns.size() + 1);
  const double limit = tolerance(report);
  for (const Column& column : kColumns) {
    const Json& error = child(child(model, "relative_error"), column.error);
    Html noted = error.is_number() ? deviation(error.get<double>(), limit) : "";
    // A peak may be met by accident: how far off the pressure is all over the contact.
    if (const auto misfit = number(child(model, "relative_error"), "pressure_misfit");
        misfit && std::string_view(column.error) == "peak_pressure")
      noted += html("<small class=\"{}\">all over {}</small>",
                    *misfit <= limit ? "within" : "beyond", percent(*misfit));
    row += cell(significant(number(model, column.key), column.factor) + noted);
  }
  const auto cost = number(model, "cost_ns");
  return row + cell(cost ? duration(*cost * 1e-9) : "–") + "</tr>\n";
}

Html numbers_table(const Json& report, const Json& load) {
  std::vector<Html> headings{"model"};
  for (const Column& column : kColumns) headings.push_back(with_unit(column.heading, column.unit));
  headings.push_back("time");
  Html body = "<tbody>" + reference_row(report, load);
  for (const Json& model : child(load, "models"))
    if (is_asked(model)) body += model_row(report, model);
  return scrolling("<table class=\"numbers\">" + heading_row(headings) + body +
                   "</tbody></table>") +
         "<p>Areas are compared as seen along the load, which is what models predict; on the "
         "deformed surface they are larger. <i>All over</i> is the mean of |p − p<sub>FEM</sub>| "
         "over the contact, in parts of the mean pressure.</p>\n";
}

Html validity_table(const Json& report, const Json& load) {
  Html rows;
  std::vector<Html> outside;
  for (const Json& model : child(load, "models")) {
    const std::string name = text(model, "model");
    if (!flag(model, "valid")) outside.push_back(escape(label(name)));
    const Json& checks = child(model, "validity");
    for (const Json& check : checks) {
      const bool holds = flag(check, "holds");
      rows += html(
          "<tr><th scope=\"row\">{}</th><td class=\"words\">{}</td><td>{}</td><td>{}</td>"
          "<td class=\"words {}\">{}</td><td class=\"words\">{}</td></tr>\n",
          model_key(report, name), text(check, "check"), significant(number(check, "value")),
          significant(number(check, "limit")), holds ? "within" : "beyond",
          holds ? "holds" : "fails", with_labels(report, text(check, "message")));
    }
  }
  if (rows.empty()) return "";
  return details(
      "Validity, as each model states it: " +
          (outside.empty() ? "all inside" : "outside for " + joined(outside, ", ")),
      scrolling("<table>" + heading_row({"model", "check", "value", "limit", "", "in words"}) +
                "<tbody>" + rows + "</tbody></table>"));
}

/// The reasons in words, open on the page: a prediction outside its validity needs its warning.
Html warnings(const Json& report, const Json& load) {
  Html items;
  for (const Json& model : child(load, "models")) {
    if (!is_asked(model)) continue;
    std::vector<Html> reasons;
    for (const Json& check : child(model, "validity"))
      if (!flag(check, "holds"))
        reasons.push_back(escape(with_labels(report, without_verdict(text(check, "message")))));
    if (!reasons.empty())
      items += html("<li><b>{}</b> {}: {}</li>\n", label(text(model, "model")),
                    !flag(model, "has_answer") ? "has no answer"
                    : flag(model, "sound")     ? "is beyond its limits (its errors say what of it)"
                                               : "is outside its range",
                    joined(reasons, "; "));
  }
  return items.empty() ? "" : "<ul class=\"warnings\">" + items + "</ul>\n";
}

Html fit_row(const char* body, const Json& fit) {
  if (fit.is_null()) return "";
  const auto coefficient = [&](const char* key) { return cell(significant(number(fit, key))); };
  const auto axis = number(fit, "axis_rad");
  const Json& normal = child(fit, "normal");
  Html direction = "–";
  if (normal.is_array() && normal.size() == 3)
    direction = html("{}, {}, {}", significant(element(normal, 0), 1, 3),
                     significant(element(normal, 1), 1, 3), significant(element(normal, 2), 1, 3));
  return html("<tr><th scope=\"row\">{}</th>", body) + cell(radius_with_std(fit, 0)) +
         cell(radius_with_std(fit, 1)) + cell(axis ? significant(*axis * kDegrees) : "–") +
         cell(significant(number(fit, "residual_rms_m"), 1e6)) + cell(text(fit, "points")) +
         cell(significant(number(fit, "area_m2"), 1e6)) + coefficient("A_per_m") +
         coefficient("B_per_m") + coefficient("C_per_m") + cell(direction) + "</tr>\n";
}

Html patch_table(const Json& load) {
  const Json& patch = child(child(load, "geometry"), "patch");
  if (patch.is_null()) return "";
  const auto region = number(patch, "region_area_m2");
  const auto predicted = number(patch, "predicted_area_m2");
  Html note = "<p>";
  if (region && predicted && *predicted > 0)
    note += html(
        "The quadric is fitted over {} mm², {} times the contact area of {} mm² that "
        "{} predicts (it should be 2 times). ",
        significant(*region * 1e6), significant(*region / *predicted, 3),
        significant(*predicted * 1e6), label(text(patch, "patch_model")));
  note += escape(text(patch, "remark")) + "</p>\n";
  const Html rows =
      fit_row("finger", child(patch, "finger")) + fit_row("object", child(patch, "object"));
  const Html table =
      rows.empty()
          ? ""
          : scrolling("<table>" +
                      heading_row({"surface", with_unit("radius 1 ± std", "mm"),
                                   with_unit("radius 2 ± std", "mm"), with_unit("axis", "°"),
                                   with_unit("residual rms", "µm"), "points",
                                   with_unit("region", "mm²"), with_unit("A", "1/m"),
                                   with_unit("B", "1/m"), with_unit("C", "1/m"), "normal"}) +
                      "<tbody>" + rows + "</tbody></table>");
  return details(html("Fit of the surfaces: region and prediction {}",
                      flag(patch, "agrees") ? "agree" : "do not agree"),
                 note + fit_pictures(load) + table);
}

Html reference_details(const Json& load, const judgement::LoadErrors& errors) {
  const Json& fem = child(load, "fem");
  if (fem.is_null()) return "";
  const Json& error = child(fem, "error");
  const auto stated = [&](const char* key) {
    const auto value = number(error, key);
    return value ? html("±\u00a0{}", percent(*value)) : "–";
  };
  Html rows;
  const Json* coarser = nullptr;
  for (const Json& level : child(fem, "levels")) {
    rows += "<tr>" + cell(text(level, "level")) + cell(text(level, "unknowns"));
    for (const auto& [key, factor] : {std::pair<const char*, double>{"a_m", 1e3},
                                      {"b_m", 1e3},
                                      {"indentation_m", 1e3},
                                      {"max_torque_Nm", 1e3}}) {
      const auto value = number(level, key);
      const auto before = coarser ? number(*coarser, key) : std::nullopt;
      rows += cell(significant(value, factor, 5) +
                   (value && before && *before != 0
                        ? html("<small>{}</small>", signed_percent(*value / *before - 1))
                        : ""));
    }
    rows += "</tr>\n";
    coarser = &level;
  }
  const Html levels =
      rows.empty() ? ""
                   : scrolling("<table>" +
                               heading_row({"level", "unknowns", with_unit("a", "mm"),
                                            with_unit("b", "mm"), with_unit("indentation", "mm"),
                                            with_unit("largest torque", "mN·m")}) +
                               "<tbody>" + rows + "</tbody></table>");
  std::vector<Html> facts;
  const auto fact = [&](const Html& words, const Html& value) {
    if (!value.empty() && !(value == "–")) facts.push_back(words + value);
  };
  fact("level ", escape(text(fem, "level")));
  fact("unknowns ", escape(text(fem, "unknowns")));
  fact("active contact nodes ", escape(text(fem, "active_nodes")));
  fact("active-set iterations ", escape(text(fem, "iterations")));
  if (const auto wall = number(fem, "wall_s")) fact("time ", escape(duration(*wall)));
  if (const auto memory = number(fem, "peak_memory_MB"))
    fact("peak memory ", significant(*memory, 3) + " MB");
  fact("pressure exponent n ", significant(number(fem, "pressure_exponent"), 1, 3));
  if (!text(fem, "vtu").empty()) fact("for ParaView: ", html("<code>{}</code>", text(fem, "vtu")));
  const Html stated_errors = html(
      "<p>Stated error: a {}, b {}, area {}, indentation {}, peak pressure {}, largest torque "
      "{}.</p>\n",
      stated("a"), stated("b"), stated("area"), stated("indentation"), stated("peak_pressure"),
      stated("max_torque"));
  Html left_open;
  if (const Json& open = child(fem, "geometry_error"); open.is_object()) {
    const auto part = [&](const char* key) {
      const auto value = number(open, key);
      return value ? percent(*value) : std::string("not known");
    };
    left_open =
        html("<p>The scan's mesh leaves open: a {}, b {}, area {}, largest torque {}.</p>\n",
             part("a"), part("b"), part("area"), part("max_torque"));
  }
  return details(html("Can this reference be trusted? {}: torque {}, a {}, b {}",
                      flag(fem, "trusted") ? Html("Yes")
                      : errors.fem_geometry_error > reference::kTrustLimits.geometry
                          ? Html("<b>No</b>, its mesh leaves too much open")
                          : "<b>Not yet</b>",
                      stated("max_torque"), stated("a"), stated("b")),
                 stated_errors + left_open + levels +
                     html("<p class=\"facts\">{}</p>\n", joined(facts, " · ")));
}

/// Relative error of the elements' torque, the mesh's part with it; a pad has no mesh.
std::optional<double> torque_error(const Json& load) {
  const Json& geometry = child(load, "geometry");
  const auto stated = number(child(child(load, "fem"), "error"), "max_torque"),
             open = geometry.is_null() ? std::optional(0.)
                                       : number(child(geometry, "error"), "max_torque");
  return stated && open ? std::optional(*stated + *open) : std::nullopt;
}

Html simulator_line(const Json& report_case, const Json& load) {
  const auto force = number(load, "load_N");
  const auto torque = number(child(load, "fem"), "max_torque_Nm");
  const auto friction = number(report_case, "friction_coefficient");
  if (!force || !torque || !friction || *force <= 0) return "";
  return html(
      "<p class=\"simulator\">MuJoCo at this load: <code>condim=\"4\" {}</code>, the torque "
      "{}</p>\n",
      exporting::mujoco_friction(*friction, *torque / *force),
      torque_error(load) ? html("±\u00a0{}", percent(*torque_error(load)))
                         : Html("not known to any per cent"));
}

Html load_section(const Json& report, const Json& report_case, const Json& load,
                  const judgement::LoadErrors& errors, std::size_t index) {
  const Json& geometry = child(load, "geometry");
  const Json& radii = child(geometry, "radii_m");
  const Json& deviations = child(geometry, "radii_std_m");
  const auto with_std = [&](std::size_t i) {
    const auto deviation = element(deviations, i);
    return radius(element(radii, i)) +
           (deviation ? " ±\u00a0" + significant(*deviation * 1e3, 2) + " mm" : "");
  };
  std::vector<Html> facts;
  if (radii.is_array()) {
    facts.push_back("R′ " + with_std(0));
    facts.push_back("R″ " + with_std(1));
  }
  // A circular contact has no long axis, whatever angle the eigenvectors happen to have.
  if (const auto axis = number(geometry, "axis_rad");
      axis && element(radii, 0) != element(radii, 1))
    facts.push_back("long axis at " + significant(*axis * kDegrees, 3) + "°");
  if (const auto s = number(geometry, "s")) facts.push_back("s = √(ab)/h = " + significant(*s, 3));
  if (const Json& open = child(geometry, "error"); !child(geometry, "patch").is_null())
    facts.push_back(
        number(open, "area") && number(open, "max_torque")
            ? html("the mesh leaves ±\u00a0{} of the area and ±\u00a0{} of the torque open",
                   percent(*number(open, "area")), percent(*number(open, "max_torque")))
            : Html("the mesh does not determine the contact"));
  return html(
             "<div class=\"load\" data-load=\"{}\">\n<h4>Load {}</h4>\n"
             "<p class=\"facts\">{}</p>\n",
             index, newton(number(load, "load_N").value_or(0)), joined(facts, " · ")) +
         numbers_table(report, load) + ladder_section(load) + warnings(report, load) +
         simulator_line(report_case, load) + reference_details(load, errors) + patch_table(load) +
         validity_table(report, load) + "</div>\n";
}

Html chart(const Html& kind, const Html& heading, const Html& caption) {
  return html(
      "<figure data-chart=\"{}\"><figcaption><b>{}</b> {}</figcaption>"
      "<div class=\"plot\"></div></figure>\n",
      kind, heading, caption);
}

Html legend(const Json& report, const Json& report_case) {
  Html keys = "<li>" + model_key(report, "fem") + "</li>";
  std::vector<std::string> seen;
  for (const Json& load : child(report_case, "loads"))
    for (const Json& model : child(load, "models")) {
      const std::string name = text(model, "model");
      if (!is_asked(model) || std::find(seen.begin(), seen.end(), name) != seen.end()) continue;
      seen.push_back(name);
      keys += "<li>" + model_key(report, name) + "</li>";
    }
  return "<ul class=\"legend\">" + keys + "</ul>\n";
}

}  // namespace

std::string case_anchor(const Json& report_case) {
  std::string anchor = "case-";
  for (const char c : text(report_case, "id"))
    anchor += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'
                  ? c
                  : '-';
  return anchor;
}

Html verdict_badge(const Json& report_case) {
  const std::string verdict = text(report_case, "verdict_class");
  const auto badge = [](const char* style_class, const char* words) {
    return html("<span class=\"badge {}\">{}</span>", style_class, words);
  };
  if (verdict == "good") return badge("good", "✓ usable");
  if (verdict == "mixed") return badge("mixed", "◐ partly");
  if (verdict == "bad") return badge("bad", "✕ not usable");
  if (verdict == "undetermined") return badge("failed", "? the mesh leaves it open");
  return badge("failed", "? no reference");
}

Html torque_of_elements(const Json& load) {
  const auto torque = number(child(load, "fem"), "max_torque_Nm");
  if (!torque) return "";
  const auto error = torque_error(load);
  return html("{}\u00a0mN·m{}", significant(torque, 1e3),
              error ? html(" ±\u00a0{}", percent(*error)) : Html(" (error not known)"));
}

Html torques_sentence(const Json& cases) {
  struct Torque {
    double torque_Nm;
    Html words;
  };
  std::vector<Torque> torques;
  for (const Json& one : cases)
    for (const Json& load : child(one, "loads"))
      if (const auto torque = number(child(load, "fem"), "max_torque_Nm"))
        torques.push_back(
            {*torque, html("<b>{}</b> {}at {}", torque_of_elements(load),
                           cases.size() == 1 ? Html("") : html("({}) ", text(one, "id")),
                           newton(number(load, "load_N").value_or(NAN)))});
  if (torques.empty()) return "";
  std::vector<Html> parts;
  if (cases.size() == 1) {
    for (const Torque& torque : torques) parts.push_back(torque.words);
  } else {
    const auto [least, largest] = std::minmax_element(
        torques.begin(), torques.end(),
        [](const Torque& one, const Torque& other) { return one.torque_Nm < other.torque_Nm; });
    parts = {least->words + " to " + largest->words};
  }
  return html("<p class=\"lead\">Largest torque by the finite elements: {}.</p>\n",
              joined(parts, ", "));
}

Html torques_cell(const Json& report_case) {
  Html lines;
  for (const Json& load : child(report_case, "loads"))
    if (const Html torque = torque_of_elements(load); !torque.empty())
      lines += html("<div>{}<small>at {}</small></div>", torque,
                    newton(number(load, "load_N").value_or(NAN)));
  return lines.empty() ? Html("–") : lines;
}

std::string searched_text(const Json& report_case) {
  std::string words;
  for (const char* key : {"id", "question", "verdict", "verdict_class"})
    words += (words.empty() ? "" : " ") + text(report_case, key);
  return words;
}

Html model_key(const Json& report, const std::string& model) {
  const Style drawn = style(report, model);
  return html(
      "<span class=\"key\"><svg width=\"26\" height=\"8\" aria-hidden=\"true\"><line x1=\"0\" "
      "y1=\"4\" "
      "x2=\"26\" y2=\"4\" stroke=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"{}\"/></svg>"
      "{}</span>",
      drawn.colour, model == "fem" ? "3.5" : "2.5", drawn.dash, label(model));
}

/// The number as it was typed.
Html layer_text(const Json& layer) {
  return html("{} mm, E {} kPa, ν {}", plain(number(layer, "thickness_m"), 1e3),
              plain(number(layer, "youngs_modulus_Pa"), 1e-3),
              plain(number(layer, "poisson_ratio")));
}

Html kicker(const std::string& id, bool has_overview) {
  return html("<p class=\"kicker\"><code>{}</code>{}</p>\n", id,
              has_overview ? Html(" <a href=\"#overview\">↑ overview</a>") : Html(""));
}

Html case_section(const Json& report, const Json& report_case, const judgement::CaseErrors& errors,
                  bool has_overview) {
  const Json& layer = child(report_case, "layer");
  const Json& loads = child(report_case, "loads");
  const std::string id = text(report_case, "id");
  const std::string question = text(report_case, "question");
  Html out = html(
      "<section class=\"case\" id=\"{}\" data-case=\"{}\" data-filtered=\"{}\">\n"
      "{}<h3>{}</h3>\n<p class=\"verdict {}\">{} {}</p>\n",
      case_anchor(report_case), id, searched_text(report_case), kicker(id, has_overview),
      question.empty() ? id : question, text(report_case, "verdict_class"),
      verdict_badge(report_case), text(report_case, "verdict"));
  const Json& sublayers = child(report_case, "sublayers");
  out += "<p class=\"facts\">";
  if (sublayers.is_array() && !sublayers.empty()) {
    out += "From the surface inwards: ";
    for (const Json& sublayer : sublayers)
      out += html("{} {}, ", text(sublayer, "name"), layer_text(sublayer));
    out += html("bonded · for the models on average {} mm, E {} kPa, ν {}",
                plain(number(layer, "thickness_m"), 1e3),
                significant(number(layer, "youngs_modulus_Pa"), 1e-3, 3),
                significant(number(layer, "poisson_ratio"), 1, 3));
  } else {
    out += "Layer " + layer_text(layer);
  }
  out +=
      html(" · friction coefficient {}</p>\n", plain(number(report_case, "friction_coefficient")));
  if (loads.is_array() && loads.size() > 1) {
    // Without JavaScript every load is shown and nothing needs to be chosen: the script reveals it.
    out += "<div class=\"loads\" role=\"group\" aria-label=\"Load\" hidden><span>Load</span>";
    for (std::size_t i = 0; i < loads.size(); ++i)
      out += html("<button type=\"button\" data-load=\"{}\">{}</button>", i,
                  newton(number(loads[i], "load_N").value_or(0)));
    out += "</div>\n";
  }
  out += legend(report, report_case) + "<div class=\"charts\">\n" +
         chart("ellipse", "Contact ellipse.",
               "Equal scale in both directions; the grey band is the FEM's stated error.") +
         chart("pressure", "Pressure along the axes.",
               "From the centre outwards; points are FEM nodes.") +
         chart("torque", "Largest torque about the normal.",
               "Bar: exact rule; ring: the paper’s rule; grey band: FEM with its stated error.") +
         chart("ellipsoid", "Friction ellipsoid.",
               "Largest torque that a tangential force leaves, f² + τ²/eₙ² = μ²P².") +
         "</div>\n";
  for (std::size_t i = 0; i < errors.loads.size(); ++i)
    out += load_section(report, report_case, loads[i], errors.loads[i], i);
  const std::string file = text(report_case, "file");
  if (!text(report_case, "case_toml").empty())
    out += details(html("Case file <code>{}</code>", file),
                   html("<pre>{}</pre>\n", text(report_case, "case_toml")));
  return out + "</section>\n";
}

}  // namespace softfinger::report
