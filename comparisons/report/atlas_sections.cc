#include "comparisons/report/atlas_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "comparisons/report/case_section.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

struct NamedQuantity {
  const char* key;
  const char* name;
};
constexpr std::array<NamedQuantity, 6> kQuantities{{{"max_torque", "torque"},
                                                    {"area", "area"},
                                                    {"indentation", "indentation"},
                                                    {"peak_pressure", "peak pressure"},
                                                    {"a", "a"},
                                                    {"b", "b"}}};

bool has_atlas(const Json& report) {
  const Json& models = child(child(report, "atlas"), "models");
  return models.is_array() && !models.empty();
}

/// `1.2 % · 8.4 % · 31 %`: median, 95 %, worst.
Html spread(const Json& quantiles) {
  const auto median = number(quantiles, "median"), worst = number(quantiles, "worst"),
             p95 = number(quantiles, "p95");
  if (!median || !p95 || !worst) return "<td>–</td>";
  return html("<td>{} <small>95 %: {}</small><small>worst: {}</small></td>", percent(*median),
              percent(*p95), percent(*worst));
}

Html quantity_buttons() {
  std::vector<SettingButton> buttons;
  for (const NamedQuantity& quantity : kQuantities)
    buttons.push_back({quantity.key, quantity.name});
  return setting_buttons("quantity", "Error of", buttons, 0);
}

/// The ratio of the grid that is nearest to most contacts of the page: their map is shown first.
std::size_t usual_ratio(const Json& atlas) {
  const Json& ratios = child(child(atlas, "grid"), "radii_ratio");
  if (!ratios.is_array() || ratios.empty()) return 0;
  std::vector<int> votes(ratios.size(), 0);
  for (const Json& mark : child(atlas, "marks")) {
    const auto ratio = number(mark, "radii_ratio");
    if (!ratio || *ratio <= 0 || flag(mark, "seed")) continue;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < ratios.size(); ++i)
      if (std::abs(std::log(*ratio / element(ratios, i).value_or(1))) <
          std::abs(std::log(*ratio / element(ratios, nearest).value_or(1))))
        nearest = i;
    ++votes[nearest];
  }
  std::size_t best = 0;
  for (std::size_t i = 0; i < votes.size(); ++i)
    if (votes[i] > votes[best]) best = i;
  return best;
}

Html quantile_table(const Json& report) {
  Html head =
      column_heading("model") + column_heading("time of one answer") + column_heading("contacts");
  for (const NamedQuantity& quantity : kQuantities) head += column_heading(quantity.name);
  Html rows;
  for (const Json& model : child(child(report, "atlas"), "models")) {
    const std::string name = text(model, "model");
    const auto row = [&](const Html& title, const Json& quantiles) {
      rows += html("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td>", title,
                   duration(1e-9 * number(model, "cost_ns").value_or(NAN)),
                   plain(number(child(quantiles, kQuantities[0].key), "count")));
      for (const NamedQuantity& quantity : kQuantities)
        rows += spread(child(quantiles, quantity.key));
      rows += "</tr>\n";
    };
    row(model_key(report, name), child(model, "quantiles"));
    if (!child(model, "claimed").is_null())
      row("<span class=\"unit\">… where it says it holds</span>", child(model, "claimed"));
    if (const Json& paper = child(model, "paper_torque"); !paper.is_null())
      rows += html(
          "<tr><th scope=\"row\"><span class=\"unit\">… with the paper’s √(ab) "
          "rule</span></th><td></td><td>{}</td>{}<td colspan=\"5\" class=\"words\"></td></tr>\n",
          plain(number(paper, "count")), spread(paper));
  }
  return scrolling_table(head, rows);
}

Html law_table(const Json& report) {
  Html rows;
  for (const Json& law : child(child(report, "atlas"), "friction_laws"))
    rows += html("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                 text(law, "name"), duration(1e-9 * number(law, "cost_ns").value_or(NAN)),
                 percent(number(child(law, "error"), "median").value_or(NAN)),
                 percent(number(child(law, "error"), "worst").value_or(NAN)));
  return scrolling_table(column_heading("friction limit") + column_heading("time of one answer") +
                             column_heading("median error") + column_heading("worst error"),
                         rows);
}

