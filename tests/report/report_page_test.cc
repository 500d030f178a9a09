#include "comparisons/report/report_page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "compared_cases.h"
#include "comparisons/judgement/scoring.h"
#include "comparisons/report/html.h"
#include "comparisons/report/report_json.h"
#include "comparisons/report/select_page.h"
#include "comparisons/report/style.h"
#include "comparisons/report/sweep_page.h"
#include "page_text.h"
#include "sample_report.h"
#include "sample_sweep.h"

namespace softfinger::report {
namespace {

using Json = nlohmann::json;
using tests::occurrences;
using tests::visible_text;
using tests::without_scripts;

std::vector<double> numbers_in(const std::string& text) {
  static const std::regex kNumber(R"([-+]?\d+(\.\d+)?)");
  std::vector<double> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), kNumber), end; it != end; ++it)
    numbers.push_back(std::stod(it->str()));
  return numbers;
}

/// `relative` is half a unit of the last digit shown, in the worst case of a leading 1.
bool contains(const std::vector<double>& numbers, double value, double relative) {
  for (const double number : numbers)
    if (std::abs(number - value) <= relative * std::abs(value) * (1 + 1e-9)) return true;
  return false;
}

std::string section_of(const std::string& page, const std::string& id) {
  const std::size_t from = page.find("data-case=\"" + id + "\"");
  if (from == std::string::npos) return "";
  return page.substr(from, page.find("</section>", from) - from);
}

/// Every key anywhere in the object.
std::set<std::string> keys_in(const Json& value) {
  std::set<std::string> keys;
  if (value.is_object())
    for (const auto& item : value.items()) keys.insert(item.key());
  for (const Json& inner : value)
    if (inner.is_structured()) keys.merge(keys_in(inner));
  return keys;
}

/// The object in which whatever has this key is null, or gone.
Json damaged(Json value, const std::string& key, bool erase) {
  if (value.is_object() && value.contains(key)) {
    if (erase)
      value.erase(key);
    else
      value[key] = nullptr;
  }
  for (Json& inner : value)
    if (inner.is_structured()) inner = damaged(std::move(inner), key, erase);
  return value;
}

/// The object in which every text is an attempt to become markup.
Json hostile(Json value) {
  const Json flat = value.flatten();
  for (const auto& leaf : flat.items())
    if (leaf.value().is_string())
      value[Json::json_pointer(leaf.key())] =
          "\"'></script></pre><script>alert(1)</script><!--{{js}}";
  return value;
}

