#include "comparisons/prediction/quantity.h"

#include "comparisons/text/percent.h"

namespace softfinger::prediction {

std::string in_words(const Demand& demand) {
  std::string words = "within " + text::percent(demand.tolerance);
  if (demand.quantities == kUsualQuantities) return words;
  const char* separator = " in ";
  for (std::size_t q = 0; q < kQuantities; ++q)
    if (demand.quantities[q]) {
      words += separator + std::string(kQuantityNames[q]);
      separator = ", ";
    }
  return words;
}

}  // namespace softfinger::prediction
