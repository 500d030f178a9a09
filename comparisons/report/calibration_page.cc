#include "comparisons/report/calibration_page.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

constexpr char kNoBreak[] = "\u00a0";

struct Naming {
  const char* name;
  const char* words;
  const char* unit;
  double factor;  ///< from SI
  bool logarithmic = true;
};
constexpr std::array<Naming, 6> kCalibrated{
    {{"youngs_modulus", "Young’s modulus E", "kPa", 1e-3},
     {"thickness", "thickness h", "mm", 1e3},
     {"poisson_ratio", "Poisson’s ratio ν", "", 1, false},
     {"radius", "radius R", "mm", 1e3},
     {"friction_coefficient", "friction coefficient μ", "", 1},
     {"shear_strength", "shear strength τ₀", "kPa", 1e-3}}};
constexpr std::array<Naming, 6> kMeasured{
    {{"a", "a", "mm", 1e3},
     {"b", "b", "mm", 1e3},
     {"area", "area", "mm²", 1e6},
     {"indentation", "indentation d", "mm", 1e3},
     {"max_torque", "largest torque", "mN·m", 1e3},
     {"tangential_force", "tangential force at slip", "N", 1}}};

template <std::size_t size>
const Naming* naming(const std::array<Naming, size>& known, const std::string& name) {
  for (const Naming& one : known)
    if (one.name == name) return &one;
  return nullptr;
}

Html in_unit(const Html& number, const char* unit) {
  return *unit ? html("{}{}{}", number, kNoBreak, unit) : number;
}

Html interval(const Json& estimate, const Naming& name) {
  const Json& borders = child(estimate, "interval95");
  const Json& open = child(estimate, "interval_open");
  const auto is_open = [&](std::size_t i) {
    return open.is_array() && open.size() > i && open[i].is_boolean() && open[i].get<bool>();
  };
  if (is_open(0) && is_open(1)) return "any value";
  if (is_open(1))
    return in_unit("above " + significant(element(borders, 0), name.factor), name.unit);
  if (is_open(0))
    return in_unit("below " + significant(element(borders, 1), name.factor), name.unit);
  return in_unit(significant(element(borders, 0), name.factor) + " to " +
                     significant(element(borders, 1), name.factor),
                 name.unit);
}

Html lead(const Json& calibration) {
  std::vector<Html> known, open;
  for (const Naming& name : kCalibrated) {
    const Json& estimate = child(child(calibration, "parameters"), name.name);
    if (estimate.is_null()) continue;
    if (flag(estimate, "determined"))
      known.push_back(html("{} is <b>{}</b> ({})", name.words,
                           in_unit(significant(number(estimate, "value"), name.factor), name.unit),
                           interval(estimate, name)));
    else
      open.push_back(html("{} ({})", name.words, interval(estimate, name)));
  }
  Html out = "<p class=\"lead\">";
  if (!known.empty()) out += joined(known, ", ") + ", with 95" + kNoBreak + "% confidence. ";
  if (!open.empty())
    out += (known.empty() ? Html("These data do not determine ") : "Not determined: ") +
           joined(open, ", ") + ". ";
  return out + html("By {}.</p>\n", label(text(calibration, "model")));
}

Html sentence_list(const Json& sentences) {
  Html items;
  for (const Json& sentence : sentences)
    if (sentence.is_string()) items += html("<li>{}</li>\n", sentence.get<std::string>());
  return items.empty() ? items : "<ul>" + items + "</ul>\n";
}

Html parameter_section(const Json& calibration) {
  Html rows;
  for (const Naming& name : kCalibrated) {
    const Json& estimate = child(child(calibration, "parameters"), name.name);
    if (!estimate.is_null()) {
      const bool determined = flag(estimate, "determined");
      rows += html(
          "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td "
          "class=\"words\"><span class=\"badge {}\">{}</span></td></tr>\n",
          name.words, in_unit(significant(number(estimate, "value"), name.factor), name.unit),
          in_unit(significant(number(estimate, "std"), name.factor, 2), name.unit),
          interval(estimate, name), determined ? "good" : "mixed",
          determined ? "determined" : "not determined");
    } else if (const auto value = number(child(calibration, "fixed"), name.name)) {
      rows += html(
          "<tr><th scope=\"row\">{}</th><td>{}</td><td>–</td><td>–</td><td "
          "class=\"words\">taken as known</td></tr>\n",
          name.words, in_unit(significant(value, name.factor), name.unit));
    }
  }
  return "<h2 id=\"parameters\">What was found</h2>\n" +
         scrolling_table(column_heading("parameter") + column_heading("value") +
                             column_heading("standard deviation") +
                             column_heading("95 % interval") +
                             "<th scope=\"col\" class=\"words\"></th>",
                         rows) +
         "<p class=\"facts\">Outside its interval a parameter makes even the best fit of the "
         "others so much worse that chance explains it in 5\u00a0% of all cases (profile "
         "likelihood), "
         "if the model is right. Determined: the interval spans less than a factor of two.</p>\n" +
         sentence_list(child(calibration, "sentences"));
}

