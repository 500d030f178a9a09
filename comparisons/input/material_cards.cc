#include "comparisons/input/material_cards.h"

namespace softfinger::input {

const std::vector<MaterialCard>& material_cards() {
  static const std::vector<MaterialCard> cards = {
      {"neo_hookean", "hyperelastic material of the finite elements: chains without interaction",
       "volumetric = \"quadratic\": W = G/2 (J^(-2/3) I1 - 3) + k/2 (J - 1)^2; \"logarithmic\": W "
       "= "
       "G/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2",
       "G = E/(2 (1 + nu)), k = E/(3 (1 - 2 nu)), lambda = k - 2 G/3, of [layer]; I1 = tr(F^T F), "
       "J = "
       "det F",
       "Holzapfel, Nonlinear Solid Mechanics, 2000, sections 6.4 and 6.5",
       "silicone to stretches of about 1.5; below nu = 0.45 the volumetric law is felt: up to 9 % "
       "in "
       "the load at given indentation"},
      {"mooney_rivlin", "hyperelastic material of the finite elements: two invariants",
       "W = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + U, U = k/2 (J - 1)^2 (\"quadratic\") "
       "or "
       "k/2 (ln J)^2 (\"logarithmic\")",
       "2 (c10 + c01) = G; mooney_rivlin_share = c01/(c10 + c01), 0 to 1; I2 = |cof F|^2",
       "Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.5",
       "rubber to stretches of about 2; stable for shares from 0 to 1"},
      {"yeoh", "hyperelastic material of the finite elements: softens, then stiffens",
       "W = c10 x + c20 x^2 + c30 x^3 + U, x = J^(-2/3) I1 - 3, U = k/2 (J - 1)^2 (\"quadratic\") "
       "or "
       "k/2 (ln J)^2 (\"logarithmic\")",
       "2 c10 = G; yeoh_ratios = [c20/c10, c30/c10]",
       "Yeoh, Rubber Chemistry and Technology 66, 1993",
       "filled rubber; refused where its stress falls at a stretch between 0.4 and 2.5"},
  };
  return cards;
}

}  // namespace softfinger::input
