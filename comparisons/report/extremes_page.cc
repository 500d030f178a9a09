#include "comparisons/report/extremes_page.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "comparisons/report/atlas_sections.h"
#include "comparisons/report/embedded.h"
#include "comparisons/report/page.h"
#include "comparisons/report/style.h"

namespace softfinger::report {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 5> kPromises{
    {{"not_finite_or_positive", "finite, positive, refusals with a reason"},
     {"shrinks_under_load", "larger under more load"},
     {"depends_on_units", "the same in all units"},
     {"friction_limit", "a finite friction limit"},
     {"jumps", "no jumps"}}};

std::string share(const Json& model, const char* key) {
  const auto part = number(model, key), all = number(model, "tried");
  if (!part || !all || *all <= 0) return "–";
  return fmt::format("{:.1f}\u00a0%", 100 * *part / *all);
}

int times_broken(const Json& model, const std::string& promise) {
  for (const Json& broken : child(model, "broken_promises"))
    if (text(broken, "promise") == promise) return int(number(broken, "count").value_or(1));
  return 0;
}

Html extremes_lead(const Json& survey) {
  int models = 0, keeping = 0;
  double asked = 0;
  for (const Json& model : child(survey, "models")) {
    ++models;
    if (child(model, "broken_promises").empty()) ++keeping;
    asked += number(model, "tried").value_or(0) + number(model, "nonsense_tried").value_or(0);
  }
  return html(
      "<p class=\"lead\"><span class=\"badge {}\">{}</span> {:.0f} problems far beyond any "
      "fingertip: {} of {} models violated no invariant. {}</p>\n",
      keeping == models ? "good" : "bad", keeping == models ? "✓ all hold" : "✕ violated", asked,
      keeping, models,
      keeping == models
          ? "No NaN, no infinity, no negative number, no answer that depends on the units, none "
            "that shrinks under load, no jump. What a model cannot answer, it refuses with a "
            "reason."
          : "The table below shows which invariant was violated, and by which problem.");
}

Html results_table(const Json& survey) {
  Html rows;
  for (const Json& model : child(survey, "models")) {
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{} of {}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        label(text(model, "model")), plain(number(model, "tried")), share(model, "valid"),
        share(model, "answered_outside_validity"), share(model, "refused"),
        plain(number(model, "nonsense_refused")), plain(number(model, "nonsense_tried")),
        significant(number(model, "units_worst_deviation"), 1, 2),
        child(model, "largest_jump").is_null() ? "–"
                                               : significant(number(model, "largest_jump"), 1, 2),
        duration(1e-9 * number(model, "slowest_call_ns").value_or(NAN)));
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">model</th>"
         "<th scope=\"col\">problems</th><th scope=\"col\">valid</th><th "
         "scope=\"col\">outside validity</th><th scope=\"col\">refused</th><th "
         "scope=\"col\"><a href=\"#ranges\">nonsense</a> refused</th><th scope=\"col\">units "
         "change</th><th "
         "scope=\"col\">largest jump</th><th scope=\"col\">slowest "
         "call</th></tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

Html promises_table(const Json& survey) {
  Html head = "<th scope=\"col\">model</th>", rows, details;
  for (const auto& promise : kPromises)
    head += html("<th scope=\"col\" class=\"words\">{}</th>", promise.second);
  for (const Json& model : child(survey, "models")) {
    const Html name = escape(label(text(model, "model")));
    rows += "<tr><th scope=\"row\">" + name + "</th>";
    for (const auto& promise : kPromises) {
      const int times = times_broken(model, promise.first);
      const bool tried =
          std::string_view(promise.first) != "jumps" || !child(model, "largest_jump").is_null();
      rows += times > 0 ? html(
                              "<td class=\"words\"><span class=\"badge bad\">✕ violated {} "
                              "times</span></td>",
                              times)
              : tried ? Html("<td class=\"words\"><span class=\"badge good\">✓ holds</span></td>")
                      : "<td class=\"words\"><span class=\"badge failed\">not tested</span></td>";
    }
    rows += "</tr>\n";
    for (const Json& broken : child(model, "broken_promises"))
      details += html("<li>{}, {}: first at <code>{}</code></li>\n", name, text(broken, "promise"),
                      text(broken, "first"));
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>" + head +
         "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n" +
         (details.empty() ? "" : "<ul>" + details + "</ul>\n");
}

Html ranges_table(const Json& survey) {
  // All fast models are asked the same; the slow ones less far.
  Html head = "<th scope=\"col\">quantity</th>", rows;
  std::vector<const Json*> shown;
  for (const bool fast : {true, false})
    for (const Json& model : child(survey, "models"))
      if (flag(model, "hot_path") == fast) {
        shown.push_back(&model);
        head += fast ? Html("<th scope=\"col\">fast models</th>")
                     : "<th scope=\"col\">slow models</th>";
        break;
      }
  for (const Json& axis : child(survey, "axes")) {
    rows += html("<tr><th scope=\"row\">{}</th>", text(axis, "name"));
    for (const Json* model : shown) {
      const Json& range = child(child(*model, "ranges"), text(axis, "key"));
      rows += html("<td>{} to {}</td>", significant(element(range, 0), 1, 2),
                   significant(element(range, 1), 1, 2));
    }
    rows += "</tr>\n";
  }
  return "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>" + head +
         "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

Html refusals(const Json& survey) {
  Html out;
  for (const Json& model : child(survey, "models")) {
    Html reasons;
    for (const Json& reason : child(model, "refusals"))
      reasons +=
          html("<li>{} times: {}</li>\n", plain(number(reason, "count")), text(reason, "reason"));
    out += html("<h4>{}</h4>\n", label(text(model, "model"))) +
           (reasons.empty() ? "<p class=\"facts\">refused none</p>\n"
                            : "<ul class=\"warnings\">" + reasons + "</ul>\n");
  }
  return out;
}

/// The numbers of the picture, for those without scripts.
Html decades_tables(const Json& survey) {
  Html out;
  for (const Json& axis : child(survey, "axes")) {
    const std::string key = text(axis, "key");
    Html rows;
    for (const Json& model : child(survey, "models"))
      for (const Json& bin : child(child(model, "decades"), key))
        rows += html(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            label(text(model, "model")),
            significant(number(bin, "from"), 1, 2) + " to " + significant(number(bin, "to"), 1, 2),
            plain(number(bin, "valid")), plain(number(bin, "answered")),
            plain(number(bin, "refused")));
    out += html("<details><summary>By {}", text(axis, "name")) +
           ", as numbers</summary>\n<div class=\"scroll\" "
           "tabindex=\"0\"><table><thead><tr><th scope=\"col\">model</th><th "
           "scope=\"col\">from, to</th><th scope=\"col\">valid</th><th scope=\"col\">answered "
           "outside it</th><th scope=\"col\">refused</th></tr></thead>\n<tbody>" +
           rows + "</tbody></table></div></details>\n";
  }
  return out;
}

Html pictures(const Json& survey) {
  std::vector<SettingButton> axes;
  for (const Json& axis : child(survey, "axes"))
    axes.push_back({text(axis, "key"), text(axis, "name")});
  Html figures;
  for (const Json& model : child(survey, "models"))
    figures += html(
        "<figure data-chart=\"decades\" data-model=\"{}\"><figcaption><b>{}</b></figcaption>"
        "<div class=\"plot\"></div></figure>\n",
        text(model, "model"), label(text(model, "model")));
  return setting_buttons("axis", "Over", axes, 0) +
         "<ul class=\"legend\"><li><span class=\"key\"><svg width=\"18\" height=\"12\" "
         "aria-hidden=\"true\"><rect width=\"18\" height=\"12\" "
         "fill=\"var(--map-0)\"/></svg>answered, valid</span></li><li><span class=\"key\"><svg "
         "width=\"18\" height=\"12\" aria-hidden=\"true\"><rect width=\"18\" height=\"12\" "
         "fill=\"var(--map-1)\"/></svg>answered, outside validity"
         "</span></li><li><span class=\"key\"><svg width=\"18\" height=\"12\" "
         "aria-hidden=\"true\"><rect width=\"18\" height=\"12\" "
         "fill=\"var(--model-8)\"/></svg>refused, in words</span></li></ul>\n"
         "<div class=\"charts maps\">\n" +
         figures + "</div>\n";
}

Html extremes_body(const Json& survey) {
  const Json& source = child(survey, "provenance");
  Html rows;
  for (const char* key : {"version", "date"})
    if (const std::string value = text(source, key); !value.empty())
      rows += html("<dt>{}</dt><dd>{}</dd>", key, value);
  rows += html("<dt>seed</dt><dd>{}</dd>", plain(number(survey, "seed")));
  return "<header><h1>How far can the models be pushed?</h1>\n<p class=\"subtitle\">Random "
         "problems over the whole allowed range of input, and beyond it</p>\n" +
         extremes_lead(survey) +
         "<nav><a href=\"#answers\">Answers</a> <a href=\"#promises\">Invariants</a> <a "
         "href=\"#ranges\">What was tried</a> <a href=\"#refusals\">Refusals</a> <a "
         "href=\"#provenance\">Provenance</a></nav></header>\n"
         "<h2 id=\"answers\">What each model answered</h2>\n" +
         results_table(survey) + pictures(survey) + decades_tables(survey) +
         "<h2 id=\"promises\">Invariants</h2>\n" + promises_table(survey) +
         "<h2 id=\"ranges\">What was tried, and how far</h2>\n"
         "<p>Random problems, evenly spread over the decades. The contact size is the radius on a "
         "half-space, (P R/E)<sup>1/3</sup>. R′ = R″ in one problem of six; Poisson’s ratio is a "
         "special value (0, 1/2, next to one of them, 0.3) in one of three; the object is "
         "compliant "
         "in one of five. One problem of sixteen is nonsense: it contains a NaN, an infinity, a "
         "negative number or one that is nearly zero. A model refuses it where that number "
         "enters; where it does not, or where it is small but not impossible, it answers with "
         "finite numbers.</p>\n" +
         ranges_table(survey) + "<h2 id=\"refusals\">Why they refused</h2>\n" + refusals(survey) +
         provenance_section(rows, text(source, "command"),
                            "<p>The same numbers are in <code>extremes.json</code> beside this "
                            "page. The longer runs of the test suite: <code>ctest --preset release "
                            "-L extremes</code>.</p>\n");
}

}  // namespace

std::string render_extremes(const nlohmann::json& survey) {
  if (!child(survey, "models").is_array())
    throw std::invalid_argument("survey: no array \"models\"; see comparisons/report/README.md");
  Json drawn = {
      {"axes", child(survey, "axes")}, {"models", Json::array()}, {"styles", Json::object()}};
  for (const Json& model : child(survey, "models"))
    drawn["models"].push_back(
        {{"model", text(model, "model")}, {"decades", child(model, "decades")}});
  return render_page(
      {"How far can the models be pushed?",
       {embedded::report_css},
       extremes_body(survey),
       drawn,
       {embedded::d3_js, embedded::plot_js, embedded::charts_js, embedded::extremes_js}});
}

}  // namespace softfinger::report