Html advice_section(const Json& calibration) {
  const Html open = sentence_list(child(calibration, "cannot_tell"));
  return "<h2 id=\"advice\">What the data cannot tell</h2>\n" +
         (open.empty() ? Html("<p>Every parameter is determined.</p>\n") : open) +
         html("<p>{}</p>\n", text(calibration, "next_sentence"));
}

/// The measured quantities, in the order of the table's columns.
std::vector<const Naming*> measured(const Json& calibration) {
  std::set<std::string> names;
  for (const Json& residual : child(calibration, "residuals"))
    names.insert(text(residual, "quantity"));
  std::vector<const Naming*> result;
  for (const Naming& name : kMeasured)
    if (names.count(name.name)) result.push_back(&name);
  return result;
}

Html pictures_section(const Json& calibration) {
  Html figures;
  for (const Naming* name : measured(calibration))
    figures += html(
        "<figure data-chart=\"fit\" data-quantity=\"{}\"><figcaption><b>{}</b> over the load, both "
        "logarithmic</figcaption><div class=\"plot\"></div></figure>\n",
        name->name, name->words);
  Html out =
      "<h2 id=\"fit\">Data and fit</h2>\n<p class=\"facts\">Dots are measured, with bars of two "
      "standard deviations; crosses are outliers, left out of the fit. The line is the fit, the "
      "band holds the model’s true line with 95\u00a0% at each load; single measurements scatter "
      "in "
      "addition.</p>\n<noscript><p class=\"facts\">The pictures need JavaScript; the numbers "
      "are below.</p></noscript>\n<div class=\"charts\">" +
      figures + "</div>\n";
  out +=
      "<h2 id=\"residuals\">Residuals</h2>\n<div class=\"charts single\"><figure "
      "data-chart=\"residuals\"><figcaption>(measured − fit) / standard deviation. Of a right "
      "model and right errors 95\u00a0% lie between the dashed lines, in no order; a bow says that "
      "the "
      "model is wrong. Crosses are outliers, at the edge where they lie beyond "
      "it.</figcaption><div class=\"plot\"></div></figure></div>\n";
  return out;
}

Html confidence_section(const Json& calibration) {
  const Json& ellipses = child(calibration, "ellipses");
  Html out = "<h2 id=\"confidence\">Confidence</h2>\n";
  if (!ellipses.is_array() || ellipses.empty())
    return out +
           "<p>There is no ellipse to draw: the data do not tell two parameters of the layer, or "
           "only one was looked for.</p>\n";
  Html figures;
  for (std::size_t i = 0; i < ellipses.size(); ++i) {
    const Naming* x = naming(kCalibrated, text(ellipses[i], "x"));
    const Naming* y = naming(kCalibrated, text(ellipses[i], "y"));
    if (!x || !y) continue;
    figures += html(
        "<figure data-chart=\"confidence\" data-ellipse=\"{}\"><figcaption><b>{} and {}</b>. The "
        "ellipse holds both together with 95\u00a0% by their covariance; the dashed box is the two "
        "intervals, which follow the fit farther than a covariance can.</figcaption><div "
        "class=\"plot\"></div></figure>\n",
        i, x->words, y->words);
  }
  return out + "<div class=\"charts\">" + figures + "</div>\n";
}

Html covariance_section(const Json& calibration) {
  const Json& covariance = child(calibration, "covariance");
  if (!covariance.is_object()) return "";
  Html head = column_heading("correlation"), rows;
  for (const Naming& column : kCalibrated)
    if (covariance.contains(column.name)) head += column_heading(column.words);
  for (const Naming& row : kCalibrated) {
    if (!covariance.contains(row.name)) continue;
    rows += html("<tr><th scope=\"row\">{}</th>", row.words);
    for (const Naming& column : kCalibrated) {
      if (!covariance.contains(column.name)) continue;
      const auto entry = [&](const char* one, const char* other) {
        return number(child(covariance, one), other).value_or(NAN);
      };
      const double scale = std::sqrt(entry(row.name, row.name) * entry(column.name, column.name));
      rows += html("<td>{}</td>", significant(entry(row.name, column.name) / scale, 3));
    }
    rows += "</tr>\n";
  }
  return scrolling_table(head, rows);
}