TEST(ReportPage, ShowsEveryNumberOfEveryLoadAsText) {
  const Json report = tests::sample_report();
  const std::string page = without_scripts(tests::page_of(report));
  // Four digits are shown of values, two at least of relative errors.
  constexpr double kValue = 0.5e-3, kError = 0.05;
  for (const Json& report_case : report["cases"]) {
    const std::string id = report_case["id"];
    const std::string text = visible_text(section_of(page, id));
    const std::vector<double> numbers = numbers_in(text);
    const auto expect = [&](const Json& block, const char* key, double factor, double relative) {
      const auto value = number(block, key);
      if (!value || *value == 0) return;
      EXPECT_TRUE(contains(numbers, *value * factor, relative))
          << id << ": " << key << " = " << *value * factor;
    };
    const auto expect_answer = [&](const Json& answer) {
      for (const auto& [key, factor] :
           std::vector<std::pair<const char*, double>>{{"a_m", 1e3},
                                                       {"b_m", 1e3},
                                                       {"axis_rad", 180 / 3.14159265358979},
                                                       {"indentation_m", 1e3},
                                                       {"peak_pressure_Pa", 1e-3},
                                                       {"area_projected_m2", 1e6},
                                                       {"max_torque_Nm", 1e3},
                                                       {"max_torque_paper_Nm", 1e3},
                                                       {"eccentricity_m", 1e3}})
        expect(answer, key, factor, kValue);
    };
    for (const Json& load : report_case["loads"]) {
      expect(load, "load_N", 1, kValue);
      for (const Json& model : load["models"]) {
        if (model["has_answer"]) expect_answer(model);
        for (const Json& check : model["validity"]) {
          expect(check, "value", 1, kValue);
          expect(check, "limit", 1, kValue);
          EXPECT_NE(text.find(check["message"].get<std::string>()), std::string::npos);
        }
        if (model["relative_error"].is_object())
          for (const auto& error : model["relative_error"].items())
            expect(model["relative_error"], error.key().c_str(), 100, kError);
      }
      const Json& fem = load["fem"];
      if (fem.is_null()) continue;
      expect_answer(fem);
      for (const auto& error : fem["error"].items())
        expect(fem["error"], error.key().c_str(), 100, kError);
      for (const char* key : {"level", "unknowns", "active_nodes", "iterations"})
        expect(fem, key, 1, kValue);
      expect(fem, "peak_memory_MB", 1, 5e-3);
      expect(fem, "pressure_exponent", 1, 5e-3);
      for (const Json& level : fem["levels"]) {
        expect(level, "unknowns", 1, kValue);
        for (const char* key : {"a_m", "b_m", "indentation_m", "max_torque_Nm"})
          expect(level, key, 1e3, kValue / 10);
      }
      const Json& patch = load["geometry"]["patch"];
      if (patch.is_null()) continue;
      expect(patch, "region_area_m2", 1e6, kValue);
      expect(patch, "predicted_area_m2", 1e6, kValue);
      for (const char* body : {"finger", "object"}) {
        for (const char* key : {"A_per_m", "B_per_m", "C_per_m", "points"})
          expect(patch[body], key, 1, kValue);
        expect(patch[body], "residual_rms_m", 1e6, kValue);
        EXPECT_TRUE(contains(numbers, 1e3 * *element(patch[body]["radii_m"], 0), kValue));
        EXPECT_TRUE(contains(numbers, 1e3 * *element(patch[body]["radii_std_m"], 0), 0.05));
      }
    }
  }
}

TEST(ReportPage, SaysQuestionVerdictAndCaseFileWithoutJavaScript) {
  const Json report = tests::sample_report();
  const std::string page = without_scripts(tests::page_of(report));
  for (const Json& report_case : report["cases"]) {
    const std::string text = visible_text(section_of(page, report_case["id"]));
    for (const char* key : {"question", "verdict", "case_toml", "file"})
      EXPECT_NE(text.find(report_case[key].get<std::string>()), std::string::npos)
          << report_case["id"] << ": " << key;
  }
  // Only the button row waits for the script; no table and no load is hidden from those without.
  const std::regex hidden_table("<(div class=\"load\"|table|details)[^>]* hidden");
  EXPECT_FALSE(std::regex_search(page, hidden_table));
}

TEST(ReportPage, SaysWhyAReferenceIsMissing) {
  const std::string page = without_scripts(tests::page_of(tests::sample_report()));
  const std::string text = visible_text(section_of(page, "nearly_incompressible"));
  EXPECT_NE(text.find("no reference: the active set did not settle"), std::string::npos);
  EXPECT_NE(text.find("R′ flat (∞)"), std::string::npos);
  EXPECT_NE(visible_text(section_of(page, "silicone_pad_2mm")).find("no answer"),
            std::string::npos);
}

TEST(ReportPage, RefersToNothingOutsideItself) {
  for (const Json& report : {tests::sample_report(), Json{{"cases", Json::array()}}}) {
    const std::string page = without_scripts(tests::page_of(report));
    EXPECT_FALSE(std::regex_search(page, std::regex("\\ssrc=|<link|<img|@import|url\\(")));
    const std::regex link("href=\"([^\"]*)\"");
    for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it) {
      const std::string target = (*it)[1];
      ASSERT_EQ(target.front(), '#') << target;
      EXPECT_NE(page.find("id=\"" + target.substr(1) + "\""), std::string::npos) << target;
    }
  }
}

TEST(ReportPage, StaysBelowThreeMegabytesWithTwentyCasesThreeLoadsAndEightModels) {
  EXPECT_LT(tests::page_of(tests::large_report(20)).size(), 3'000'000u);
}

