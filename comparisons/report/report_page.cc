#include "comparisons/report/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "comparisons/exporting/simulator.h"
#include "comparisons/judgement/scoring.h"
#include "comparisons/report/atlas_sections.h"
#include "comparisons/report/case_section.h"
#include "comparisons/report/chart_data.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/experiments_page.h"
#include "comparisons/report/html.h"
#include "comparisons/report/pad_section.h"
#include "comparisons/report/page.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

std::string plural(int count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

Html range(std::optional<double> low, std::optional<double> high) {
  if (!low || !high) return "–";
  const Html from = significant(*low, 2), to = significant(*high, 2);
  return from == to ? from : from + " to " + to;
}

/// Poisson ratios differ where two digits no longer show it: 0.49, 0.4999.
std::string input_range(std::optional<double> low, std::optional<double> high) {
  if (!low || !high) return "–";
  return *low == *high ? plain(low) : plain(low) + " to " + plain(high);
}

Html trust_sentence(const judgement::ReferenceSummary& reference, double tolerance) {
  if (reference.solved == 0)
    return "The finite elements found no solution, so that nothing can be compared.";
  const double stated = std::max(
      {reference.worst_torque_error, reference.worst_axis_error, reference.worst_geometry_error});
  Html numbers = html(
      "stated error of the torque {} in the median and {} at worst, of the semi-axes {} at worst",
      percent(reference.median_torque_error), percent(reference.worst_torque_error),
      percent(reference.worst_axis_error));
  if (std::isinf(reference.worst_geometry_error))
    numbers += "; what a scan's mesh leaves open is not known of all of them";
  else if (reference.worst_geometry_error > 0)
    numbers += html("; the meshes of scans leave up to {} open in a, b, area or torque",
                    percent(reference.worst_geometry_error));
  if (reference.trusted == reference.solved)
    return html("<b>The finite elements can be trusted</b> at {}: {}{}.",
                reference.solved == reference.loads
                    ? "all of them"
                    : fmt::format("the {} they solved", reference.solved),
                numbers, stated < tolerance / 3 ? ", well below the tolerance" : "");
  return html("<b>The finite elements can be trusted at {} of the {}</b> they solved: {}.",
              reference.trusted, reference.solved, numbers);
}

using Cases = std::vector<judgement::CaseErrors>;

std::vector<judgement::Usability> usability(const Json& report, const Cases& cases) {
  return judgement::usability(cases, model_names(report), tolerance(report));
}

/// One load of one case, by its place in the report.
struct ComparedLoad {
  const judgement::CaseErrors* of;
  const judgement::LoadErrors* load;
};

/// The usable models of a load, and their errors.
std::vector<const judgement::ModelError*> usable_models(const judgement::LoadErrors& load,
                                                        double limit) {
  std::vector<const judgement::ModelError*> found;
  for (const judgement::ModelError& model : load.models)
    if (judgement::judge(load, model, limit) == judgement::Judgement::usable)
      found.push_back(&model);
  return found;
}

/// "seed_thumb at 5 N", for each load.
Html names_of(const std::vector<ComparedLoad>& loads) {
  std::vector<Html> names;
  for (const ComparedLoad& one : loads) {
    const std::string anchor = case_anchor({{"id", one.of->id}});
    names.push_back(
        html("<a href=\"#{}\">{}</a> at {}", anchor, one.of->id, newton(one.load->load_N)));
  }
  return joined(names, ", ");
}

/// A model, where it is usable, and how far it is off there.
struct Recommended {
  std::string model;
  bool hot_path = false;
  double worst = 0, sum_of_errors = 0;
  std::vector<ComparedLoad> usable_at;

  double mean() const { return sum_of_errors / double(usable_at.size()); }
};

/// The model to use: a fast one where there is any, usable at nearly as many of the loads as any
/// other, and the most accurate of those.

std::optional<Recommended> recommended(const std::vector<ComparedLoad>& loads, double limit) {
  std::map<std::string, Recommended> found;
  for (const ComparedLoad& one : loads)
    for (const judgement::ModelError* model : usable_models(*one.load, limit)) {
      Recommended& use = found[model->model];
      use.model = model->model;
      use.hot_path = model->hot_path;
      use.worst = std::max(use.worst, model->larger());
      use.sum_of_errors += model->larger();
      use.usable_at.push_back(one);
    }
  std::size_t most = 0;
  for (const auto& [name, use] : found) most = std::max(most, use.usable_at.size());
  // One load in ten more does not outweigh a smaller error at the other nine.
  const auto rank = [most](const Recommended& use) {
    const bool is_nearly_everywhere = 10 * use.usable_at.size() >= 9 * most;
    return std::tuple(is_nearly_everywhere, use.hot_path, -use.mean());
  };
  std::optional<Recommended> best;
  for (const auto& [name, use] : found)
    if (!best || rank(use) > rank(*best)) best = use;
  return best;
}

/// The models to use for the loads with curved contacts, and the loads for which there is none.
struct Advice {
  std::vector<Recommended> uses;  ///< in the order in which the page names them
  std::vector<ComparedLoad> solved, none, undetermined, unsolved;

  std::vector<std::string> models() const {
    std::vector<std::string> names;
    for (const Recommended& use : uses) names.push_back(use.model);
    return names;
  }
  /// Empty where no model is usable.
  std::string model_at(const judgement::LoadErrors& load) const {
    for (const Recommended& use : uses)
      for (const ComparedLoad& one : use.usable_at)
        if (one.load == &load) return use.model;
    return "";
  }
};

Advice advice_on(const Cases& cases, double limit) {
  Advice advice;
  for (const judgement::CaseErrors& one : cases)
    for (const judgement::LoadErrors& load : one.loads)
      (load.fem_finished ? advice.solved : advice.unsolved).push_back({&one, &load});
  std::vector<ComparedLoad> open = advice.solved;
  while (const auto use = recommended(open, limit)) {
    advice.uses.push_back(*use);
    std::vector<ComparedLoad> left;
    for (const ComparedLoad& one : open)
      if (std::none_of(use->usable_at.begin(), use->usable_at.end(),
                       [&](const ComparedLoad& here) { return here.load == one.load; }))
        left.push_back(one);
    open = left;
  }
  for (const ComparedLoad& one : open)
    (one.load->geometry_error > limit ? advice.undetermined : advice.none).push_back(one);
  return advice;
}

/// Answer to the question which models to use for these contacts.
Html answer(const Advice& advice) {
  std::vector<Html> sentences;
  for (const Recommended& use : advice.uses) {
    const std::size_t count = use.usable_at.size(), all = advice.solved.size();
    const Html where = count == all        ? html("everywhere")
                       : sentences.empty() ? html("at {} of {}", count, plural(int(all), "load"))
                                           : html("for {}", names_of(use.usable_at));
    sentences.push_back(html("Use <b>{}</b> {}: contact and torque within {}.", label(use.model),
                             where, percent(use.worst)));
  }
  if (!advice.none.empty())
    sentences.push_back(
        html("Ask the finite elements for {}: no model is usable there.", names_of(advice.none)));
  if (!advice.undetermined.empty())
    sentences.push_back(
        html("The mesh does not determine {}: take a finer scan, another point or "
             "a larger load.",
             names_of(advice.undetermined)));
  if (!advice.unsolved.empty())
    sentences.push_back(html("There is no reference for {}.", names_of(advice.unsolved)));
  return joined(sentences, " ");
}

/// The first paragraph says what to use, the second how sure that is.
Html summary(const Json& report, const Cases& cases, const Advice& advice) {
  const double limit = tolerance(report);
  const judgement::ReferenceSummary reference = judgement::reference_summary(cases, limit);
  Html out = "<p class=\"lead\">" + answer(advice) + "</p>\n";
  out += torques_sentence(child(report, "cases"));
  out += html("<p>{} at {}, compared with finite elements. {}", plural(reference.cases, "case"),
              plural(reference.loads, "load"), trust_sentence(reference, limit));
  std::vector<Html> models;
  for (const judgement::Usability& use : usability(report, cases))
    if (use.compared > 0) models.push_back(html("{} at {}", label(use.model), use.usable));
  if (reference.solved > 0)
    out += html(
        " Of {}, these models are usable (a, b, area and torque within ±{}, and their assumptions "
        "hold): "
        "{}.",
        plural(reference.solved, "load") + " with a reference", plain(limit, 100) + " %",
        models.empty() ? "none" : joined(models, ", "));
  return out + "</p>\n";
}

const char* in_words(prediction::Quantity quantity) {
  return quantity == prediction::Quantity::max_torque ? "torque"
                                                      : prediction::kQuantityNames[int(quantity)];
}

Html overview_table(const Json& report, const Cases& cases) {
  Html rows;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Json& report_case = child(report, "cases")[i];
    const auto best = judgement::best_model(cases[i], tolerance(report));
    Html model = "–", error = "–";
    if (best) {
      model = model_key(report, best->model) +
              (best->sound ? Html("") : "<small>outside its range</small>");
      error = html("<span class=\"{}\">{}</span><small>{} at {}</small>",
                   best->score.error > tolerance(report) ? "beyond"
                   : best->sound                         ? "within"
                                                         : "",
                   percent(best->score.error), in_words(best->score.quantity),
                   newton(best->score.load_N));
    }
    rows += html(
        "<tr data-filtered=\"{}\"><th scope=\"row\"><a href=\"#{}\">{}</a><small>{}</small></th>"
        "<td class=\"words\" data-label=\"torque, FEM\">{}</td>"
        "<td class=\"words\" data-label=\"nearest\">{}</td>"
        "<td data-label=\"its worst error\">{}</td>"
        "<td class=\"words\">{}<span>{}</span></td></tr>\n",
        searched_text(report_case), case_anchor(report_case), text(report_case, "id"),
        text(report_case, "question"), torques_cell(report_case), model, error,
        verdict_badge(report_case), text(report_case, "verdict"));
  }
  return "<table class=\"overview cases\"><thead><tr><th scope=\"col\">case and question</th>"
         "<th scope=\"col\">torque, FEM</th><th scope=\"col\">nearest model</th><th "
         "scope=\"col\">its worst error</th>"
         "<th scope=\"col\">verdict</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table>\n";
}

