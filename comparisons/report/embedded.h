#pragma once

#include <string_view>

/// Files that the build copies into the program (embed.cmake).
namespace softfinger::report::embedded {

/// Script of a page, and the SHA-256 of its text, 32 bytes.
struct Script {
  std::string_view text, sha256;
};

extern const std::string_view page_html;
extern const Script page_js;  ///< of every page, before anything else
extern const std::string_view report_css;
extern const Script charts_js;  ///< for every page with charts, before its own script
extern const Script report_js;
extern const Script select_js;
extern const Script calibration_js;
extern const Script sweep_js;
extern const Script d3_js;
extern const Script plot_js;
extern const std::string_view licences;  ///< of d3, Plot and all that is bundled in them

extern const std::string_view motion_css;
extern const Script motion_js;  ///< with what it imports of three.js
extern const std::string_view mesh_css;
extern const Script mesh_js;  ///< likewise
extern const std::string_view three_licence;

extern const std::string_view explorer_css;

}  // namespace softfinger::report::embedded