TEST(ReportPage, CarriesTheLicencesOfTheEmbeddedLibraries) {
  const std::string page = without_scripts(tests::page_of({{"cases", Json::array()}}));
  EXPECT_NE(page.find("Mike Bostock"), std::string::npos);
  EXPECT_NE(page.find("@observablehq/plot"), std::string::npos);
}

TEST(ReportPage, HasReadableChartData) {
  const Json data = tests::chart_data_of(tests::page_of(tests::sample_report()));
  EXPECT_EQ(data["cases"].size(), 5u);
  EXPECT_TRUE(data["cases"][4]["loads"][0]["fem"].is_null());
}

struct RenderedPage {
  Json data;
  std::string (*render)(const Json&);
  const char* list;  ///< without which there is no page
};
std::vector<RenderedPage> all_pages() {
  return {{tests::sample_report(), tests::page_of, "cases"},
          {tests::sample_selection(), render_selection, "choices"},
          {tests::sweep_with_fem(), render_sweep, "rows"}};
}

TEST(EveryPage, SurvivesAnyKeyThatIsNullOrMissing) {
  for (const RenderedPage& page : all_pages()) {
    const std::set<std::string> keys = keys_in(page.data);
    ASSERT_GT(keys.size(), 10u);
    for (const std::string& key : keys)
      for (const bool erase : {false, true})
        if (key == page.list)
          EXPECT_THROW(page.render(damaged(page.data, key, erase)), std::invalid_argument);
        else
          EXPECT_NO_THROW(page.render(damaged(page.data, key, erase))) << key;
  }
}

TEST(EveryPage, LetsNoTextBecomeMarkup) {
  for (const RenderedPage& page : all_pages()) {
    const std::string attacked = page.render(hostile(page.data));
    EXPECT_EQ(occurrences(attacked, "<script"),
              occurrences(page.render({{page.list, Json::array()}}), "<script"));
    EXPECT_EQ(occurrences(without_scripts(attacked), "<!--"), 0u);
  }
}

TEST(EveryPage, RefersToNothingOutsideAndShowsOnlyNumbersAndWords) {
  for (const RenderedPage& page : all_pages()) {
    const std::string text = without_scripts(page.render(page.data));
    EXPECT_FALSE(std::regex_search(text, std::regex("\\ssrc=|<link|<img|@import|url\\(")));
    EXPECT_FALSE(std::regex_search(visible_text(text), std::regex("\\b(nan|inf|null)\\b")));
  }
}

TEST(SelectPage, SaysChoiceErrorsCausesAndCommandWithoutJavaScript) {
  const Json selection = tests::sample_selection();
  const std::string page = without_scripts(render_selection(selection));
  const std::string text = tests::in_one_line(visible_text(page));
  for (const char* words :
       {"Which model is enough for my_finger within 5 %?", "depends on the load", "Hertz at 0.5 N",
        "none at 2 N", "The cheapest that meets 5 %.", "no law <given>", "too slow|not accurate",
        "softfinger select <x>", "error_atlas.csv", "select.json"}) {
    const std::string either = words;
    const std::size_t bar = either.find('|');
    EXPECT_TRUE(
        text.find(either.substr(0, bar)) != std::string::npos ||
        (bar != std::string::npos && text.find(either.substr(bar + 1)) != std::string::npos))
        << words;
  }
  const std::vector<double> numbers = numbers_in(text);
  for (const Json& choice : selection["choices"]) {
    for (const Json& candidate : choice["candidates"]) {
      if (!candidate["error_bound"].is_object()) continue;
      for (const Json& error : candidate["error_bound"])
        EXPECT_TRUE(contains(numbers, 100 * error.get<double>(), 0.05)) << error;
    }
    for (const char* key : {"geometry_fit", "ellipse", "pressure", "circle_rule", "max_torque"})
      EXPECT_TRUE(contains(numbers, 100 * choice["causes"]["models"][0][key].get<double>(), 0.05))
          << key;
  }
  // Median, 95 % and worst of every model.
  for (const Json& model : selection["atlas"]["models"])
    for (const char* key : {"median", "p95", "worst"})
      EXPECT_TRUE(contains(numbers, 100 * model["quantiles"]["area"][key].get<double>(), 0.05));
}