Html usability_table(const Json& report, const Cases& cases) {
  Html rows;
  for (const judgement::Usability& use : usability(report, cases)) {
    if (use.compared == 0) continue;
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{} of {}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td><td{}>{}</td><td>{}</td></tr>\n",
        model_key(report, use.model), use.usable, use.compared,
        range(use.smallest_s, use.largest_s), input_range(use.smallest_nu, use.largest_nu),
        percent(use.median), percent(use.worst), use.sound,
        use.broken_claims ? Html(" class=\"beyond\"") : "", use.broken_claims, use.accidents);
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">model</th>"
         "<th scope=\"col\">usable at</th><th scope=\"col\">there, s = √(ab)/h</th>"
         "<th scope=\"col\">there, ν</th><th scope=\"col\">median error</th>"
         "<th scope=\"col\">worst error</th><th scope=\"col\">in its range at</th>"
         "<th scope=\"col\">and fails at</th>"
         "<th scope=\"col\">agrees outside its range at</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

Html overview_charts() {
  return R"(<div class="charts">
<figure data-chart="cost"><figcaption><b>Speed against accuracy.</b> Small marks: one prediction each (hollow where the model’s assumptions fail); large marks: medians. The line joins those for which no other is both faster and more accurate. FEM is shown with the error that it states itself.</figcaption><div class="plot"></div></figure>
<figure data-chart="map"><figcaption><b>Which model where.</b> Every load at its contact size s and Poisson ratio ν, coloured by the model that is recommended there. Hollow: none is usable; the colour is that of the most accurate one.</figcaption><div class="plot"></div></figure>
</div>
)";
}

