#include "comparisons/report/pad_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "comparisons/exporting/mujoco_friction.h"
#include "comparisons/report/case_section.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

/// A column of a pad's table: the value's key, its place in a pair, and the name of its error in
/// the elements' block and in the models'.
struct PadColumn {
  Html heading, unit;
  const char* key;
  int place;  ///< -1: a plain number
  double factor;
  const char *stated, *relative;
};
const std::array<PadColumn, 8> kPadTable{{
    {"largest torque", "mN·m", "max_torque_Nm", -1, 1e3, "max_torque", "max_torque"},
    {"e<sub>n</sub>", "mm", "eccentricity_m", -1, 1e3, "", ""},
    {"arm as pressed", "mm", "pressure_arm_m", -1, 1e3, "pressure_arm", "pressure_arm"},
    {"indentation", "mm", "indentation_m", -1, 1e3, "indentation", "indentation"},
    {"stiffness", "N/mm", "normal_stiffness_N_per_m", -1, 1e-3, "normal_stiffness",
     "normal_stiffness"},
    {"tilt stiffness about x", "N·m/rad", "tilt_stiffness_Nm_per_rad", 0, 1, "", ""},
    {"about y", "N·m/rad", "tilt_stiffness_Nm_per_rad", 1, 1, "", "tilt_stiffness"},
    {"peak pressure", "kPa", "peak_pressure_Pa", -1, 1e-3, "peak_pressure_inside", "peak_pressure"},
}};

std::optional<double> pad_value(const Json& block, const PadColumn& column) {
  return column.place < 0 ? number(block, column.key)
                          : element(child(block, column.key), std::size_t(column.place));
}

Html pad_deviation(double error, double limit) {
  return html("<small class=\"{}\">{}</small>", std::abs(error) <= limit ? "within" : "beyond",
              signed_percent(error));
}

Html pad_elements_row(const Json& report, const Json& load) {
  Html row = "<tr class=\"fem\"><th scope=\"row\">" + model_key(report, "fem") + "</th>";
  const Json& fem = child(load, "fem");
  if (fem.is_null())
    return row + html("<td colspan=\"{}\" class=\"words\">no reference: {}</td></tr>\n",
                      kPadTable.size() + 1, text(load, "fem_failure"));
  for (const PadColumn& column : kPadTable) {
    const auto stated = number(child(fem, "error"), column.stated);
    row += html("<td>{}{}</td>", significant(pad_value(fem, column), column.factor),
                stated ? html("<small>±\u00a0{}</small>", percent(*stated)) : "");
  }
  const auto wall = number(fem, "wall_s");
  return row + html("<td>{}</td></tr>\n", wall ? duration(*wall) : "–");
}

Html pad_model_row(const Json& report, const Json& model) {
  Html row = html("<tr{}><th scope=\"row\">{}{}</th>",
                  flag(model, "sound") ? Html("") : " class=\"outside\"",
                  model_key(report, text(model, "model")),
                  flag(model, "sound") ? Html("") : "<small>states no bound here</small>");
  if (!flag(model, "has_answer"))
    return row +
           html("<td colspan=\"{}\" class=\"words\">no answer</td></tr>\n", kPadTable.size() + 1);
  for (const PadColumn& column : kPadTable) {
    const auto error = number(child(model, "relative_error"), column.relative);
    row += html("<td>{}{}</td>", significant(pad_value(model, column), column.factor),
                error ? pad_deviation(*error, tolerance(report)) : "");
  }
  const auto cost = number(model, "cost_ns");
  return row + html("<td>{}</td></tr>\n", cost ? duration(*cost * 1e-9) : "–");
}

Html pad_numbers(const Json& report, const Json& load) {
  Html head = column_heading("model");
  for (const PadColumn& column : kPadTable) head += column_heading(column.heading, column.unit);
  Html rows = pad_elements_row(report, load);
  for (const Json& model : child(load, "models")) rows += pad_model_row(report, model);
  return "<div class=\"scroll\" tabindex=\"0\"><table class=\"numbers\"><thead><tr>" + head +
         column_heading("time") + "</tr></thead>\n<tbody>" + rows +
         "</tbody></table></div>\n"
         "<p class=\"facts\">The error of the tilt stiffness is that about the axis that is "
         "farther off. The peak is the largest pressure within 0.95 of the way to the "
         "outline.</p>\n";
}