TEST(SelectPage, OfASceneSaysWhatIsSavedAndWhatEachPairNeeds) {
  const auto pair = [](const char* name) {
    return Json{{"bodies", {"object", name}},
                {"detail", "six_patches"},
                {"friction", "six_patches"},
                {"model", "bonded_layer"},
                {"utilisation", 0.84},
                {"load_N", 5},
                {"reason", "at its limit the ellipsoid is off by 6 %"},
                {"candidates", Json::array()}};
  };
  const Json selection = {
      {"scene", "lift_<box>"},
      {"tolerance", 0.05},
      {"choices", {pair("left"), pair("right")}},
      {"motion_holds", true},
      {"motion_change",
       {{"position_m", 1e-4}, {"travel_m", 0.04}, {"rotation_rad", 0}, {"turn_rad", 0.1}}},
      {"step_ms_accurate", 0.5},
      {"step_ms_chosen", 0.25},
      {"saving", "a step saves 50 % of its 500 µs"},
      {"outcome", "The outcome changes: it slips, and holds"},
      {"reference", "finite elements"},
      {"motion_change_in_words", "by at most 0.1 mm of 40 mm"},
      {"provenance", {{"command", "softfinger select lift_box --output x"}}}};
  const std::string page = without_scripts(render_scene_selection(selection));
  for (const char* part :
       {"lift_&lt;box&gt;", "2 of 2 pairs need <b>six patches</b>",
        "<b>A step saves 50 % of its 500 µs.</b>", "object – left", "object – right",
        "<td class=\"words\">six_patches</td>", "<td>84.0\u00a0%</td>",
        "At its limit the ellipsoid is off by 6 %.", "softfinger select lift_box --output x",
        "with finite elements. Against that the motion changes by at most 0.1 mm of 40 mm"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_LT(page.find("The outcome changes"), page.find("2 of 2 pairs")) << "it comes first";
}

TEST(ReportPage, ShowsTheAtlasOnlyWhereThereIsOne) {
  Json report = tests::sample_report();
  EXPECT_NE(tests::page_of(report).find("id=\"maps\""), std::string::npos);
  report.erase("atlas");
  EXPECT_EQ(tests::page_of(report).find("id=\"maps\""), std::string::npos);
}

TEST(ReportPage, LeavesOutPicturesThatLackAModelThatIsRecommended) {
  // The atlas of this report lacks the model hertz, that of the other samples has it.
  Json report = tests::one_case_report();
  const std::string page = tests::page_of(report);
  ASSERT_NE(page.find("Use <b>Hertz</b>"), std::string::npos);
  report["atlas"] = tests::sample_report()["atlas"];
  EXPECT_NE(tests::page_of(report).find("id=\"maps\""), std::string::npos);
  for (const char* id : {"id=\"speed\"", "id=\"maps\"", "id=\"causes\""})
    EXPECT_EQ(page.find(id), std::string::npos) << id;
  EXPECT_TRUE(tests::chart_data_of(page)["atlas"].is_null());

  Json selection = tests::sample_selection();
  EXPECT_NE(render_selection(selection).find("id=\"maps\""), std::string::npos);
  selection["atlas"]["models"].erase(selection["atlas"]["models"].begin());
  const std::string choice = render_selection(selection);
  EXPECT_EQ(choice.find("id=\"maps\""), std::string::npos);
  EXPECT_EQ(choice.find("id=\"causes\""), std::string::npos);
  EXPECT_NE(choice.find("id=\"speed\""), std::string::npos) << "the choice is marked there";
}

TEST(ReportPage, SaysTheTorqueWithItsErrorAboveEverythingElse) {
  const Json report = tests::one_case_report();
  const std::string page = without_scripts(tests::page_of(report));
  const std::size_t said = page.find("Largest torque by the finite elements: <b>");
  ASSERT_NE(said, std::string::npos);
  EXPECT_LT(said, page.find("</header>"));
  const Json& load = report["cases"][0]["loads"][0];
  const std::vector<double> numbers = numbers_in(page.substr(said, 200));
  EXPECT_TRUE(contains(numbers, 1e3 * load["fem"]["max_torque_Nm"].get<double>(), 0.5e-3));
  // With several cases the overview has the torque of each load.
  const std::string all = without_scripts(tests::page_of(tests::sample_report()));
  EXPECT_LT(all.find("Largest torque by the finite elements: <b>"), all.find("</header>"));
  EXPECT_NE(all.find("<th scope=\"col\">torque, FEM</th>"), std::string::npos);
}

TEST(ReportPage, OfOneCaseFoldsWhatDoesNotBelongToIt) {
  const std::string page = without_scripts(tests::page_of(tests::one_case_report()));
  EXPECT_EQ(page.find("id=\"overview\""), std::string::npos);
  EXPECT_EQ(page.find("data-chart=\"map\""), std::string::npos) << "its point would stand alone";
  const std::size_t folded = page.find("<details><summary>How to read this page");
  ASSERT_NE(folded, std::string::npos);
  for (const char* id : {"id=\"reading\"", "id=\"models\""}) EXPECT_GT(page.find(id), folded);
  EXPECT_LT(page.find("</details>", page.find("id=\"models\"")), page.find("id=\"provenance\""));
}

TEST(ReportPage, HasOneNameForAModel) {
  const Json report = {{"models", {{{"name", "bonded_layer"}}, {{"name", "hertz"}}}}};
  EXPECT_EQ(with_labels(report, "bonded_layer takes it, hertz; thick_layer and xhertz do not"),
            "Bonded layer takes it, Hertz; thick_layer and xhertz do not");
  EXPECT_EQ(with_labels(report, "--models bonded_layer asks bonded_layer"),
            "--models bonded_layer asks Bonded layer");
}

// 0.10 is the tolerance of the sample; errors are set by hand.
Json one_case(std::vector<std::pair<double, bool>> torque_error_and_soundness) {
  Json loads = Json::array();
  double load_N = 1;
  for (const auto& [error, sound] : torque_error_and_soundness)
    loads.push_back({{"load_N", load_N++},
                     {"geometry", {{"s", 0.1 * load_N}}},
                     {"fem", {{"error", {{"max_torque", 0.001}}}, {"trusted", true}}},
                     {"models",
                      {{{"model", "hertz"},
                        {"has_answer", true},
                        {"sound", sound},
                        {"relative_error",
                         {{"a", 0.005}, {"b", 0.005}, {"area", 0.01}, {"max_torque", error}}}}}}});
  return {{"tolerance", 0.10}, {"cases", {{{"id", "one"}, {"loads", loads}}}}};
}

TEST(ReportPage, TheConstantForAllLoadsHasTheSmallestWorstError) {
  Json loads = Json::array();
  for (const double torque_Nm : {1e-3, 3e-3})
    loads.push_back(
        {{"load_N", 1}, {"fem", {{"max_torque_Nm", torque_Nm}}}, {"models", Json::array()}});
  const Json report = {
      {"cases", {{{"id", "one"}, {"friction_coefficient", 0.5}, {"loads", loads}}}}};
  const std::string text = visible_text(without_scripts(tests::page_of(report)));
  // 2/(1/1 + 1/3) = 1.5, off by 50 % at both ends.
  EXPECT_NE(text.find("0.0015"), std::string::npos);
  EXPECT_NE(text.find("± 50"), std::string::npos) << text.substr(text.find("0.0015"), 80);
  EXPECT_EQ(text.find("± 73"), std::string::npos);
}

TEST(Scoring, CountsAgreementOutsideTheModelsValidityAsAnAccident) {
  const Json report = one_case({{0.02, true}, {-0.05, false}, {0.40, true}});
  const auto all =
      judgement::usability(tests::compared_cases(report), {"hertz"}, tolerance(report));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].compared, 3);
  EXPECT_EQ(all[0].usable, 1);
  EXPECT_EQ(all[0].accidents, 1);
  EXPECT_EQ(all[0].broken_claims, 1);
  EXPECT_EQ(all[0].worst, 0.40);
  EXPECT_EQ(judgement::reference_summary(tests::compared_cases(report), tolerance(report))
                .without_usable_model,
            2);
}

