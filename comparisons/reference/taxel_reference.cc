#include "comparisons/reference/taxel_reference.h"

#include <algorithm>
#include <cmath>

namespace softfinger::reference {

prediction::TaxelAnswer read_taxels(const ReferenceResult& result, const LayerStack& layers,
                                    const prediction::TaxelRequest& request) {
  if (!result.forces)
    throw InputError("softfinger-fem", "nodal_forces", "", "a program of this version");
  std::vector<taxels::SpreadForce> forces;
  double half_x_m = 0, half_y_m = 0;
  for (const NodalForce& node : *result.forces) {
    const double half_m = 0.5 * std::sqrt(node.area_m2);
    forces.push_back(
        {node.x_m, node.y_m, half_m, half_m, node.force_N, node.friction_x_N, node.friction_y_N});
    half_x_m = std::max(half_x_m, std::abs(node.x_m) + half_m);
    half_y_m = std::max(half_y_m, std::abs(node.y_m) + half_m);
  }
  const double depth_m = std::min(request.depth_m, layers.thickness_m());
  taxels::TaxelGrid grid{request.columns, request.rows, 0};
  grid.pitch_m = request.pitch_m ? *request.pitch_m
                                 : taxels::covering_pitch_m(request.columns, request.rows, half_x_m,
                                                            half_y_m, depth_m);
  try {
    const taxels::ForceCells cells = taxels::forces_on_cells(forces, result.load_N, grid);
    prediction::TaxelAnswer answer =
        prediction::taxel_answer(taxels::read_taxels(cells, layers, depth_m), cells);
    answer.load_N = result.load_N;
    answer.model = "fem";
    answer.a_m = result.a_m;
    answer.b_m = result.b_m;
    return answer;
  } catch (const InputError& error) {
    prediction::refuse_taxels(error, request);
  }
}

}  // namespace softfinger::reference