/// The error that the elements state of a quantity, the larger one of both axes; 0 if none.
double stated_by_elements(const Json& fem, const char* key) {
  const Json& value = child(child(fem, "error"), key);
  double largest = 0;
  for (const Json& one : value.is_array() ? value : Json::array({value}))
    if (one.is_number()) largest = std::max(largest, one.get<double>());
  return largest;
}

/// Whether the errors lie within what the model states of itself, and what the elements leave open.
Html bounds_of(const Json& report, const Json& load) {
  struct Bounded {
    const char *key, *words, *of_elements;
  };
  static constexpr std::array<Bounded, 6> kBounds{
      {{"max_torque", "largest torque", "max_torque"},
       {"pressure_arm", "arm as pressed", "pressure_arm"},
       {"indentation", "indentation", "indentation"},
       {"normal_stiffness", "stiffness", "normal_stiffness"},
       {"tilt_stiffness", "tilt stiffness", "tilt_stiffness"},
       {"peak_pressure", "peak pressure", "peak_pressure_inside"}}};
  Html rows;
  int known = 0, held = 0;
  for (const Json& model : child(load, "models"))
    for (const auto& [key, words, of_elements] : kBounds) {
      const auto bound = number(child(model, "error_bound"), key),
                 error = number(child(model, "relative_error"), key);
      if (!bound || !error) continue;
      const bool holds =
          std::abs(*error) <= *bound + stated_by_elements(child(load, "fem"), of_elements);
      ++known;
      held += holds;
      rows += html(
          "<tr><th scope=\"row\">{}</th><td class=\"words\">{}</td><td>{}</td><td>±\u00a0{}</td>"
          "<td class=\"words {}\">{}</td></tr>\n",
          model_key(report, text(model, "model")), words, signed_percent(*error), percent(*bound),
          holds ? "within" : "beyond", holds ? "holds" : "is exceeded");
    }
  if (known == 0) return "";
  return details(held == known
                     ? Html("Do the models’ own bounds hold? Yes, all of them")
                     : html("Do the models’ own bounds hold? <b>{} of {}</b> do", held, known),
                 scrolling_table("<tr>" + column_heading("model") + column_heading("quantity") +
                                     column_heading("error") + column_heading("stated bound") +
                                     column_heading("") + "</tr>",
                                 rows));
}

Html pad_warnings(const Json& report, const Json& load) {
  Html items;
  for (const Json& model : child(load, "models")) {
    std::vector<Html> reasons;
    for (const Json& check : child(model, "validity"))
      if (!flag(check, "holds"))
        reasons.push_back(escape(with_labels(report, text(check, "message"))));
    if (!reasons.empty())
      items += html("<li><b>{}</b>: {}</li>\n", label(text(model, "model")), joined(reasons, "; "));
  }
  return items.empty() ? "" : "<ul class=\"warnings\">" + items + "</ul>\n";
}

Html pad_simulator_line(const Json& pad, const Json& load) {
  const auto force = number(load, "load_N"), friction = number(pad, "friction_coefficient"),
             torque = number(child(load, "fem"), "max_torque_Nm"),
             stated = number(child(child(load, "fem"), "error"), "max_torque");
  if (!force || !torque || !friction || !(*force > 0)) return "";
  return html(
      "<p class=\"simulator\">MuJoCo at any load, for one contact point in the middle: "
      "<code>condim=\"4\" {}</code>, the torque {}</p>\n",
      exporting::mujoco_friction(*friction, *torque / *force),
      stated ? html("±\u00a0{}", percent(*stated)) : Html("not known to any per cent"));
}