TEST(Scoring, ReadsTheReferencesErrorsAndWhetherItIsTrusted) {
  Json report = one_case({{0.02, true}, {0.02, true}});
  Json& fem = report["cases"][0]["loads"][1]["fem"];
  fem["trusted"] = false;
  fem["error"]["max_torque"] = 0.05;
  const judgement::ReferenceSummary summary =
      judgement::reference_summary(tests::compared_cases(report), tolerance(report));
  EXPECT_EQ(summary.solved, 2);
  EXPECT_EQ(summary.trusted, 1);
  EXPECT_EQ(summary.worst_torque_error, 0.05);
}

TEST(Scoring, ReadsWhatTheReferencesOwnMeshLeavesOpen) {
  Json report = one_case({{0.02, true}, {0.02, true}, {0.02, true}});
  Json& loads = report["cases"][0]["loads"];
  loads[1]["fem"]["geometry_error"] = {
      {"a", 0.05}, {"b", 0.04}, {"area", 0.23}, {"max_torque", 0.1}};
  const auto worst = [&] {
    return judgement::reference_summary(tests::compared_cases(report), tolerance(report))
        .worst_geometry_error;
  };
  EXPECT_EQ(worst(), 0.23);
  loads[2]["fem"]["geometry_error"] = nullptr;
  EXPECT_TRUE(std::isinf(worst())) << "a reading could not be pressed";
}

