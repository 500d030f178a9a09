#include "comparisons/report/explorer_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/pad_contact.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/pads/pad_model.h"

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
/// Numbers of a flat pad; L, W and c are a rectangle's, D is a disc's.
constexpr std::array<Slider, 10> kPadSliders{{
    {"L", "L", "side along x", "mm", 1e-3, 2, 100, 22, true, 0, kAny},
    {"W", "W", "side along y", "mm", 1e-3, 2, 100, 37.5, true, 0, kAny},
    {"c", "c", "radius of the corners", "mm", 1e-3, 0, 20, 0, false, 0, kAny},
    {"D", "D", "diameter", "mm", 1e-3, 2, 100, 30, true, 0, kAny},
    {"h", "h", "thickness", "mm", 1e-3, 0.1, 50, 3, true, 0, kAny},
    {"E", "E", "Young’s modulus", "kPa", 1e3, 1, 10000, 800, true, 0, kAny},
    {"nu", "ν", "Poisson’s ratio", "", 1, 0, 0.5, 0.49, false, 0, 0.5},
    {"P", "P", "load", "N", 1, 0.01, 1000, 20, true, 0, kAny},
    {"mu", "μ", "friction coefficient", "", 1, 0.05, 3, 0.9, true, 0, kAny},
    {"within", "", "torque usable within", "%", 1e-2, 1, 50, 10, true, 0, 1000},
}};

/// @param prefix  of the elements' ids
Html slider_row(const Slider& slider, const char* prefix, const char* of_shape = "") {
  return html(
      "<div class=\"slider\"{5}><label for=\"{6}{0}\"><b>{1}</b> {2}</label><span "
      "class=\"typed\"><input type=\"number\" id=\"{6}{0}_typed\" step=\"any\" "
      "aria-label=\"{2}{3}{4}\"> <span class=\"unit\">{4}</span></span><input type=\"range\" "
      "id=\"{6}{0}\" min=\"0\" max=\"1000\" step=\"1\"></div>\n",
      slider.key, slider.symbol, slider.words, *slider.unit ? ", " : "", slider.unit,
      *of_shape ? html(" data-of-shape=\"{}\"", of_shape) : Html(), prefix);
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
                 column_heading("area", "mm²") + column_heading("indentation", "mm") +
                 column_heading("peak pressure", "kPa") + column_heading("time here"),
             model_rows()) +
         "<ul id=\"reasons\"></ul>\n<p>Pressed with this friction, by the models that know it; the "
         "largest torque is that of pressing without.</p>\n";
}

/// @param part  "", or "pad-": of the ids and of the attributes by which the script finds them
Html simulator_cards(const char* part) {
  Html out;
  for (const exporting::Simulator& simulator : exporting::all_simulators()) {
    Html traps;
    if (*part)
      traps += html("<li>{}</li>", exporting::pad_points_trap(simulator.friction_is_pyramid));
    for (const std::string_view trap : simulator.traps) traps += html("<li>{}</li>", trap);
    out += html(
        "<article><h3 id=\"{4}to_{0}\">{1}</h3>\n<p class=\"facts\">{2}</p>\n<pre tabindex=\"0\" "
        "aria-labelledby=\"{4}to_{0}\" "
        "data-{4}simulator=\"{0}\"></pre>\n<p class=\"buttons\"><button type=\"button\" "
        "data-{4}copy=\"{0}\">Copy for {1}</button></p>{3}</article>\n",
        simulator.name, simulator.title, simulator.law,
        details("What changes the result", "<ul>" + traps + "</ul>"), part);
  }
  return out;
}