Html elements_details(const Json& load) {
  const Json& fem = child(load, "fem");
  if (fem.is_null()) return "";
  Html rows;
  for (const Json& level : child(fem, "levels")) {
    rows += html("<tr><td>{}</td><td>{}</td>", text(level, "level"), text(level, "unknowns"));
    for (const PadColumn& column : kPadTable)
      if (column.place < 0 && *column.stated != '\0')
        rows += html("<td>{}</td>",
                     significant(number(level, column.key == std::string_view("peak_pressure_Pa")
                                                   ? "peak_pressure_inside_Pa"
                                                   : column.key),
                                 column.factor, 5));
    rows += "</tr>\n";
  }
  Html head = column_heading("level") + column_heading("unknowns");
  for (const PadColumn& column : kPadTable)
    if (column.place < 0 && *column.stated != '\0')
      head += column_heading(column.heading, column.unit);
  const auto stated = number(child(fem, "error"), "max_torque"),
             pressed = number(child(fem, "error"), "indentation");
  return details(
      html("Can this reference be trusted? {}: torque {}, indentation {}",
           flag(fem, "trusted") ? Html("Yes") : "<b>Not yet</b>",
           stated ? html("±\u00a0{}", percent(*stated)) : Html("not known"),
           pressed ? html("±\u00a0{}", percent(*pressed)) : Html("not known")),
      scrolling_table("<tr>" + head + "</tr>", rows) +
          html("<p class=\"facts\">The whole pad with its free sides, linear, unknowns {}, time "
               "{}, peak memory {} MB. Integrals are extrapolated from both levels.{}</p>\n",
               text(fem, "unknowns"), duration(number(fem, "wall_s").value_or(NAN)),
               significant(number(fem, "peak_memory_MB"), 1, 3),
               number(fem, "lifted_share").value_or(0) > 0
                   ? html(" {} of the face have lifted off.", percent(*number(fem, "lifted_share")))
                   : ""));
}

Html pad_figure(const Html& kind, const Html& heading, const Html& caption) {
  return html(
      "<figure data-chart=\"{}\"><figcaption><b>{}</b> {}</figcaption>"
      "<div class=\"plot\"></div></figure>\n",
      kind, heading, caption);
}

/// A model over all loads of a pad.
struct PadScore {
  std::string model;
  double worst = 0;  ///< error of the torque, with its sign
  double load_N = 0;
  bool usable = true, sound = true;  ///< at all of them
};

/// The usable one, else the one whose torque is nearest; nothing without a reference.
std::optional<PadScore> nearest_to_pad(const Json& pad) {
  std::vector<PadScore> scores;
  for (const Json& load : child(pad, "loads"))
    for (const Json& model : child(load, "models")) {
      const auto error = number(child(model, "relative_error"), "max_torque");
      if (!error) continue;
      const std::string name = text(model, "model");
      auto score = std::find_if(scores.begin(), scores.end(),
                                [&](const PadScore& one) { return one.model == name; });
      if (score == scores.end()) score = scores.insert(scores.end(), {name, 0, 0, true, true});
      if (std::abs(*error) >= std::abs(score->worst)) {
        score->worst = *error;
        score->load_N = number(load, "load_N").value_or(NAN);
      }
      score->usable = score->usable && flag(model, "usable");
      score->sound = score->sound && flag(model, "sound");
    }
  const auto rank = [](const PadScore& score) {
    return std::pair(!score.usable, std::abs(score.worst));
  };
  const auto best = std::min_element(
      scores.begin(), scores.end(),
      [&](const PadScore& one, const PadScore& two) { return rank(one) < rank(two); });
  return best == scores.end() ? std::nullopt : std::optional(*best);
}