/// Parts of the grid on which a model is within each limit.
Html share_table(const Json& report) {
  constexpr std::array<double, 4> kLimits{0.01, 0.05, 0.10, 0.25};
  const Json& atlas = child(report, "atlas");
  const Json& grid = child(atlas, "grid");
  const std::size_t ratios = child(grid, "radii_ratio").size(), sizes = child(grid, "s").size();
  Html rows;
  for (const Json& model : child(atlas, "models")) {
    const std::string name = text(model, "model");
    if (name == "fem_coarse") continue;
    const Json& errors = child(child(model, "grid"), "max_torque");
    if (!errors.is_array()) continue;
    for (std::size_t ratio = 0; ratio < ratios; ++ratio) {
      std::array<int, 4> within{};
      int all = 0;
      for (std::size_t i = 0; i < errors.size(); ++i) {
        if (sizes == 0 || i / sizes % ratios != ratio) continue;
        ++all;
        const auto error = element(errors, i);
        for (std::size_t k = 0; k < kLimits.size(); ++k)
          if (error && std::abs(*error) <= kLimits[k]) ++within[k];
      }
      rows += html("<tr><th scope=\"row\">{}</th><td>{}</td>",
                   ratio == 0 ? model_key(report, name) : "",
                   plain(element(child(grid, "radii_ratio"), ratio)));
      for (const int count : within)
        rows += all ? html("<td>{:.0f}\u00a0%</td>", 100. * count / all) : "<td>–</td>";
      rows += "</tr>\n";
    }
  }
  return scrolling_table(column_heading("model") + column_heading("R′/R″") +
                             column_heading("within 1 %") + column_heading("5 %") +
                             column_heading("10 %") + column_heading("25 %"),
                         rows);
}

Html figure(const Html& attributes, const Html& caption) {
  return "<figure " + attributes + "><figcaption>" + caption +
         "</figcaption><div class=\"plot\"></div></figure>\n";
}

/// Whether each of the names is that of an entry of the list for which `counts` holds.
template <typename Counts>
bool has_each(const Json& list, const std::vector<std::string>& models, const Counts& counts) {
  return std::all_of(models.begin(), models.end(), [&](const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const Json& entry) {
      return text(entry, "model") == name && counts(entry);
    });
  });
}

}  // namespace

bool atlas_has(const Json& report, const std::vector<std::string>& models) {
  return has_atlas(report) && has_each(child(child(report, "atlas"), "models"), models,
                                       [](const Json&) { return true; });
}

bool atlas_has_causes(const Json& report, const std::vector<std::string>& models) {
  return has_atlas(report) &&
         has_each(child(child(report, "atlas"), "models"), models,
                  [](const Json& entry) { return !child(entry, "causes").is_null(); });
}

bool finite_strain_has(const Json& report, const std::vector<std::string>& models) {
  const Json& groups = child(report, "finite_strain");
  return std::any_of(groups.begin(), groups.end(), [&](const Json& group) {
    return has_each(child(group, "models"), models, [](const Json&) { return true; });
  });
}

Html setting_buttons(const std::string& setting, const std::string& label,
                     const std::vector<SettingButton>& buttons, std::size_t pressed) {
  Html out = html(
      "<div class=\"loads\" role=\"group\" aria-label=\"{0}\" data-setting=\"{1}\" "
      "hidden><span>{0}</span>",
      label, setting);
  for (std::size_t i = 0; i < buttons.size(); ++i)
    out += html("<button type=\"button\" data-value=\"{}\" aria-pressed=\"{}\">{}</button>",
                buttons[i].value, i == pressed, buttons[i].label);
  return out + "</div>\n";
}