template <class Model>
Html model_cards(const std::vector<const Model*>& models) {
  Html out;
  std::vector<std::string> names;
  for (const Model* model : models) names.emplace_back(model->card().name);
  for (const Model* model : models) {
    const ModelCard& card = model->card();
    out += html("<dt>{}: {}</dt><dd>{} {}</dd>\n", label(std::string(card.name)), card.title,
                with_labels_of(names, std::string(card.assumptions)),
                with_labels_of(names, std::string(card.validity)));
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

Html whose_curvature(const ExplorerStart* start) {
  if (!start)
    return "Only the radii of the gap are known here: the layer counts as flat, all curvature as "
           "the object's. <code>softfinger explore CASE</code> starts from a case, where finger "
           "and object each have their own.";
  return html(
      "Finger and object share the curvature of the gap as in the case <code>{}</code>, also when "
      "the relative radii are moved.",
      start->case_name);
}

/// Radio buttons in a row; the first one is chosen until the script says otherwise.
Html radios(const char* name, const char* title,
            const std::vector<std::pair<const char*, Html>>& options) {
  Html out;
  for (const auto& [value, words] : options)
    out += html("<label><input type=\"radio\" name=\"{}\" value=\"{}\"{}> {}</label>\n", name,
                value, out.empty() ? Html(" checked") : Html(), words);
  return html("<fieldset class=\"radios\"><legend>{}</legend>{}</fieldset>\n", title, out);
}

Html pad_table() {
  Html rows;
  int place = 0;
  for (const PadModel* model : all_pad_models()) {
    const std::string name(model->card().name);
    rows += html(
        "<tr data-pad-model=\"{}\"><th scope=\"row\"><label><input type=\"radio\" "
        "name=\"pad_shown\" value=\"{}\"> <span class=\"swatch\" "
        "style=\"background:{}\"></span>{}</label></th><td class=\"words\"><span class=\"badge\" "
        "data-key=\"verdict\"></span></td>",
        name, place, style_of_place(std::size_t(place)).colour, label(name));
    for (const char* key : {"torque_bound", "pressed_bound", "torque", "arm", "pressed",
                            "indentation", "stiffness", "peak"})
      rows += html("<td data-key=\"{}\"></td>", key);
    rows += "</tr>\n";
    ++place;
  }
  return scrolling_table(
             "<th scope=\"col\">the model drawn</th><th scope=\"col\" "
             "class=\"words\">usable</th>" +
                 column_heading("torque within", "") + column_heading("indentation within", "") +
                 column_heading("largest torque", "mN·m") + column_heading("torque / μP", "mm") +
                 column_heading("arm as pressed", "mm") + column_heading("indentation", "mm") +
                 column_heading("stiffness", "N/mm") + column_heading("peak pressure", "kPa"),
             rows) +
         "<p id=\"pad_reasons\" class=\"facts\"></p>\n";
}

std::filesystem::path explorer_folder() { return system::share_folder() / "explorer"; }

/// Files made apart from the program: the page's script, the 32 bytes of its SHA-256, and the
/// licences of what is compiled into it.
struct ExplorerFiles {
  std::string script, sha256, licences;
};

ExplorerFiles read_explorer_files() {
  const std::filesystem::path script = explorer_folder() / "explorer.js";
  ExplorerFiles files;
  files.script = system::read_text_file(script);
  const std::string digits = system::read_text_file(script.string() + ".sha256");
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    files.sha256 += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  files.licences = system::read_text_file(explorer_folder() / "licences.txt");
  return files;
}

/// The part of the page for flat pads.
/// @param outline_of_case  the case's name where its outline is one of the shapes to choose
Html pad_body(const std::string& outline_of_case) {
  std::vector<std::pair<const char*, Html>> shapes{{"rectangle", "rectangle"}, {"disc", "disc"}};
  if (!outline_of_case.empty()) shapes.emplace_back("case", html("of {}", outline_of_case));
  Html form = radios("pad_shape", "Contact", shapes);
  for (const Slider& slider : kPadSliders) {
    const std::string_view key = slider.key;
    form += slider_row(slider, "pad_",
                       key == "L" || key == "W" || key == "c" ? "rectangle"
                       : key == "D"                           ? "disc"
                                                              : "");
  }
  form += radios("pad_pressing", "While pressed",
                 {{"stuck", "the face sticks"}, {"frictionless", "it slides freely"}});
  return html(
             "<div id=\"pad\" hidden>\n<div class=\"explorer\">\n<form class=\"sliders\" "
             "id=\"pad_form\" aria-label=\"The pad\">\n{}<p class=\"buttons\"><button "
             "type=\"button\" id=\"pad_share\">Copy a link to this</button> <button "
             "type=\"button\" "
             "id=\"pad_reset\">Start again</button></p></form>\n<div class=\"answers\">\n<p "
             "class=\"lead\" id=\"pad_verdict\"></p>\n<div class=\"charts\">\n{}{}</div>\n<div "
             "class=\"facts\"><dl id=\"pad_key_numbers\" "
             "class=\"key_numbers\"></dl></div></div></div>\n",
             form,
             html("<figure data-chart=\"pad_map\"><figcaption><b>Pressure over the pad</b>, to "
                  "scale. Dashed: e<sub>n</sub> around the middle</figcaption><div "
                  "class=\"plot\"></div><p class=\"scale\"><span id=\"pad_least\"></span><span "
                  "class=\"shades\"></span><span id=\"pad_peak\"></span></p></figure>\n"),
             chart("pad_pressure",
                   "<b>Pressure</b> through the middle along x and, dashed, along y")) +
         "<h2 id=\"pad_models\">The models</h2>\n"
         "<p>A layer bonded to a rigid backing, under a flat rigid face. The bounds hold 95 % of "
         "the "
         "errors against linear finite elements of whole pads. The largest torque is that of the "
         "pressure at full slip, which a twist makes frictionless; all else is as pressed.</p>\n" +
         pad_table() + model_cards(all_pad_models()) +
         "<h2 id=\"pad_simulators\">What to type into a simulator</h2>\n<p>For the model drawn: "
         "first a box whose corners' forces have the torque, then, instead of it, one point. Never "
         "both.</p>\n<div class=\"simulators\">\n" +
         simulator_cards("pad-") +
         "</div>\n<h2 id=\"pad_command_line\">The same on the command line</h2>\n<pre "
         "id=\"pad_command\" tabindex=\"0\" aria-labelledby=\"pad_command_line\"></pre>\n</div>\n";
}

Html explorer_body(const std::string& version, const std::string& command,
                   const std::string& licences, const ExplorerStart* start,
                   const std::string& outline_of_case) {
  Html sliders;
  for (const Slider& slider : kSliders) sliders += slider_row(slider, "");
  return html(
             "<header><h1>A soft fingertip, pressed and turned</h1>\n"
             "<p class=\"subtitle\">An elastic layer on a rigid core under a rigid object. Move a "
             "slider or type a number: everything follows.</p>\n"
             "<div class=\"loads\" role=\"group\" aria-label=\"The finger is\"><span>The finger "
             "is</span>"
             "<button type=\"button\" id=\"choose_curved\" aria-pressed=\"true\">curved</button>"
             "<button type=\"button\" id=\"choose_pad\" aria-pressed=\"false\">a flat "
             "pad</button></div></header>\n"
             "<noscript><p>The numbers are computed in the browser: this page needs "
             "JavaScript.</p></noscript>\n"
             "<p id=\"failure\" class=\"doubt\" role=\"alert\" hidden></p>\n"
             "<p class=\"unseen\" id=\"status\" role=\"status\"></p>\n"
             "<div id=\"curved\">\n<div class=\"explorer\">\n<form class=\"sliders\" "
             "aria-label=\"The contact\">\n{}"
             "<p class=\"buttons\"><button type=\"button\" id=\"share\">Copy a link to "
             "this</button> "
             "<button type=\"button\" id=\"reset\">Start again</button></p></form>\n"
             "<div class=\"answers\">\n<p class=\"lead\" id=\"verdict\"></p>\n"
             "<div class=\"charts\">\n{}{}{}<div class=\"facts\"><dl id=\"key_numbers\" "
             "class=\"key_numbers\"></dl>"
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
                   "ellipsoid; shaded: with E twice or half as large, h or μ 10 % off")) +
         "<h2 id=\"models\">The models</h2>\n"
         "<p>The bounds hold 95 % of the errors against finite elements of whole fingers at finite "
         "strain; <i>usable</i> means that those of a, b, area and torque are within the "
         "tolerance. " +
         whose_curvature(start) + "</p>\n" + model_table() + model_cards(explorer::models()) +
         "<h2 id=\"simulators\">What to type into a simulator</h2>\n<p>For the model drawn, exact "
         "at "
         "this load. <code>softfinger export</code> also states the error over a range of "
         "loads.</p>\n<div class=\"simulators\">\n" +
         simulator_cards("") +
         "</div>\n<h2 id=\"command_line\">The same on the command line</h2>\n<pre id=\"command\" "
         "tabindex=\"0\" aria-labelledby=\"command_line\"></pre>\n</div>\n" +
         pad_body(outline_of_case) +
         provenance_section(
             html("<dt>version</dt><dd>{}</dd><dt>numbers</dt><dd>the program’s own code, compiled "
                  "to "
                  "WebAssembly; they differ by rounding only</dd>",
                  version),
             command,
             html("<details><summary>Licences of the C and C++ libraries in this file</summary>\n"
                  "<pre>{}</pre></details>\n",
                  licences));
}

template <std::size_t count>
Json sliders_json(const std::array<Slider, count>& sliders) {
  Json all = Json::array();
  for (const Slider& slider : sliders)
    all.push_back({{"key", slider.key},
                   {"words", slider.words},
                   {"unit", slider.unit},
                   {"si_per_unit", slider.si_per_unit},
                   {"low", slider.low},
                   {"high", slider.high},
                   {"start", slider.start},
                   {"logarithmic", slider.logarithmic},
                   {"least", slider.least},
                   {"largest", slider.largest}});
  return all;
}

template <class Model>
Json models_json(const std::vector<const Model*>& models) {
  Json all = Json::array();
  for (const Model* model : models) {
    const std::string name(model->card().name);
    all.push_back(
        {{"name", name}, {"label", label(name)}, {"colour", style_of_place(all.size()).colour}});
  }
  return all;
}

/// Sliders, models and the case's own numbers. A contact that is no rectangle or disc in the middle
/// of its frame goes along by its corners.
Json pad_json(const PadStart* start) {
  Json sliders = sliders_json(kPadSliders);
  Json pad = {{"models", models_json(all_pad_models())},
              {"start", {{"shape", "rectangle"}, {"pressing", "stuck"}}},
              {"outline", nullptr},
              {"case", nullptr}};
  if (start) {
    // Metres to millimetres leaves 20.999999999999996, which nobody typed.
    const auto set = [&](std::string_view key, double value) {
      for (Json& slider : sliders)
        if (slider["key"] == key)
          slider["start"] =
              std::stod(fmt::format("{:.12g}", value / slider["si_per_unit"].get<double>()));
    };
    set("h", start->layer.thickness_m);
    set("E", start->layer.youngs_modulus_Pa);
    set("nu", start->layer.poisson_ratio);
    set("P", start->load.normal_force_N);
    set("mu", start->load.friction_coefficient);
    const input::PadPair& pair = start->pair;
    const double inset_m = pair.finger.edge_radius_m;
    const auto* rectangle = std::get_if<input::RectangleFigure>(&pair.finger.figure);
    const auto* disc = std::get_if<input::DiscFigure>(&pair.finger.figure);
    const bool is_whole = pair.covered == 1;
    pad["case"] = start->case_name;
    pad["start"]["pressing"] = pair.pressing == PadPressing::stuck ? "stuck" : "frictionless";
    if (rectangle && is_whole) {
      set("L", rectangle->length_m - 2 * inset_m);
      set("W", rectangle->width_m - 2 * inset_m);
      set("c", std::max(0., rectangle->corner_radius_m - inset_m));
    } else if (disc && is_whole) {
      set("D", disc->diameter_m - 2 * inset_m);
      pad["start"]["shape"] = "disc";
    } else {
      Json corners = Json::array();
      for (const Eigen::Vector2d& corner : pair.contact.vertices_m())
        corners.push_back({corner.x(), corner.y()});
      pad["outline"] = {{"corners_m", corners},
                        {"is_covered", pair.covered >= prediction::kCovered}};
      pad["start"]["shape"] = "case";
    }
  }
  pad["sliders"] = sliders;
  return pad;
}

}  // namespace

