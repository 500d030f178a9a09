// torsion_pipe NUMBER..     the numbers of softfinger_torsion_create
// Sets contacts of a MuJoCo that runs in another process: a line "normal_N friction[5] R D
// diagA AR" is answered by "friction[2] R D diagA AR".
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "comparisons/exporting/mujoco/softfinger_torsion.h"

int main(int count, char** words) {
  std::vector<double> numbers;
  for (int i = 1; i < count; ++i) numbers.push_back(std::strtod(words[i], nullptr));
  std::array<char, 200> error{};
  softfinger_torsion* const finger = softfinger_torsion_create(numbers.data(), int(numbers.size()),
                                                               error.data(), int(error.size()));
  if (!finger) {
    std::fprintf(stderr, "%s\n", error.data());
    return 2;
  }
  double normal_N = 0, R = 0, D = 0, diagonal = 0, of_AR = 0;
  std::array<double, 5> friction{};
  while (std::cin >> normal_N >> friction[0] >> friction[1] >> friction[2] >> friction[3] >>
         friction[4] >> R >> D >> diagonal >> of_AR) {
    softfinger_torsion_set(finger, nullptr, normal_N, friction.data(), &R, &D, &diagonal, &of_AR);
    std::printf("%.17g %.17g %.17g %.17g %.17g\n", friction[2], R, D, diagonal, of_AR);
    std::fflush(stdout);
  }
  softfinger_torsion_free(finger);
  return 0;
}
