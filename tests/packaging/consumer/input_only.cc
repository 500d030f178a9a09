#include "softfinger/input/contact_problem.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/triangle_surface.h"

double confined_modulus_Pa() {
  return softfinger::ElasticLayer{0.002, 300e3, 0.3}.oedometric_modulus_Pa();
}