std::string how_to_build_explorer() {
  return fmt::format(
      "cmake --build build/release --target softfinger_explorer, with a compiler for WebAssembly "
      "(Debian: {})",
      kExplorerPackages);
}

bool has_explorer() {
  std::error_code error;
  return std::filesystem::is_regular_file(explorer_folder() / "explorer.js", error);
}

std::string explorer_page(const std::string& version, const std::string& command,
                          const std::variant<std::monostate, ExplorerStart, PadStart>& start) {
  const ExplorerFiles files = read_explorer_files();
  const auto* curved = std::get_if<ExplorerStart>(&start);
  const auto* flat = std::get_if<PadStart>(&start);
  Json sliders = sliders_json(kSliders), shape = Json::array({0, 0, 0, 0});
  if (curved) {
    const auto numbers = numbers_of(curved->problem);
    for (std::size_t i = 0; i < numbers.size(); ++i) sliders[i]["start"] = numbers[i];
    shape = shape_of(curved->problem);
  }
  const Json pad = pad_json(flat);
  Page page{"A soft fingertip, pressed and turned",
            {embedded::report_css, embedded::explorer_css},
            explorer_body(version, command, files.licences, curved,
                          pad["outline"].is_null() ? "" : flat->case_name),
            {{"sliders", sliders},
             {"models", models_json(explorer::models())},
             {"shape", shape},
             {"case", curved ? Json(curved->case_name) : Json()},
             {"first", flat ? "pad" : "curved"},
             {"pad", pad}},
            {embedded::Script{files.script, files.sha256}}};
  page.runs_wasm = true;
  return render_page(page);
}

}  // namespace softfinger::report