Html speed_accuracy_section(const Json& report) {
  if (!has_atlas(report)) return "";
  return "<h2 id=\"speed\">Cost and accuracy of the models</h2>\n"
         "<p>Every model compared with finite elements over the whole error atlas: contacts from a "
         "tenth "
         "of the layer’s thickness to several times it, Poisson’s ratios from sponge to rubber, "
         "relative radii from equal to ten times each other.</p>\n" +
         quantity_buttons() +
         setting_buttons("within", "Over",
                         {{"all", "all contacts"}, {"claimed", "where the model says it holds"}},
                         0) +
         "<div class=\"charts\">\n" +
         figure("data-chart=\"speed\"",
                "<b>Speed against accuracy.</b> Broad bar: median to 95 % of the contacts (large "
                "mark); cross: the worst. Hollow, dashed: with the paper’s √(ab) rule. " +
                    (child(report, "choices").is_array()
                         ? Html("Diamonds: stated errors of the case, ring: the choice. ")
                         : "") +
                    "Staircase: the smallest error (95 %) for that time. FEM: the error that it "
                    "states "
                    "itself; coarse mesh: its difference to the finer one.") +
         figure(
             "data-chart=\"friction\"",
             "<b>The friction limit.</b> Replacements of the exact limit surface, with their "
             "largest "
             "radial error over the atlas’s contact shapes (bar: from the median). For facets: "
             "what "
             "they cut off the ellipsoid. The exact surface has only rounding errors and is drawn "
             "at 0.01 %.") +
         "</div>\n" +
         details("Median, 95 % and worst error of every model as numbers", quantile_table(report)) +
         details("Cost and error of the friction limits as numbers", law_table(report));
}

Html validity_map_section(const Json& report) {
  if (!has_atlas(report)) return "";
  const Json& atlas = child(report, "atlas");
  std::vector<SettingButton> ratios;
  for (std::size_t i = 0; i < child(child(atlas, "grid"), "radii_ratio").size(); ++i)
    ratios.push_back(
        {std::to_string(i), plain(element(child(child(atlas, "grid"), "radii_ratio"), i))});
  Html maps;
  for (const Json& model : child(atlas, "models"))
    if (text(model, "model") != "fem_coarse")
      maps += figure(html("data-chart=\"validity\" data-model=\"{}\"", text(model, "model")), "");
  Html key = "<ul class=\"legend\">";
  constexpr std::array<const char*, 5> kBands{"below 1 %", "1 to 5 %", "5 to 10 %", "10 to 25 %",
                                              "above 25 %"};
  for (std::size_t i = 0; i < kBands.size(); ++i)
    key += html(
        "<li><span class=\"key\"><svg width=\"18\" height=\"12\" aria-hidden=\"true\"><rect "
        "width=\"18\" height=\"12\" fill=\"var(--map-{})\"/></svg>{}</span></li>",
        i, kBands[i]);
  key +=
      "<li>dashed: where the model says that its assumptions hold</li><li>○ contacts of this "
      "page</li>"
      "<li>× fingertips of Ciocarlie et al. (2007)</li></ul>\n";
  Html marks;
  for (const Json& mark : child(atlas, "marks"))
    marks +=
        html("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
             text(mark, "id"), newton(number(mark, "load_N").value_or(NAN)),
             significant(number(mark, "s"), 1, 3), plain(number(mark, "poisson_ratio")),
             significant(number(mark, "radii_ratio"), 1, 3));
  return "<h2 id=\"maps\">Where each model holds</h2>\n"
         "<p>Relative error over the contact’s size s and Poisson’s ratio ν, interpolated between "
         "the finite-element runs. A narrow strip of small error between two regions of large "
         "error "
         "is where the error changes its sign; the model is not valid there. Faint marks belong to "
         "another R′/R″. These maps are of flat layers in linear theory; what strain, slope and a "
         "curved layer add is in the verdicts and stated errors, not here.</p>\n" +
         quantity_buttons() + setting_buttons("ratio", "R′/R″", ratios, usual_ratio(atlas)) + key +
         "<div class=\"charts maps\">\n" + maps + "</div>\n" +
         details("Part of the atlas’s contacts on which the torque is within a limit",
                 share_table(report)) +
         (marks.empty() ? ""
                        : details("The marked contacts",
                                  scrolling_table(column_heading("case") + column_heading("load") +
                                                      column_heading("s, predicted") +
                                                      column_heading("ν") + column_heading("R′/R″"),
                                                  marks)));
}

