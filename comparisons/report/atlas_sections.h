#pragma once

#include "comparisons/report/html.h"

/// The error atlas on a page: `report["atlas"]`, described in README.md of this folder. Every
/// function returns nothing when there is none.
namespace softfinger::report {

/// Whether the atlas has each of these models: a picture of the others would miss the one to use.
bool atlas_has(const Json& report, const std::vector<std::string>& models);
/// Whether the error of each of these models is split into causes there.
bool atlas_has_causes(const Json& report, const std::vector<std::string>& models);
/// Whether the contacts at large deformation have each of these models.
bool finite_strain_has(const Json& report, const std::vector<std::string>& models);

/// Cost against error of every model and finite-element level, and of the friction laws.
Html speed_accuracy_section(const Json& report);

/// Each model's error over s and nu, with the cases' contacts.
Html validity_map_section(const Json& report);

/// The error of the torque by cause.
Html error_causes_section(const Json& report);

/// The errors of every model at large deformation: `report["finite_strain"]`.
Html finite_strain_section(const Json& report);

/// Which runs the atlas is made of, for the page's end: `<dt>..</dt><dd>..</dd>`.
Html atlas_provenance(const Json& report);

/// Data of the charts, beside `styles`; null without an atlas.
Json atlas_chart_data(const Json& report);

/// {"hertz": {"label", "colour", "dash"}, ...}
Json chart_styles(const Json& report);

/// A row of buttons that sets what the atlas's figures show; revealed by the script.
struct SettingButton {
  std::string value, label;
};
Html setting_buttons(const std::string& setting, const std::string& label,
                     const std::vector<SettingButton>& buttons, std::size_t pressed);

}  // namespace softfinger::report