/// A simulator's constant is right at one load only. The table gives a constant for all loads of a
/// case and its error.
Html simulator_table(const Json& report, bool is_single) {
  Html rows;
  for (const Json& report_case : child(report, "cases")) {
    const auto friction = number(report_case, "friction_coefficient");
    std::vector<double> arms;
    std::vector<Html> at_loads;
    for (const Json& load : child(report_case, "loads")) {
      const auto force = number(load, "load_N");
      const auto torque = number(child(load, "fem"), "max_torque_Nm");
      if (!force || !torque || *force <= 0 || *torque <= 0) continue;
      arms.push_back(*torque / *force);
      at_loads.push_back(html("{:.4g} at {}", arms.back(), newton(*force)));
    }
    if (arms.empty() || !friction) continue;
    const auto [low, high] = std::minmax_element(arms.begin(), arms.end());
    const exporting::BestConstant best = exporting::best_constant(*low, *high);
    rows += html(
        "<tr><th scope=\"row\"><a href=\"#{}\">{}</a></th><td>{:g}</td><td class=\"words\">{}</td>"
        "<td><b>{:.4g}</b></td><td>{}</td></tr>\n",
        case_anchor(report_case), text(report_case, "id"), *friction, joined(at_loads, "<br>"),
        best.value, arms.size() > 1 ? "±\u00a0" + percent(best.worst_error) : "one load only");
  }
  // A single load has its line in its own section.
  if (rows.empty() || (is_single && child(child(report, "cases")[0], "loads").size() < 2))
    return "";
  const Html rule =
      "<p>MuJoCo’s elliptic cone with <code>condim=\"4\"</code> is the friction ellipsoid of "
      "this page: <code>friction[0]</code> is μ, <code>friction[1]</code> the largest torque "
      "divided by the load, e<sub>n</sub>·μ, in metres. Write <code>friction=\"μ friction[1] "
      "0.0001\"</code> on the geom and <code>&lt;option cone=\"elliptic\"/&gt;</code>; of two "
      "geoms in contact the larger value counts. The right value grows with the load, but a "
      "simulator keeps it constant: the last columns give the one constant whose largest "
      "relative error over the loads of the case is smallest, 2/(1/least + 1/largest), and that "
      "error. <code>softfinger export --fit range</code> uses the same rule.</p>\n";
  return "<h2 id=\"simulator\">What to type into a simulator</h2>\n" +
         (is_single ? Html("") : rule) +
         "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">case</th>"
         "<th scope=\"col\">friction[0]</th><th scope=\"col\">friction[1] by FEM <span "
         "class=\"unit\">m"
         "</span></th><th scope=\"col\">one constant <span class=\"unit\">m</span></th>"
         "<th scope=\"col\">its error</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n" +
         (is_single ? details("Where these numbers go, and how the constant is found", rule)
                    : Html(""));
}