Html comparison_table(const Json& comparisons, const char* key, const char* heading) {
  Html rows;
  const double best = comparisons.empty() ? NAN : number(comparisons[0], "aic").value_or(NAN);
  for (const Json& comparison : comparisons) {
    std::vector<Html> found;
    for (const Naming& name : kCalibrated)
      if (const auto value = number(child(comparison, "parameters"), name.name))
        found.push_back(
            html("{} {}", name.words, in_unit(significant(value, name.factor, 3), name.unit)));
    const std::string name = text(comparison, key);
    const auto held_out = number(comparison, "held_out_error");
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td "
        "class=\"words\">{}</td></tr>\n",
        std::string_view(key) == "model" ? label(name) : name,
        html("+{}", fmt::format("{:.1f}", number(comparison, "aic").value_or(NAN) - best)),
        percent(number(comparison, "scatter").value_or(NAN)),
        held_out ? escape(percent(*held_out)) : Html("–"), joined(found, ", "));
  }
  return scrolling_table(column_heading(heading) + column_heading("AIC above the best") +
                             column_heading("scatter") +
                             column_heading("upper third of the loads, off by") +
                             "<th scope=\"col\" class=\"words\">its parameters</th>",
                         rows);
}

Html models_section(const Json& calibration) {
  const Json& models = child(calibration, "models");
  const Json& laws = child(calibration, "shear_laws");
  Html out =
      "<h2 id=\"models\">Models on the same data</h2>\n<p class=\"facts\">AIC (Akaike’s criterion) "
      "weighs the fit against the number of parameters: a difference of 2 is little, 10 is much. "
      "The last error is that of a prediction: the upper third of the loads by a fit to the "
      "others.</p>\n";
  if (models.is_array() && !models.empty()) out += comparison_table(models, "model", "model");
  if (laws.is_array() && !laws.empty())
    out += "<h4>Shear laws</h4>\n" + comparison_table(laws, "shear_law", "shear law");
  return out;
}

Html numbers_section(const Json& calibration) {
  Html rows;
  for (const Json& residual : child(calibration, "residuals")) {
    const Naming* name = naming(kMeasured, text(residual, "quantity"));
    if (!name) continue;
    rows += html(
        "<tr><th scope=\"row\">{}</th><td "
        "class=\"words\">{}</td><td>{}</td><td>{}{}</td><td>{}</td>"
        "<td>{}</td><td class=\"words\">{}</td><td>{}</td></tr>\n",
        newton(number(residual, "load_N").value_or(NAN)), name->words,
        in_unit(significant(number(residual, "measured"), name->factor), name->unit),
        in_unit(significant(number(residual, "std"), name->factor, 2), name->unit),
        flag(residual, "std_given") ? Html("") : "<small>from the scatter</small>",
        in_unit(significant(number(residual, "predicted"), name->factor), name->unit),
        significant(number(residual, "sigma"), 1, 2),
        flag(residual, "outlier") ? Html("<span class=\"badge bad\">left out</span>") : "",
        text(residual, "line"));
  }
  return "<h2 id=\"numbers\">Every number</h2>\n" +
         scrolling_table(
             column_heading("load") + "<th scope=\"col\" class=\"words\">quantity</th>" +
                 column_heading("measured") + column_heading("standard deviation") +
                 column_heading("fit") + column_heading("residual, σ") +
                 "<th scope=\"col\" class=\"words\"></th>" + column_heading("line of the file"),
             rows);
}

