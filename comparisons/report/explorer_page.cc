#include "comparisons/report/explorer_page.h"

#include <array>
#include <cmath>

#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

/// One number of the contact. The order of the first seven is that of `question` in
/// explorer/web/entry.cc.
struct Slider {
  const char *key, *symbol, *words, *unit;
  double si_per_unit;  ///< times the number on the page
  double low, high;    ///< of the slider; more may be typed
  double start;
  bool logarithmic;
  double least, largest;  ///< that may be typed; `least` itself only where it is zero and linear
};

constexpr double kAny = 1e12;
constexpr std::array<Slider, 8> kSliders{{
    {"R1", "R′", "larger relative radius", "mm", 1e-3, 1, 1000, 20, true, 0, kAny},
    {"R2", "R″", "smaller relative radius", "mm", 1e-3, 1, 1000, 12, true, 0, kAny},
    {"h", "h", "thickness", "mm", 1e-3, 0.1, 50, 2, true, 0, kAny},
    {"E", "E", "Young’s modulus", "kPa", 1e3, 1, 10000, 300, true, 0, kAny},
    {"nu", "ν", "Poisson’s ratio", "", 1, 0, 0.5, 0.49, false, 0, 0.5},
    {"P", "P", "load", "N", 1, 0.01, 1000, 2, true, 0, kAny},
    {"mu", "μ", "friction coefficient", "", 1, 0.05, 3, 0.8, true, 0, kAny},
    {"within", "", "usable within", "%", 1e-2, 1, 50, 10, true, 0, 1000},
}};

Html slider_row(const Slider& slider) {
  return html(
      "<div class=\"slider\"><label for=\"{0}\"><b>{1}</b> {2}</label><span class=\"typed\"><input "
      "type=\"number\" id=\"{0}_typed\" step=\"any\" aria-label=\"{2}{3}{4}\"> <span "
      "class=\"unit\">{4}</span></span><input type=\"range\" id=\"{0}\" min=\"0\" max=\"1000\" "
      "step=\"1\"></div>\n",
      slider.key, slider.symbol, slider.words, *slider.unit ? ", " : "", slider.unit);
}

Html chart(const char* name, const Html& caption) {
  return html(
      "<figure data-chart=\"{}\"><figcaption>{}</figcaption><div class=\"plot\"></div>"
      "</figure>\n",
      name, caption);
}

Html model_rows() {
  Html rows =
      "<tr><th scope=\"row\"><label><input type=\"radio\" name=\"shown\" value=\"-1\" checked> "
      "the recommended one</label></th><td colspan=\"11\"></td></tr>\n";
  int place = 0;
  for (const PressureModel* model : explorer::models()) {
    const std::string name(model->card().name);
    rows += html(
        "<tr data-model=\"{}\"><th scope=\"row\"><label><input type=\"radio\" name=\"shown\" "
        "value=\"{}\"> <span class=\"swatch\" style=\"background:{}\"></span>{}</label></th>"
        "<td class=\"words\"><span class=\"badge\" data-key=\"verdict\"></span></td>",
        name, place, style_of_place(std::size_t(place)).colour, label(name));
    for (const char* key : {"contact_bound", "torque_bound", "torque", "arm", "a", "b", "area",
                            "indentation", "peak", "time"})
      rows += html("<td data-key=\"{}\"></td>", key);
    rows += "</tr>\n";
    ++place;
  }
  return rows;
}

Html model_table() {
  return scrolling_table(
             "<th scope=\"col\">the model drawn</th><th scope=\"col\" "
             "class=\"words\">usable</th>" +
                 column_heading("contact within", "") + column_heading("torque within", "") +
                 column_heading("largest torque", "mN·m") + column_heading("torque / μP", "mm") +
                 column_heading("a", "mm") + column_heading("b", "mm") +
                 column_heading("area", "mm²") + column_heading("approach", "mm") +
                 column_heading("peak pressure", "kPa") + column_heading("time here"),
             model_rows()) +
         "<ul id=\"reasons\"></ul>\n";
}

Html simulator_cards() {
  Html out;
  for (const exporting::Simulator& simulator : exporting::all_simulators()) {
    Html traps;
    for (const std::string_view trap : simulator.traps) traps += html("<li>{}</li>", trap);
    out += html(
        "<article><h3 id=\"to_{0}\">{1}</h3>\n<p class=\"facts\">{2}</p>\n<pre tabindex=\"0\" "
        "aria-labelledby=\"to_{0}\" "
        "data-simulator=\"{0}\"></pre>\n<p class=\"buttons\"><button type=\"button\" "
        "data-copy=\"{0}\">Copy for {1}</button></p>{3}</article>\n",
        simulator.name, simulator.title, simulator.law,
        details("What changes the result", "<ul>" + traps + "</ul>"));
  }
  return out;
}

Html model_cards() {
  Html out;
  for (const PressureModel* model : explorer::models()) {
    const ModelCard& card = model->card();
    out += html("<dt>{}: {}</dt><dd>{} {}</dd>\n", label(std::string(card.name)), card.title,
                card.assumptions, card.validity);
  }
  return details("What each model assumes", "<dl>" + out + "</dl>");
}

/// The parts of the relative curvature that the finger has along x and y and its twist, and 1 for
/// an object that is an exact sphere: what `question` in explorer/web/entry.cc takes after the
/// sliders.
std::array<double, 4> shape_of(const ContactProblem& problem) {
  const RelativeRadii& gap = problem.radii;
  const SurfaceCurvature& finger = problem.finger_curvature;
  return {finger.xx_per_m * gap.major_m, finger.yy_per_m * gap.minor_m,
          finger.xy_per_m * std::sqrt(gap.major_m) * std::sqrt(gap.minor_m),
          problem.is_object_spherical ? 1. : 0.};
}