Html how_to_read(const Json& report, const Json& pads) {
  const Html of_pads =
      pads.empty()
          ? ""
          : Html(
                "<li>A flat pad touches where pad and face overlap: it has no semi-axes, and its "
                "area is known. A model is called usable there where the largest torque is within "
                "the tolerance and the model states a bound. The reference is the whole pad with "
                "its free sides, in linear theory.</li>\n");
  return html(
      R"(<h2 id="reading">How to read this page</h2>
<ul>
<li>Lengths are in the contact frame: z along the normal, x along the long axis of the contact, so a ≥ b. A contact is described by its load P, the relative radii R′ ≥ R″, the layer (thickness h, Young’s modulus E, Poisson ratio ν) and friction μ.</li>
<li>Errors are (model − FEM)/FEM at the same load. A plus means that the model overestimates. A model is called usable where a, b, area and largest torque are within ±{} and the contact lies in the model’s own range.</li>
<li>The reference is the finger itself at finite strain, unless the case or the command asks for less: what a flat layer, small strain and small slopes cost a model is then part of its errors. “Beyond its limits, measured here” means just that.</li>
<li>± behind an FEM value is the error that it states itself, from its last two meshes. A smaller difference says nothing about a model.</li>
<li>“Outside its range” means that another assumption of the model fails, or one that this reference shares. A small error there can be a coincidence, where the error changes its sign. Such agreement does not make the model usable.</li>
<li>e<sub>n</sub> is the largest torque divided by μP. The <i>exact</i> torque integrates μ p r over the ellipse; the <i>paper</i> rule takes the circle of the same area and is lower for long contacts.</li>
{}</ul>
)",
      plain(tolerance(report), 100) + " %", of_pads);
}

