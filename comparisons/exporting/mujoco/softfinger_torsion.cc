#include "comparisons/exporting/mujoco/softfinger_torsion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include "comparisons/exporting/mujoco/eccentricity_table.h"
#include "softfinger/input/contact_problem.h"

struct softfinger_torsion {
  softfinger::exporting::EccentricityTable table;
};

namespace {

/// MuJoCo's mjMINMU and mjMINVAL: its least coefficient of friction and least regulariser.
constexpr double least_friction = 1e-5, least_R = 1e-15;

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

/// @throws std::invalid_argument in words
softfinger::ContactProblem read_problem(const double* numbers, int count) {
  if (count != 5 && count != 8)
    throw std::invalid_argument(std::to_string(count) +
                                " numbers: allowed: 5 (R' R'' h E nu) or 8 (and the finger's "
                                "curvatures xx yy xy)");
  softfinger::ContactProblem problem;
  problem.radii = {numbers[0], numbers[1], 0};
  problem.layer = {numbers[2], numbers[3], numbers[4]};
  for (int i = 0; i < 4; ++i)
    if (!is_positive(numbers[i]))
      throw std::invalid_argument("number " + std::to_string(i + 1) +
                                  ": allowed: R', R'', h in m and E in Pa, all > 0");
  if (numbers[0] < numbers[1]) throw std::invalid_argument("R' < R'': allowed: R' >= R''");
  if (!(numbers[4] >= 0 && numbers[4] <= 0.5))
    throw std::invalid_argument("number 5: allowed: Poisson's ratio, 0 to 0.5");
  if (count == 8) {
    for (int i = 5; i < 8; ++i)
      if (!std::isfinite(numbers[i]))
        throw std::invalid_argument("number " + std::to_string(i + 1) +
                                    ": allowed: a finite curvature in 1/m");
    problem.finger_curvature = {numbers[5], numbers[6], numbers[7]};
  }
  return problem;
}

}  // namespace

softfinger_torsion* softfinger_torsion_create(const double* numbers, int count, char* error,
                                              int error_size) {
  try {
    auto finger = std::make_unique<softfinger_torsion>(
        softfinger_torsion{softfinger::exporting::EccentricityTable(read_problem(numbers, count))});
    if (!finger->table.has_answer())
      throw std::invalid_argument("fingertip_layer has no answer for it");
    return finger.release();
  } catch (const std::exception& problem) {
    if (error && error_size > 0)
      std::snprintf(error, std::size_t(error_size), "%s", problem.what());
    return nullptr;
  }
}

void softfinger_torsion_free(softfinger_torsion* finger) { delete finger; }

double softfinger_torsion_eccentricity_m(const softfinger_torsion* finger, double load_N) {
  return finger->table.at(load_N);
}

void softfinger_torsion_set(const softfinger_torsion* finger, const softfinger_torsion* other,
                            double normal_N, double* friction, double* efc_R, double* efc_D,
                            double* efc_diagA, double* efc_AR_diagonal) {
  if (!(normal_N > 0)) return;
  double eccentricity_m = 0;
  for (const softfinger_torsion* soft : {finger, other})
    if (soft) eccentricity_m = std::max(eccentricity_m, soft->table.at(normal_N));
  const double torsion_m = std::max(friction[0] * eccentricity_m, least_friction);
  // MuJoCo gives the rows of an elliptic cone R_j = R_1 mu²/friction_j², so that R goes with the
  // inverse square of the coefficient.
  const double ratio = friction[2] / torsion_m, square = ratio * ratio, before = *efc_R;
  friction[2] = torsion_m;
  *efc_R = std::max(least_R, before * square);
  *efc_D = 1 / *efc_R;
  if (efc_diagA) *efc_diagA *= square;
  if (efc_AR_diagonal) *efc_AR_diagonal += *efc_R - before;
}