/// Values in the sliders' order and units; the tolerance is the page's own.
std::array<double, 7> numbers_of(const ContactProblem& problem) {
  const std::array<double, 7> si = {problem.radii.major_m,
                                    problem.radii.minor_m,
                                    problem.layer.thickness_m,
                                    problem.layer.youngs_modulus_Pa,
                                    problem.layer.poisson_ratio,
                                    problem.load.normal_force_N,
                                    problem.load.friction_coefficient};
  std::array<double, 7> numbers;
  for (std::size_t i = 0; i < si.size(); ++i) numbers[i] = si[i] / kSliders[i].si_per_unit;
  return numbers;
}

Html whose_curvature(const std::optional<ExplorerStart>& start) {
  if (!start)
    return "Only the radii of the gap are known here: the layer counts as flat, all curvature as "
           "the object's. <code>softfinger explore CASE</code> starts from a case, where finger "
           "and object each have their own.";
  return html(
      "Finger and object share the curvature of the gap as in the case <code>{}</code>, also when "
      "the relative radii are moved.",
      start->case_name);
}

Html explorer_body(const std::string& version, const std::string& command,
                   const std::optional<ExplorerStart>& start) {
  Html sliders;
  for (const Slider& slider : kSliders) sliders += slider_row(slider);
  return html(
             "<header><h1>A soft fingertip, pressed and turned</h1>\n"
             "<p class=\"subtitle\">An elastic layer on a rigid core under a rigid object. Move a "
             "slider or type a number: everything follows.</p></header>\n"
             "<noscript><p>The numbers are computed in the browser: this page needs "
             "JavaScript.</p></noscript>\n"
             "<p id=\"failure\" class=\"doubt\" role=\"alert\" hidden></p>\n"
             "<div class=\"explorer\">\n<form class=\"sliders\" aria-label=\"The contact\">\n{}"
             "<p class=\"buttons\"><button type=\"button\" id=\"share\">Copy a link to "
             "this</button> "
             "<button type=\"button\" id=\"reset\">Start again</button></p></form>\n"
             "<div class=\"answers\">\n<p class=\"lead\" id=\"verdict\"></p>\n"
             "<p class=\"unseen\" id=\"status\" role=\"status\"></p>\n"
             "<div class=\"charts\">\n{}{}{}<div class=\"facts\"><dl id=\"key_numbers\"></dl>"
             "<p id=\"limit_facts\"></p></div></div></div></div>\n",
             sliders,
             chart("ellipse",
                   "<b>Contact from above</b>, mm, x along R′: the model drawn is filled, "
                   "thin lines are the others that are usable"),
             chart("pressure",
                   "<b>Pressure</b> from the centre along the long axis and, dashed, "
                   "along the short one"),
             chart("limit",
                   "<b>Limit surface</b>: force and torque that just slide, the force along "
                   "the long axis and, dashed, along the short one; grey: the friction "
                   "ellipsoid")) +
         "<h2 id=\"models\">The models</h2>\n"
         "<p>The bounds hold 95 % of the errors against finite elements of whole fingers at finite "
         "strain; <i>usable</i> means that those of a, b, area and torque are within the "
         "tolerance. " +
         whose_curvature(start) + "</p>\n" + model_table() + model_cards() +
         "<h2 id=\"simulators\">What to type into a simulator</h2>\n<p>For the model drawn, exact "
         "at "
         "this load. <code>softfinger export</code> also states the error over a range of "
         "loads.</p>\n<div class=\"simulators\">\n" +
         simulator_cards() +
         "</div>\n<h2 id=\"command_line\">The same on the command line</h2>\n<pre id=\"command\" "
         "tabindex=\"0\" aria-labelledby=\"command_line\"></pre>\n" +
         provenance_section(
             html("<dt>version</dt><dd>{}</dd><dt>numbers</dt><dd>the program’s own code, compiled "
                  "to "
                  "WebAssembly; they differ by rounding only</dd>",
                  version),
             command,
             html("<details><summary>Licences of the C and C++ libraries in this file</summary>\n"
                  "<pre>{}</pre></details>\n",
                  embedded::wasm_licences));
}

}  // namespace

bool has_explorer() { return !embedded::explorer_js.text.empty(); }

std::string explorer_page(const std::string& version, const std::string& command,
                          const std::optional<ExplorerStart>& start) {
  Json sliders = Json::array(), models = Json::array();
  for (const Slider& slider : kSliders)
    sliders.push_back({{"key", slider.key},
                       {"words", slider.words},
                       {"unit", slider.unit},
                       {"si_per_unit", slider.si_per_unit},
                       {"low", slider.low},
                       {"high", slider.high},
                       {"start", slider.start},
                       {"logarithmic", slider.logarithmic},
                       {"least", slider.least},
                       {"largest", slider.largest}});
  Json shape = Json::array({0, 0, 0, 0});
  if (start) {
    const auto numbers = numbers_of(start->problem);
    for (std::size_t i = 0; i < numbers.size(); ++i) sliders[i]["start"] = numbers[i];
    shape = shape_of(start->problem);
  }
  std::size_t place = 0;
  for (const PressureModel* model : explorer::models()) {
    const std::string name(model->card().name);
    models.push_back(
        {{"name", name}, {"label", label(name)}, {"colour", style_of_place(place++).colour}});
  }
  Page page{"A soft fingertip, pressed and turned",
            {embedded::report_css, embedded::explorer_css},
            explorer_body(version, command, start),
            {{"sliders", sliders},
             {"models", models},
             {"shape", shape},
             {"case", start ? Json(start->case_name) : Json()}},
            {embedded::explorer_js}};
  page.runs_wasm = true;
  return render_page(page);
}

}  // namespace softfinger::report