Html model_cards(const Json& report) {
  const Json& cards = child(report, "models");
  if (!cards.is_array() || cards.empty()) return "";
  Html out = "<h2 id=\"models\">The models</h2>\n<div class=\"cards\">\n";
  for (const Json& card : cards) {
    out += html("<article><h3>{}</h3><p>{}</p><dl>", model_key(report, text(card, "name")),
                text(card, "title"));
    for (const char* key : {"assumptions", "equations", "validity", "cost", "source"})
      if (const std::string value = text(card, key); !value.empty())
        out += html("<dt>{}</dt><dd>{}</dd>", key, with_labels(report, value));
    out += "</dl></article>\n";
  }
  return out + "</div>\n";
}

Html provenance(const Json& report) {
  const Json& source = child(report, "provenance");
  Html rows;
  const auto row = [&](const char* name, const Html& value) {
    if (!value.empty()) rows += html("<dt>{}</dt><dd>{}</dd>", name, value);
  };
  row("version", escape(text(source, "version")));
  row("date", escape(text(source, "date")));
  row("compiler", escape(text(source, "compiler")));
  row("build", escape(text(source, "build_type")));
  row("machine", escape(text(source, "machine")));
  row("cores", escape(text(source, "cores")));
  if (const auto wall = number(source, "wall_s")) row("time", escape(duration(*wall)));
  if (const auto memory = number(source, "peak_memory_MB"))
    row("peak memory", significant(*memory, 3) + " MB (largest FEM process)");
  return provenance_section(rows + atlas_provenance(report), text(source, "command"),
                            "<p>All numbers in full precision are in <code>report.json</code> and "
                            "<code>results.csv</code> beside this page, in SI units.</p>\n");
}

/// Long lists are searched, not read.
Html case_filter(const Json& report) {
  if (child(report, "cases").size() < 4) return "";
  return "<p class=\"filter\" hidden><label>Show cases with <input type=\"search\" data-filter "
         "placeholder=\"e.g. seed, silicone, partly\"></label></p>\n";
}

/// Whether pictures over the error atlas belong to the page: they are of curved contacts, and of no
/// use where they lack a model that the page recommends.
bool shows_atlas(const Json& report, const Json& pads, const Cases& cases, const Advice& advice) {
  return (!cases.empty() || pads.empty()) && atlas_has(report, advice.models());
}

/// Evidence on the models that does not depend on the cases.
Html general_evidence(const Json& report, const Json& pads, const Cases& cases,
                      const Advice& advice) {
  Html out;
  if (shows_atlas(report, pads, cases, advice))
    out += speed_accuracy_section(report) + validity_map_section(report) +
           error_causes_section(report);
  if (!cases.empty() && finite_strain_has(report, advice.models()))
    out += finite_strain_section(report);
  return out + experiments_section(report) + how_to_read(report, pads) + model_cards(report);
}