/// Data that calibration.js draws, in the page's units.
Json chart_data_of(const Json& calibration) {
  Json quantities = Json::array();
  int place = 0;
  for (const Naming* name : measured(calibration)) {
    const auto scaled = [&](const Json& value) {
      return value.is_number() ? Json(value.get<double>() * name->factor) : Json();
    };
    Json points = Json::array(), curve = Json::array();
    for (const Json& residual : child(calibration, "residuals"))
      if (text(residual, "quantity") == name->name)
        points.push_back({{"load", child(residual, "load_N")},
                          {"measured", scaled(child(residual, "measured"))},
                          {"std", scaled(child(residual, "std"))},
                          {"predicted", scaled(child(residual, "predicted"))},
                          {"sigma", child(residual, "sigma")},
                          {"outlier", flag(residual, "outlier")}});
    for (const Json& drawn : child(calibration, "curves")) {
      if (text(drawn, "quantity") != name->name) continue;
      const Json& loads = child(drawn, "load_N");
      const auto at = [&](const char* key, std::size_t i) -> Json {
        const auto value = element(child(drawn, key), i);
        return value ? Json(*value * name->factor) : Json();
      };
      for (std::size_t i = 0; i < loads.size(); ++i)
        curve.push_back({{"load", loads[i]},
                         {"value", at("value", i)},
                         {"low", at("low", i)},
                         {"high", at("high", i)}});
    }
    quantities.push_back({{"name", name->name},
                          {"label", name->words},
                          {"unit", name->unit},
                          {"colour", style_of_place(std::size_t(place++)).colour},
                          {"points", points},
                          {"curve", curve}});
  }
  Json ellipses = Json::array();
  for (const Json& ellipse : child(calibration, "ellipses")) {
    const Naming* x = naming(kCalibrated, text(ellipse, "x"));
    const Naming* y = naming(kCalibrated, text(ellipse, "y"));
    if (!x || !y) {
      ellipses.push_back(nullptr);
      continue;
    }
    Json points = Json::array();
    for (const Json& point : child(ellipse, "points"))
      if (const auto px = element(point, 0), py = element(point, 1); px && py)
        points.push_back({*px * x->factor, *py * y->factor});
    const auto axis = [&](const Naming& name) -> Json {
      const Json& estimate = child(child(calibration, "parameters"), name.name);
      const Json& borders = child(estimate, "interval95");
      const auto low = element(borders, 0), high = element(borders, 1);
      return {{"label", *name.unit ? fmt::format("{}, {}", name.words, name.unit) : name.words},
              {"logarithmic", name.logarithmic},
              {"value", number(estimate, "value").value_or(NAN) * name.factor},
              {"low", low ? Json(*low * name.factor) : Json()},
              {"high", high ? Json(*high * name.factor) : Json()}};
    };
    ellipses.push_back({{"x", axis(*x)}, {"y", axis(*y)}, {"points", points}});
  }
  return {{"quantities", quantities}, {"ellipses", ellipses}, {"styles", Json::object()}};
}

Html body_of(const Json& calibration) {
  const std::string question = text(calibration, "question");
  Html facts;
  for (const char* key : {"version", "date"})
    if (const std::string value = text(child(calibration, "provenance"), key); !value.empty())
      facts += html("<dt>{}</dt><dd>{}</dd>", key, value);
  return html("<header><h1>What the measurements say about {}</h1>\n<p class=\"subtitle\">{}</p>\n",
              text(calibration, "case"),
              with_labels_of({text(calibration, "model")}, text(calibration, "description"))) +
         lead(calibration) +
         "<nav><a href=\"#parameters\">Found</a> <a href=\"#advice\">Not told</a> <a "
         "href=\"#fit\">Fit</a> <a href=\"#residuals\">Residuals</a> <a "
         "href=\"#confidence\">Confidence</a> <a href=\"#models\">Models</a> <a "
         "href=\"#numbers\">Numbers</a> <a href=\"#provenance\">Provenance</a></nav></header>\n" +
         parameter_section(calibration) + advice_section(calibration) +
         pictures_section(calibration) + confidence_section(calibration) +
         covariance_section(calibration) + models_section(calibration) +
         numbers_section(calibration) +
         html("<details><summary>The file <code>{}</code></summary>\n<pre>{}</pre></details>\n",
              text(calibration, "data"), text(calibration, "data_csv")) +
         provenance_section(facts, text(child(calibration, "provenance"), "command"),
                            "<p>The numbers in full precision and SI units: the same command with "
                            "<code>--json</code>.</p>\n");
}

}  // namespace

std::string render_calibration(const nlohmann::json& calibration) {
  if (!child(calibration, "parameters").is_object())
    throw std::invalid_argument(
        "calibration: no object \"parameters\"; see comparisons/report/README.md");
  return render_page(
      {html("{}: calibration", text(calibration, "case")),
       {embedded::report_css},
       body_of(calibration),
       chart_data_of(calibration),
       {embedded::d3_js, embedded::plot_js, embedded::charts_js, embedded::calibration_js}});
}

}  // namespace softfinger::report
