#pragma once

#include <array>
#include <map>
#include <string>

#include "comparisons/judgement/atlas/error_atlas.h"
#include "softfinger/accuracy/finger_departure.h"

/// The fit behind `error_bound`: how far `bonded_layer` is from fingers at finite strain.
namespace softfinger::judgement {

/// What a fit says of runs that it did not see.
struct DepartureTest {
  std::size_t runs = 0;
  QuantityErrors inside{};  ///< share of the errors within their bound
  QuantityErrors ratio{};   ///< median of bound over error
};

struct FittedDeparture {
  std::array<DepartureFit, kQuantities> fits;
  QuantityErrors finite_elements{};  ///< stated by the runs, 95 % of them at most so much
  std::size_t runs = 0;
};

/// Weighted least squares over the runs at finite strain that are no exact spheres. Widths from the
/// residuals of ten parts, each predicted from the nine others: the pair of least median bound with
/// 96 % of the residuals inside.
FittedDeparture fit_departure(const AtlasFile& atlas);

/// The installed fit's bounds of all models, tested on runs.
std::map<std::string, DepartureTest> test_departure(const AtlasFile& unseen);

/// The file analytic/softfinger/accuracy/finger_departure_table.cc.
std::string departure_table(const FittedDeparture& fitted, const std::string& command);

}  // namespace softfinger::judgement