Html error_causes_section(const Json& report) {
  if (!has_atlas(report)) return "";
  const Json& atlas = child(report, "atlas");
  Html rows;
  const Json* finite_elements = nullptr;
  for (const Json& model : child(atlas, "models")) {
    if (text(model, "model") == "fem") finite_elements = &model;
    const Json& causes = child(model, "causes");
    if (causes.is_null()) continue;
    rows += "<tr><th scope=\"row\">" + model_key(report, text(model, "model")) + "</th>" +
            spread(child(causes, "ellipse")) + spread(child(causes, "pressure")) +
            spread(child(causes, "circle_rule")) + spread(child(causes, "max_torque")) + "</tr>\n";
  }
  Html common;
  for (const Json& law : child(atlas, "friction_laws")) {
    const std::string name = text(law, "name");
    if (name.find("rule") != std::string::npos || name.find("exact") != std::string::npos) continue;
    common += html("<li>{}: {} in the median, {} at worst</li>\n", name,
                   percent(number(child(law, "error"), "median").value_or(NAN)),
                   percent(number(child(law, "error"), "worst").value_or(NAN)));
  }
  if (finite_elements) {
    const Json& stated = child(child(*finite_elements, "quantiles"), "max_torque");
    common += html(
        "<li>discretisation of the finite elements, as they state it: {} in the median, {} at "
        "worst</li>\n",
        percent(number(stated, "median").value_or(NAN)),
        percent(number(stated, "worst").value_or(NAN)));
  }
  return "<h2 id=\"causes\">Where the error comes from</h2>\n"
         "<p>The error of the torque is split into factors: torque of the model over torque of the "
         "finite elements = (1 + ellipse)(1 + pressure) by the exact rule. The √(ab) rule of "
         "Ciocarlie et al. adds a third factor. <i>Ellipse</i>: the error from the model’s a and "
         "b; "
         "<i>pressure</i>: the error from its pressure distribution over the true ellipse. Errors "
         "may cancel each other. Median, 95 % and worst, flat layers.</p>\n" +
         scrolling_table(column_heading("model") + column_heading("ellipse") +
                             column_heading("pressure") +
                             column_heading("√(ab) rule instead of the exact one") +
                             column_heading("torque, exact rule"),
                         rows) +
         "<p>Further errors, which are the same for every model:</p>\n<ul>" + common + "</ul>\n";
}