TEST(Scoring, NamesTheQuantityAndTheLoadOfTheWorstError) {
  const Json report = one_case({{0.02, true}, {-0.05, false}});
  const auto best =
      judgement::best_model(tests::compared_case(report["cases"][0]), tolerance(report));
  ASSERT_TRUE(best);
  EXPECT_EQ(best->model, "hertz");
  EXPECT_EQ(best->score.error, 0.05);
  EXPECT_EQ(best->score.quantity, prediction::Quantity::max_torque);
  EXPECT_EQ(best->score.load_N, 2);
  EXPECT_FALSE(best->sound);
}

TEST(Pads, HaveSectionsOfTheirOwnAndNoStatisticsWithCurvedContacts) {
  const Json pads = tests::sample_pads();
  const std::string alone = tests::page_of(pads);
  EXPECT_NE(section_of(alone, "wide_pad").find("data-chart=\"padmap\""), std::string::npos);
  EXPECT_NE(section_of(alone, "wide_pad").find("<b>2 of 4</b> do"), std::string::npos)
      << "pad_uniform exceeds what it states";
  EXPECT_NE(section_of(alone, "pad_on_rib").find("killed by signal 9"), std::string::npos);
  EXPECT_NE(section_of(alone, "pad_on_rib").find("states no bound here"), std::string::npos);
  EXPECT_NE(alone.find("use <b>Pad layer</b> at 2 of 4 loads: torque within 0.74"),
            std::string::npos);
  EXPECT_EQ(alone.find("data-chart=\"cost\""), std::string::npos) << "no curved contact";
  EXPECT_EQ(alone.find("<22 x 37.5>"), std::string::npos) << "text is escaped";
  // Beside curved contacts all of theirs stays as it was.
  Json both = tests::sample_report();
  const std::string curved = tests::page_of(both);
  for (const Json& pad : pads["cases"]) both["cases"].push_back(pad);
  const std::string page = tests::page_of(both);
  const std::size_t lead = curved.find("<p class=\"lead\">");
  const std::string summary = curved.substr(lead, curved.find("<nav>", lead) - lead);
  EXPECT_NE(page.find(summary), std::string::npos) << summary;
  EXPECT_EQ(occurrences(page, "data-chart=\"padmap\""), 2);
}

TEST(Pads, AreDrawnWithWhateverIsMissing) {
  const Json pads = tests::sample_pads();
  for (const std::string& key : keys_in(pads["cases"][0]))
    for (const bool erase : {false, true}) {
      Json report = pads;
      report["cases"][0] = damaged(report["cases"][0], key, erase);
      if (key == "contact") continue;  // without it the case is a curved one
      EXPECT_NE(tests::page_of(report).find("</html>"), std::string::npos) << key;
    }
}

}  // namespace
}  // namespace softfinger::report