double rounded_to(double value, int digits) {
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

Json rounded_list(const Json& numbers) {
  Json list = Json::array();
  for (const Json& one : numbers)
    list.push_back(one.is_number() ? Json(rounded_to(one.get<double>(), 5)) : one);
  return list;
}

Json drawn_profile(const Json& profile) {
  if (!profile.is_object()) return nullptr;
  return {{"x", rounded_list(child(profile, "position_m"))},
          {"p", rounded_list(child(profile, "pressure_Pa"))}};
}

Json drawn_answer(const Json& answer) {
  if (answer.is_null()) return nullptr;
  Json drawn = {{"profile_x", drawn_profile(child(answer, "profile_x"))},
                {"profile_y", drawn_profile(child(answer, "profile_y"))}};
  for (const char* key : {"max_torque_Nm", "peak_pressure_Pa", "cost_ns", "wall_s"}) {
    const auto value = number(answer, key);
    drawn[key] = value ? Json(rounded_to(*value, 8)) : Json();
  }
  return drawn;
}

Json drawn_load(const Json& load) {
  const Json& fem = child(load, "fem");
  Json elements = drawn_answer(fem), models = Json::array();
  if (!elements.is_null()) {
    const Json& pressure = child(fem, "pressure");
    const auto stated = number(child(fem, "error"), "max_torque");
    elements["error"] = {{"max_torque", stated ? Json(*stated) : Json()}};
    elements["pressure"] = {{"x", rounded_list(child(pressure, "x_m"))},
                            {"y", rounded_list(child(pressure, "y_m"))},
                            {"p", rounded_list(child(pressure, "pressure_Pa"))}};
  }
  for (const Json& model : child(load, "models")) {
    Json drawn = drawn_answer(model);
    const auto error = number(child(model, "relative_error"), "max_torque");
    drawn["model"] = text(model, "model");
    drawn["has_answer"] = flag(model, "has_answer");
    drawn["sound"] = flag(model, "sound");
    drawn["relative_error"] = {{"max_torque", error ? Json(*error) : Json()}};
    models.push_back(std::move(drawn));
  }
  return {{"load_N", child(load, "load_N")},
          {"fem", std::move(elements)},
          {"models", std::move(models)}};
}

}  // namespace

bool is_pad(const Json& report_case) { return text(report_case, "contact") == "patch"; }

Html pads_summary(const Json& pads) {
  if (pads.empty()) return "";
  int loads = 0, usable = 0;
  std::vector<Html> names;
  double torque = 0, stiffness = 0;
  std::vector<Html> open;
  for (const Json& pad : pads)
    for (const Json& load : child(pad, "loads")) {
      ++loads;
      // The first model is the default.
      const Json& models = child(load, "models");
      const bool is_usable = !models.empty() && flag(models.front(), "usable");
      if (is_usable) {
        const Json& errors = child(models.front(), "relative_error");
        const Html name = html("<b>{}</b>", label(text(models.front(), "model")));
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        torque = std::max(torque, std::abs(number(errors, "max_torque").value_or(0)));
        stiffness = std::max(stiffness, std::abs(number(errors, "normal_stiffness").value_or(0)));
      }
      usable += is_usable;
      if (!is_usable)
        open.push_back(html("<a href=\"#{}\">{}</a> at {}", case_anchor(pad), text(pad, "id"),
                            newton(number(load, "load_N").value_or(NAN))));
    }
  Html words = "Flat pads: ";
  if (usable > 0)
    words += html("use {} {}: torque within {}, stiffness within {}. ", joined(names, " or "),
                  usable == loads ? Html("everywhere") : html("at {} of {} loads", usable, loads),
                  percent(torque), percent(stiffness));
  if (!open.empty()) words += html("Ask the finite elements for {}. ", joined(open, ", "));
  return "<p class=\"lead\">" + words +
         html("<small>{} against finite elements of the whole pad, in linear theory.</small></p>\n",
              pads.size() == 1 ? std::string("One pad") : fmt::format("{} pads", pads.size())) +
         torques_sentence(pads);
}

Html pads_overview(const Json& report, const Json& pads) {
  if (pads.empty()) return "";
  Html rows;
  for (const Json& pad : pads) {
    Html model = "–", error = "–";
    if (const auto best = nearest_to_pad(pad)) {
      model = model_key(report, best->model) +
              (best->sound ? Html("") : Html("<small>states no bound here</small>"));
      error = html("<span class=\"{}\">{}</span><small>torque at {}</small>",
                   std::abs(best->worst) > tolerance(report) ? "beyond"
                   : best->sound                             ? "within"
                                                             : "",
                   percent(std::abs(best->worst)), newton(best->load_N));
    }
    rows += html(
        "<tr data-filtered=\"{}\"><th scope=\"row\"><a href=\"#{}\">{}</a><small>{}</small></th>"
        "<td class=\"words\" data-label=\"torque, FEM\">{}</td>"
        "<td class=\"words\" data-label=\"nearest\">{}</td>"
        "<td data-label=\"its worst error\">{}</td>"
        "<td class=\"words\">{}<span>{}</span></td></tr>\n",
        searched_text(pad), case_anchor(pad), text(pad, "id"), text(pad, "question"),
        torques_cell(pad), model, error, verdict_badge(pad), text(pad, "verdict"));
  }
  return "<table class=\"overview cases\"><thead><tr><th scope=\"col\">flat pad and question</th>"
         "<th scope=\"col\">torque, FEM</th><th scope=\"col\">nearest model</th><th "
         "scope=\"col\">its worst error</th>"
         "<th scope=\"col\">verdict</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table>\n";
}