Html finite_strain_section(const Json& report) {
  const Json& groups = child(report, "finite_strain");
  if (!groups.is_array() || groups.empty()) return "";
  constexpr std::array<NamedQuantity, 4> kJudged{
      {{"a", "a"}, {"area", "area"}, {"indentation", "d"}, {"max_torque", "torque"}}};
  const auto tables_of = [&](const std::string& kind) {
    Html rows;
    for (const Json& group : groups) {
      if (text(group, "kind") != kind) continue;
      const Json& depth = child(group, "indentation_over_thickness");
      Html where = html(
          "<th scope=\"rowgroup\" rowspan=\"{}\">ν {}, d/h {}–{}<small>{} contacts, a/R to "
          "{}</small></th>",
          child(group, "models").size(), plain(number(group, "poisson_ratio")),
          plain(element(depth, 0)), plain(element(depth, 1)), plain(number(group, "count")),
          significant(number(group, "largest_a_over_R"), 1, 2));
      for (const Json& model : child(group, "models")) {
        const std::string name = text(model, "model");
        rows += "<tr>" + where + "<th scope=\"row\">" +
                (name == "fem_linear" ? "linear FEM" : model_key(report, name)) + "</th>";
        where = "";
        for (const NamedQuantity& quantity : kJudged) {
          const Json& quantiles = child(child(model, "quantiles"), quantity.key);
          const auto median = number(quantiles, "median"), worst = number(quantiles, "worst");
          rows += median && worst ? html("<td>{} <small>worst: {}</small></td>", percent(*median),
                                         percent(*worst))
                                  : "<td>–</td>";
        }
        rows += "</tr>\n";
      }
    }
    Html head = column_heading("contacts") + column_heading("model");
    for (const NamedQuantity& quantity : kJudged) head += column_heading(quantity.name);
    return scrolling_table(head, rows);
  };
  // The last group has the largest nu and indentation: a silicone fingertip in a hard grip.
  Html answer;
  for (const Json& group : groups) {
    if (text(group, "kind") != "finite_sphere") continue;
    std::vector<Html> errors;
    for (const Json& model : child(group, "models")) {
      const std::string name = text(model, "model");
      const auto worst = number(child(child(model, "quantiles"), "max_torque"), "worst");
      if (!worst) continue;
      errors.push_back(
          html("{} {}", name == "fem_linear" ? "linear FEM" : label(name), percent(*worst)));
    }
    answer =
        html("At ν {} and d/h of {} and more, the largest errors of the torque are: {}.",
             plain(number(group, "poisson_ratio")),
             plain(element(child(group, "indentation_over_thickness"), 0)), joined(errors, ", "));
  }
  return "<h2 id=\"finite-strain\">What large deformation changes</h2>\n"
         "<p>Every model and the linear finite elements, compared at the same load with finite "
         "elements at finite strain (a neo-Hookean layer, the contact found on its deformed "
         "surface). The tables show up to which indentation a linear theory describes a rubber "
         "layer: medians and largest values of |relative error|. Area and torque are those of the "
         "deformed, inclined surface. " +
         answer + "</p>\n" + details("A sphere on a flat layer", tables_of("finite_sphere")) +
         details(
             "A round finger with a curved layer on a plane: the errors include that of replacing "
             "it by "
             "a flat layer",
             tables_of("finite_curved")) +
         details(
             "The suite’s silicone pads and the fingers of Ciocarlie et al., 0.01 to 10 N: "
             "paraboloids on flat "
             "layers",
             tables_of("finite_pad"));
}

Html atlas_provenance(const Json& report) {
  if (!has_atlas(report)) return "";
  const Json& atlas = child(report, "atlas");
  const Json& runs = child(atlas, "runs");
  std::string kinds;
  for (const auto& kind : runs.items())
    kinds += (kinds.empty() ? "" : ", ") + text(runs, kind.key()) + " " + kind.key();
  Html value = escape(kinds) + " finite-element runs";
  const Json& source = child(atlas, "provenance");
  if (const std::string version = text(source, "version"); !version.empty())
    value += html(", version {}", version);
  if (const std::string date = text(source, "date"); !date.empty()) value += html(", {}", date);
  if (const std::string command = text(source, "command"); !command.empty())
    value += html(", <code>{}</code>", command);
  return "<dt>error atlas</dt><dd>" + value +
         "; its numbers are in <code>share/softfinger/error_atlas.csv</code></dd>";
}

Json chart_styles(const Json& report) {
  Json styles = Json::object();
  for (const std::string& name : model_names(report)) {
    const Style drawn = style(report, name);
    styles[name] = {{"label", label(name)}, {"colour", drawn.colour}, {"dash", drawn.dash}};
  }
  return styles;
}

Json atlas_chart_data(const Json& report) {
  if (!has_atlas(report)) return nullptr;
  Json drawn = child(report, "atlas");
  for (Json& model : drawn["models"])
    if (model.is_object()) model.erase("causes");
  drawn.erase("provenance");
  return drawn;
}

}  // namespace softfinger::report