/// Links to the sections that the page has.
Html contents(const Html& page) {
  constexpr std::array<std::pair<const char*, const char*>, 10> kSections{
      {{"overview", "Overview"},
       {"cases", "Cases"},
       {"simulator", "For a simulator"},
       {"speed", "Speed and accuracy"},
       {"maps", "Validity maps"},
       {"finite-strain", "Large deformation"},
       {"experiments", "Experiments"},
       {"reading", "How to read"},
       {"models", "Models"},
       {"provenance", "Provenance"}}};
  std::vector<Html> links;
  for (const auto& [id, words] : kSections)
    if (page.markup().find(fmt::format("<h2 id=\"{}\"", id)) != std::string::npos)
      links.push_back(html("<a href=\"#{}\">{}</a>", id, words));
  return "<nav>" + joined(links, " ") + "</nav>";
}

/// @param report  of the curved contacts
/// @param pads    the cases with a flat pad, which have sections of their own
Html report_body(const Json& report, const Json& pads, const Cases& cases, const Advice& advice) {
  Json all = {{"cases", child(report, "cases")}};
  all["cases"].insert(all["cases"].end(), pads.begin(), pads.end());
  // An overview of one case would say what its section says.
  const bool is_single = all["cases"].size() == 1;
  Html sections;
  if (!is_single) {
    sections += "<h2 id=\"overview\">Overview</h2>\n" + case_filter(all);
    if (!cases.empty() || pads.empty())
      sections +=
          overview_table(report, cases) + overview_charts() + usability_table(report, cases);
    sections += pads_overview(report, pads) + "<h2 id=\"cases\">Case by case</h2>\n";
  }
  for (std::size_t i = 0; i < cases.size(); ++i)
    sections += case_section(report, child(report, "cases")[i], cases[i], !is_single);
  for (const Json& pad : pads) sections += pad_section(report, pad, !is_single);
  sections += simulator_table(all, is_single);
  const Html evidence = general_evidence(report, pads, cases, advice);
  sections += is_single ? details(
                              "How to read this page, and what is known of the models beyond "
                              "this case",
                              evidence)
                        : evidence;
  sections += provenance(report);
  return "<header><h1>Soft-finger contact: which model holds?</h1>\n"
         "<p class=\"subtitle\">Contact ellipses and frictional torques of fast models, compared "
         "with finite elements</p>\n" +
         (cases.empty() && !pads.empty() ? Html("") : summary(report, cases, advice)) +
         pads_summary(pads) + (is_single ? Html("") : contents(sections)) + "</header>\n" +
         sections;
}

}  // namespace

std::string render_report(const nlohmann::json& report, const Cases& cases) {
  Json curved = report, pads = Json::array();
  if (child(report, "cases").is_array()) {
    curved["cases"] = Json::array();
    for (const Json& one : report["cases"]) (is_pad(one) ? pads : curved["cases"]).push_back(one);
  }
  if (!child(report, "cases").is_array() || curved["cases"].size() != cases.size())
    throw std::invalid_argument(
        "report: no array \"cases\" with an entry for each case; see "
        "comparisons/report/README.md");
  const Advice advice = advice_on(cases, tolerance(report));
  Json data = chart_data(curved, cases);
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (std::size_t j = 0; j < cases[i].loads.size(); ++j)
      data["cases"][i]["loads"][j]["recommended"] = advice.model_at(cases[i].loads[j]);
  if (!shows_atlas(curved, pads, cases, advice)) data["atlas"] = nullptr;
  data["pads"] = pads_chart_data(pads);
  return render_page(
      {"Soft-finger contact: models against finite elements",
       {embedded::report_css},
       report_body(curved, pads, cases, advice),
       std::move(data),
       {embedded::d3_js, embedded::plot_js, embedded::charts_js, embedded::report_js}});
}

}  // namespace softfinger::report
