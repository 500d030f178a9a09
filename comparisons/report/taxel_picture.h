#pragma once

#include <string>

#include "comparisons/prediction/taxel_answer.h"

namespace softfinger::report {

/// The pressure that an array reads, as the bytes of a PNG file: a square per taxel, x to the right
/// and y upwards, from white (none) to dark red (the largest of the array), with the edge of the
/// contact's own ellipse. About 800 pixels wide or high.
std::string taxel_picture(const prediction::TaxelAnswer& answer);

}  // namespace softfinger::report
