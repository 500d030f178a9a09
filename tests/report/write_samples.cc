// write_samples FOLDER: renders the sample reports for the browser test, each as the page itself
// and in frames in which report_reader.js uses it.
#include <iostream>
#include <string>
#include <utility>

#include "compared_cases.h"
#include "comparisons/report/calibration_page.h"
#include "comparisons/report/page.h"
#include "comparisons/report/report_page.h"
#include "comparisons/report/select_page.h"
#include "framed_page.h"
#include "sample_report.h"

namespace {

/// A page into which a text has slipped without having been escaped.
std::string injected_page() {
  softfinger::report::Page page;
  page.title = "Injected";
  page.data = softfinger::report::Json::object();
  page.body =
      "<script>document.documentElement.dataset.injected = 'yes';</script>"
      "<img src=\"https://example.org/a.png\" alt=\"\">"
      "<link rel=\"stylesheet\" href=\"https://example.org/a.css\">"
      "<svg onload=\"document.documentElement.dataset.injected = 'yes'\"></svg>";
  page.scripts = {softfinger::report::embedded::d3_js, softfinger::report::embedded::plot_js,
                  softfinger::report::embedded::charts_js};
  const std::string html = render_page(page);
  const std::size_t root = html.find("<html ");
  return html.substr(0, root) +
         "<html data-injected=\"no\" data-overflow=\"false\" "
         "data-charts-expected=\"0\" data-charts-drawn=\"0\" " +
         html.substr(root + 6);
}

}  // namespace

int main(int argc, char** argv) try {
  using namespace softfinger::tests;
  if (argc != 2) {
    std::cerr << "usage: write_samples FOLDER\n";
    return 2;
  }
  const std::string folder = argv[1];
  using namespace softfinger::report;
  for (const auto& [name, page] :
       {std::pair{"sample", softfinger::tests::page_of(sample_report())},
        std::pair{"one_case", softfinger::tests::page_of(one_case_report())},
        std::pair{"pads", softfinger::tests::page_of(sample_pads())},
        std::pair{"large", softfinger::tests::page_of(large_report(20))},
        std::pair{"selection", render_selection(sample_selection())},
        std::pair{"calibration", render_calibration(sample_calibration())},
        std::pair{"injected", injected_page()}})
    write_framed(folder, name, page, "report_reader.js");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "write_samples: " << error.what() << '\n';
  return 1;
}
