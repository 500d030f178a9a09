#pragma once

#include <array>
#include <map>
#include <string>

#include "comparisons/judgement/atlas/error_atlas.h"
#include "softfinger/layer/fingertip_layer_core.h"

/// The fit behind `fingertip_layer` and `error_bound`: how far `bonded_layer` is from fingers at
/// finite strain.
namespace softfinger::judgement {

/// Test of error bounds on runs that nothing was fitted to.
struct BoundTest {
  std::size_t runs = 0;
  QuantityErrors inside{};  ///< share of the errors within their bound
  QuantityErrors ratio{};   ///< median of bound over error
  /// Errors: the median, the value that 95 % of them do not exceed, the largest.
  QuantityErrors median{}, most{}, largest{};
};

struct FittedFingertip {
  FingertipLayerTable table;
  std::size_t runs = 0;
};

/// Weighted least squares over the runs at finite strain. Widths from the residuals of ten parts,
/// each predicted from the nine others: of those that hold 96 % of the residuals the one of least
/// geometric mean.
FittedFingertip fit_fingertip(const AtlasFile& atlas);

/// The installed fit's bounds of all models, tested on runs.
std::map<std::string, BoundTest> test_bounds_on_fingers(const AtlasFile& unseen);

/// The file analytic/softfinger/layer/fingertip_layer_table.cc.
std::string fingertip_table(const FittedFingertip& fitted, const std::string& command);

}  // namespace softfinger::judgement
