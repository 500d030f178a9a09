#pragma once

#include <string_view>

/// Files that the build copies into the program (embed.cmake).
namespace softfinger::comparisons::embedded {

extern const std::string_view page_html;
extern const std::string_view report_css;
extern const std::string_view charts_js;  ///< for every page with charts, before its own script
extern const std::string_view report_js;
extern const std::string_view select_js;
extern const std::string_view extremes_js;
extern const std::string_view sweep_js;
extern const std::string_view d3_js;
extern const std::string_view plot_js;
extern const std::string_view licences;  ///< of d3, Plot and all that is bundled in them

extern const std::string_view motion_css;
extern const std::string_view motion_js;  ///< with what it imports of three.js
extern const std::string_view three_licence;

}  // namespace softfinger::comparisons::embedded
