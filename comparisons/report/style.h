#pragma once

#include <string>
#include <vector>

#include "comparisons/judgement/judgement.h"
#include "comparisons/report/html.h"

/// Names and looks of models, the same everywhere on a page.
namespace softfinger::report {

using judgement::label;

/// Names in the order of the registry, then any that only the loads mention.
std::vector<std::string> model_names(const Json& report);

/// The text with the names of the report's models as their labels, so that a page has one name for
/// each; what is to be typed behind --model or --models stays.
std::string with_labels(const Json& report, std::string words);
std::string with_labels_of(const std::vector<std::string>& models, std::string words);

struct Style {
  std::string colour;  ///< CSS
  std::string dash;    ///< SVG stroke-dasharray
};

/// Style of a model among `model_names`, of "fem" or of "fem_coarse". No two models share a colour.
Style style(const Json& report, const std::string& model);

/// Style of the model at this place of the list. It does not depend on the list's length.
Style style_of_place(std::size_t place);

}  // namespace softfinger::report
