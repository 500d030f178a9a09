// The velocity at which stuck friction slides in MuJoCo, by the formulas of its documentation ("Computation", "Modeling:
// solver parameters") for a positive solref with a damping ratio of 1.
//
// Friction at rest obeys R f = -b v: no term brings a contact back to where it was. So a force f slides it at v = R f/b.

/** The impedance d(r) of solimp = (least, most, width, 0.5, 2) at a penetration. */
export function impedance(penetration_m, [least, most, width_m] = [0.9, 0.95, 1e-3]) {
  const x = Math.min(1, penetration_m / width_m);
  return least + (most - least) * (x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) ** 2);
}

/**
 * force_N: of friction at one contact point; inverseMass_per_kg: the sum of both bodies' (a fixed one's is 0)
 * friction: the coefficient for a pyramidal cone, 0 for an elliptic one
 */
export function residualVelocity_m_per_s({force_N, inverseMass_per_kg, penetration_m, friction = 0, impratio = 1, timeConstant_s = 0.02, solimp}) {
  const d = impedance(penetration_m, solimp), most = solimp?.[1] ?? 0.95;
  const R = (1 - d) / d * inverseMass_per_kg * (1 + friction ** 2) / impratio, b = 2 / (most * timeConstant_s);
  return R * force_N / b;
}