Html pad_section(const Json& report, const Json& pad, bool has_overview) {
  const Json& loads = child(pad, "loads");
  const Json& layer = child(pad, "layer");
  const std::string id = text(pad, "id"), question = text(pad, "question");
  Html out = html(
      "<section class=\"case\" id=\"{}\" data-case=\"{}\" data-filtered=\"{}\">\n"
      "{}<h3>{}</h3>\n<p class=\"verdict {}\">{} {}</p>\n",
      case_anchor(pad), id, searched_text(pad), kicker(id, has_overview),
      question.empty() ? id : question, text(pad, "verdict_class"), verdict_badge(pad),
      text(pad, "verdict"));
  out += html("<p class=\"facts\">{} · {} mm, E {} kPa, ν {} · friction coefficient {}</p>\n",
              text(pad, "description"), plain(number(layer, "thickness_m"), 1e3),
              plain(number(layer, "youngs_modulus_Pa"), 1e-3),
              plain(number(layer, "poisson_ratio")), plain(number(pad, "friction_coefficient")));
  if (loads.size() > 1) {
    out += "<div class=\"loads\" role=\"group\" aria-label=\"Load\" hidden><span>Load</span>";
    for (std::size_t i = 0; i < loads.size(); ++i)
      out += html("<button type=\"button\" data-load=\"{}\">{}</button>", i,
                  newton(number(loads[i], "load_N").value_or(0)));
    out += "</div>\n";
  }
  Html keys = "<li>" + model_key(report, "fem") + "</li>";
  if (!loads.empty())
    for (const Json& model : child(loads[0], "models"))
      keys += "<li>" + model_key(report, text(model, "model")) + "</li>";
  out +=
      "<ul class=\"legend\">" + keys + "</ul>\n<div class=\"charts\">\n" +
      pad_figure(
          "padmap", "Pressure of the finite elements.",
          "Seen along the load. The thick outline is the contact’s, a thin one that of a pad "
          "which goes on beside it; dashed are the lines of the next picture.") +
      pad_figure("padpressure", "Pressure along both lines.",
                 "From edge to edge; points are FEM nodes. At the rim of a stuck face, and at an "
                 "object’s edge, linear theory has no largest pressure, and the picture ends.") +
      pad_figure("torque", "Largest torque about the normal.",
                 "Grey band: FEM with its stated error.") +
      pad_figure("ellipsoid", "Friction ellipsoid.",
                 "Largest torque that a tangential force leaves, f² + τ²/eₙ² = μ²P².") +
      "</div>\n";
  for (std::size_t i = 0; i < loads.size(); ++i)
    out += html("<div class=\"load\" data-load=\"{}\">\n<h4>Load {}</h4>\n", i,
                newton(number(loads[i], "load_N").value_or(0))) +
           pad_numbers(report, loads[i]) + pad_warnings(report, loads[i]) +
           pad_simulator_line(pad, loads[i]) + bounds_of(report, loads[i]) +
           elements_details(loads[i]) + "</div>\n";
  if (!text(pad, "case_toml").empty())
    out += details(html("Case file <code>{}</code>", text(pad, "file")),
                   html("<pre>{}</pre>\n", text(pad, "case_toml")));
  return out + "</section>\n";
}

Json pads_chart_data(const Json& pads) {
  Json drawn = Json::array();
  for (const Json& pad : pads) {
    Json loads = Json::array();
    for (const Json& load : child(pad, "loads")) loads.push_back(drawn_load(load));
    drawn.push_back({{"id", text(pad, "id")},
                     {"friction_coefficient", child(pad, "friction_coefficient")},
                     {"outline", child(pad, "outline_m")},
                     {"pad_outline", child(pad, "pad_outline_m")},
                     {"loads", std::move(loads)}});
  }
  return drawn;
}

}  // namespace softfinger::report
