// Microseconds of CPU time per contact problem, the median of random scenes (each timed several
// times), with the worst residual, mean pivots and how many scenes failed. Beside it, where Siconos
// is there, its lcp_lexicolemke on the same problems as dense LCPs, assembled beforehand: the
// median of those that it solves, and ours over the same ones. Then warm starts: the next time
// steps of scenes, cold and warm; then exact friction.
//
//   lcp_bench [seconds]   of Siconos per row at most (default 20)
//   lcp_bench exact       exact friction alone
//   lcp_bench coulomb     friction without torque, beside Siconos' NSGS and NSN_AC
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "tests/dynamics/random_scene.h"

#ifdef SOFTFINGER_SICONOS
#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/LCP_Solvers.h>
#include <siconos/numerics/LinearComplementarityProblem.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/SolverOptions.h>
#include <siconos/numerics/SparseBlockMatrix.h>
#include <siconos/numerics/lcp_cst.h>
#endif

namespace softfinger {
namespace {

double clock_us(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return 1e6 * double(time.tv_sec) + 1e-3 * double(time.tv_nsec);
}

/// CPU time of all threads. Other work on the machine changes it only through shared caches.
double cpu_us() { return clock_us(CLOCK_PROCESS_CPUTIME_ID); }

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Scenes where all contacts separate cost nothing: they are left out.
bool is_trivial(const ContactLcp& problem) {
  for (int i = 0; i < problem.contacts(); ++i)
    if (problem.free_velocity[4 * i] < 0) return false;
  return true;
}

std::vector<ContactLcp> make_problems(int count, int contacts, int vertices, FrictionRule rule,
                                      bool with_root = false) {
  static const SixPatchShape shape(0.5, 0.5);
  tests::RandomScenes scenes(100);
  scenes.gives_roots = with_root;
  std::vector<ContactLcp> problems;
  while (int(problems.size()) < count) {
    problems.push_back(scenes.next(contacts, vertices));
    problems.back().friction_rule = rule;
    problems.back().shapes.assign(std::size_t(contacts), &shape);
    if (is_trivial(problems.back())) problems.pop_back();
  }
  return problems;
}

struct Row {
  double median_us = 0, p90_us = 0, worst_us = 0, residual = 0, pivots = 0;
  int failures = 0;
};

/// Solves the scenes under several numbers of vertices. The sets take turns: otherwise a machine
/// whose speed changes by the second would distort their ratios.
std::vector<Row> solve_in_turns(const std::vector<std::vector<ContactLcp>>& sets, int repetitions,
                                std::vector<std::vector<double>>* all_us = nullptr,
                                std::vector<std::vector<double>>* all_on_clock_us = nullptr) {
  const int contacts = sets.front().front().contacts();
  std::vector<ContactLcpSolver> solvers;
  for (const auto& problems : sets)
    solvers.emplace_back(contacts, int(problems.front().vertices.cols()));
  ContactSolution solution;
  solution.resize(contacts);
  std::vector<Row> rows(sets.size());
  std::vector<std::vector<double>> times(sets.size()), times_on_clock(sets.size());
  for (std::size_t scene = 0; scene < sets.front().size(); ++scene) {
    std::vector<std::vector<double>> same(sets.size()), same_on_clock(sets.size());
    std::vector<LcpResult> results(sets.size());
    for (int i = 0; i < repetitions; ++i)
      for (std::size_t n = 0; n < sets.size(); ++n) {
        const double start = cpu_us(), start_on_clock = clock_us(CLOCK_MONOTONIC);
        results[n] = solvers[n].solve(sets[n][scene], solution);
        same[n].push_back(cpu_us() - start);
        same_on_clock[n].push_back(clock_us(CLOCK_MONOTONIC) - start_on_clock);
      }
    for (std::size_t n = 0; n < sets.size(); ++n) {
      times[n].push_back(quantile(same[n], 0.5));
      times_on_clock[n].push_back(quantile(same_on_clock[n], 0.5));
      rows[n].failures += results[n].status != LcpStatus::solved;
      rows[n].residual = std::max(rows[n].residual, results[n].residual);
      rows[n].pivots += double(results[n].pivots) / double(sets[n].size());
    }
  }
  for (std::size_t n = 0; n < sets.size(); ++n) {
    rows[n].median_us = quantile(times[n], 0.5);
    rows[n].p90_us = quantile(times[n], 0.9);
    rows[n].worst_us = quantile(times[n], 1);
  }
  if (all_us) *all_us = times;
  if (all_on_clock_us) *all_on_clock_us = times_on_clock;
  return rows;
}

#ifdef SOFTFINGER_SICONOS

Row solve_cold(const std::vector<ContactLcp>& problems, int repetitions) {
  return solve_in_turns({problems}, repetitions).front();
}

/// The whole matrix: rows and unknowns P; beta; lambda.
struct DenseLcp {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd constant;
};

DenseLcp dense(const ContactLcp& problem) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols()), n = nc * (u + 2);
  DenseLcp lcp;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(4 * nc, n);
  lcp.matrix.setZero(n, n);
  for (int i = 0; i < nc; ++i) {
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    columns(4 * i, i) = 1;
    columns.block(4 * i + 1, nc + i * u, 3, u) = arms.asDiagonal() * problem.vertices;
    const int lambda = nc + nc * u + i;
    lcp.matrix.block(nc + i * u, lambda, u, 1).setOnes();
    lcp.matrix.block(lambda, nc + i * u, 1, u).setConstant(-1);
    lcp.matrix(lambda, i) = problem.friction_coefficient[i];
  }
  lcp.matrix += columns.transpose() * problem.delassus * columns;
  lcp.constant = columns.transpose() * problem.free_velocity;
  return lcp;
}

/// The residual of `contact_residual`, of a raw solution.
double residual_of(const ContactLcp& problem, const std::vector<double>& z) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  ContactSolution solution;
  solution.resize(nc);
  for (int i = 0; i < nc; ++i) {
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    solution.impulse[4 * i] = z[std::size_t(i)];
    solution.slip[i] = z[std::size_t(nc + nc * u + i)];
    for (int j = 0; j < u; ++j) {
      const double weight = z[std::size_t(nc + i * u + j)];
      if (weight == 0) continue;
      solution.weights.push_back({i, j, weight});
      solution.impulse.segment<3>(4 * i + 1) += weight * arms.cwiseProduct(problem.vertices.col(j));
    }
  }
  solution.velocity = problem.free_velocity + problem.delassus * solution.impulse;
  return contact_residual(problem, solution);
}

/// Solves as many of the problems as `most_s` allows, at least three.
Row solve_by_siconos(const std::vector<ContactLcp>& problems, const std::vector<double>& ours_us,
                     double most_s, int& tried, double& ratio) {
  Row row;
  std::vector<double> times, ours;
  const double begin = cpu_us();
  tried = 0;
  for (const ContactLcp& problem : problems) {
    if (tried >= 3 && cpu_us() - begin > 1e6 * most_s) break;
    DenseLcp lcp = dense(problem);
    const int n = int(lcp.constant.size());
    NumericsMatrix* matrix = NM_create_from_data(NM_DENSE, n, n, lcp.matrix.data());
    LinearComplementarityProblem siconos{n, matrix, lcp.constant.data()};
    SolverOptions* options = solver_options_create(SICONOS_LCP_LEMKE);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 20 * n;
    std::vector<double> z(std::size_t(n), 0.), w(std::size_t(n), 0.);
    int info = 0;
    const double start = cpu_us();
    lcp_lexicolemke(&siconos, z.data(), w.data(), &info, options);
    const double took_us = cpu_us() - start;
    const double residual = residual_of(problem, z);
    const bool good = info == 0 && residual <= 1e-6;
    row.failures += !good;
    if (good) {
      row.residual = std::max(row.residual, residual);
      times.push_back(took_us);
      ours.push_back(ours_us[std::size_t(tried)]);
    }
    ++tried;
    solver_options_delete(options);
    std::free(options);
    matrix->matrix0 = nullptr;  // not its own
    NM_clear(matrix);
    std::free(matrix);
  }
  row.median_us = quantile(times, 0.5);
  ratio = row.median_us / quantile(ours, 0.5);
  return row;
}

#endif

void compare_cold(double siconos_s) {
  std::printf("Cold, facets\n%8s %4s %10s %10s %9s %7s %6s", "contacts", "u", "median us", "p90 us",
              "residual", "pivots", "failed");
#ifdef SOFTFINGER_SICONOS
  std::printf(" | %12s %9s %9s %7s", "Siconos us", "residual", "failed", "ratio");
#else
  static_cast<void>(siconos_s);
#endif
  std::printf("\n");
  const auto run = [&](int contacts, const std::vector<int>& numbers, bool with_siconos) {
    // Their costs spread over a factor of hundred: of 64 scenes the median is known to 20 % only.
    const int scenes = contacts > 20 ? 64 : 512;
    std::vector<std::vector<ContactLcp>> sets;
    for (const int vertices : numbers)
      sets.push_back(make_problems(scenes, contacts, vertices, FrictionRule::facets));
    std::vector<std::vector<double>> ours_us;
    const std::vector<Row> rows = solve_in_turns(sets, contacts > 20 ? 3 : 5, &ours_us);
    for (std::size_t n = 0; n < sets.size(); ++n) {
      const Row& row = rows[n];
      std::printf("%8d %4d %10.1f %10.1f %9.1e %7.1f %6d", contacts, numbers[n], row.median_us,
                  row.p90_us, row.residual, row.pivots, row.failures);
#ifdef SOFTFINGER_SICONOS
      if (with_siconos && contacts * numbers[n] <= 640) {
        int tried = 0;
        double ratio = 0;
        const Row peer = solve_by_siconos(sets[n], ours_us[n], siconos_s, tried, ratio);
        std::printf(" | %12.1f %9.1e %3d of %2d %7.0f", peer.median_us, peer.residual,
                    peer.failures, tried, ratio);
      }
#else
      static_cast<void>(with_siconos);
#endif
      std::printf("\n");
      std::fflush(stdout);
    }
    if (rows.size() < 2) return;
    std::vector<double> ratios;
    for (std::size_t scene = 0; scene < ours_us.front().size(); ++scene)
      ratios.push_back(ours_us.back()[scene] / ours_us.front()[scene]);
    std::printf(
        "%8d u = %d costs %.2f times u = %d (medians); scene by scene %.2f, half of them "
        "%.2f to %.2f\n",
        contacts, numbers.back(), rows.back().median_us / rows.front().median_us, numbers.front(),
        quantile(ratios, 0.5), quantile(ratios, 0.25), quantile(ratios, 0.75));
  };
  for (const int contacts : {1, 5, 10, 20}) run(contacts, {16, 32, 128}, true);
  run(100, {16}, false);
}

const char* name(FrictionRule rule) {
  return rule == FrictionRule::facets      ? "facets"
         : rule == FrictionRule::ellipsoid ? "ellipsoid"
                                           : "six patches";
}

void compare_warm(bool steady) {
  std::printf(
      "\nWarm, the next ten time steps of 64 scenes, %s\n"
      "%8s %4s %-11s %10s %10s %6s %10s %10s %6s\n",
      steady ? "contacts moved and velocities changed by 1e-3" : "bodies that were hit fly apart",
      "contacts", "u", "friction", "cold us", "warm us", "ratio", "pivots", "steps", "failed");
  static const SixPatchShape shape(0.5, 0.5);
  for (const int contacts : {5, 10, 20})
    for (const FrictionRule rule :
         {FrictionRule::facets, FrictionRule::ellipsoid, FrictionRule::limit_surface}) {
      constexpr int kVertices = 32;
      tests::RandomScenes scenes(100);
      ContactLcpSolver warm(contacts, kVertices), cold(contacts, kVertices);
      ContactSolution of_warm, of_cold;
      std::vector<int> continued(static_cast<std::size_t>(contacts));
      std::iota(continued.begin(), continued.end(), 0);
      std::vector<double> cold_us, warm_us;
      double pivots = 0, cold_pivots = 0;
      int failures = 0;
      for (int scene = 0; scene < 64; ++scene) {
        ContactLcp problem = scenes.next(contacts, kVertices);
        problem.friction_rule = rule;
        problem.shapes.assign(std::size_t(contacts), &shape);
        warm.solve(problem, of_warm);
        for (int step = 0; step < 10; ++step) {
          if (steady)
            scenes.disturb(problem, 1e-3);
          else
            scenes.step(problem, of_warm, 1e-3);
          if (is_trivial(problem)) break;
          double start = cpu_us();
          const LcpResult colder = cold.solve(problem, of_cold);
          cold_us.push_back(cpu_us() - start);
          start = cpu_us();
          const LcpResult result = warm.solve(problem, of_warm, &continued);
          warm_us.push_back(cpu_us() - start);
          pivots += result.pivots;
          cold_pivots += colder.pivots;
          failures += result.status != LcpStatus::solved;
        }
      }
      const double a = quantile(cold_us, 0.5), b = quantile(warm_us, 0.5);
      std::printf("%8d %4d %-11s %10.1f %10.1f %6.2f %4.1f:%5.1f %10zu %6d\n", contacts, kVertices,
                  name(rule), a, b, b / a, pivots / double(warm_us.size()),
                  cold_pivots / double(warm_us.size()), warm_us.size(), failures);
      std::fflush(stdout);
    }
}

/// Hard scenes take several threads: CPU time of all, and the time on the clock, which other work
/// on the machine changes.
void show_exact() {
  constexpr double kAsked_us = 250e3;
  struct Kind {
    const char* name;
    FrictionRule rule;
    bool with_root;
  };
  constexpr Kind kKinds[] = {{"ellipsoid, bodies known", FrictionRule::ellipsoid, true},
                             {"ellipsoid, of W alone", FrictionRule::ellipsoid, false},
                             {"six patches, of W alone", FrictionRule::limit_surface, false}};
  std::printf("\nCold, exact friction\n%8s %-23s %10s %10s %10s %13s %9s %9s %7s %6s\n", "contacts",
              "friction", "median us", "p90 us", "worst us", "on clock us", "> 250 ms", "residual",
              "pivots", "failed");
  for (const int contacts : {1, 5, 10, 20, 50, 100})
    for (const Kind& kind : kKinds) {
      // Milliseconds each, spread over a factor of a thousand: a median of fewer is a lottery.
      const bool many = contacts > 20;
      std::vector<std::vector<double>> on_clock_us;
      const Row row =
          solve_in_turns({make_problems(many ? 256 : 64, contacts, 16, kind.rule, kind.with_root)},
                         many ? 1 : 3, nullptr, &on_clock_us)
              .front();
      const auto& own_us = on_clock_us.front();
      const auto slow = std::count_if(own_us.begin(), own_us.end(),
                                      [](double took_us) { return took_us > kAsked_us; });
      std::printf("%8d %-23s %10.1f %10.1f %10.1f %13.1f %9d %9.1e %7.1f %6d\n", contacts,
                  kind.name, row.median_us, row.p90_us, row.worst_us,
                  *std::max_element(own_us.begin(), own_us.end()), int(slow), row.residual,
                  row.pivots, row.failures);
      std::fflush(stdout);
    }
}

#ifdef SOFTFINGER_SICONOS

/// Coulomb's friction without torque: three rows per contact.
struct ThreeRows {
  explicit ThreeRows(const ContactLcp& problem)
      : contacts(problem.contacts()),
        matrix(3 * contacts, 3 * contacts),
        free_velocity(3 * contacts),
        friction(problem.friction_coefficient) {
    for (int i = 0; i < contacts; ++i) {
      free_velocity.segment<3>(3 * i) = problem.free_velocity.segment<3>(4 * i);
      for (int j = 0; j < contacts; ++j)
        matrix.block<3, 3>(3 * i, 3 * j) = problem.delassus.block<3, 3>(4 * i, 4 * j);
    }
  }
  int contacts;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd free_velocity, friction;
};

/// Milliseconds and the residual of `exact_contact_residual`.
struct PeerResult {
  double took_ms = 0, residual = 0;
};

PeerResult solve_by_fc3d(const ContactLcp& problem, int solver) {
  constexpr double kTolerance = 1e-8;
  // Beyond this many, of sweeps or of Newton's steps, neither converges.
  const int most_iterations = solver == SICONOS_FRICTION_3D_NSGS ? 20000 : 1000;
  ThreeRows rows(problem);
  const int n = 3 * rows.contacts;
  NumericsMatrix* whole = NM_create_from_data(NM_DENSE, n, n, rows.matrix.data());
  // Gauss-Seidel only needs the blocks that are not zero.
  NumericsMatrix* sparse = NM_create(NM_SPARSE, n, n);
  NM_copy_to_sparse(whole, sparse, 0);
  NumericsMatrix* blocks = nullptr;
  if (solver == SICONOS_FRICTION_3D_NSGS) {
    blocks = NM_create(NM_SPARSE_BLOCK, n, n);
    SBM_from_csparse(3, NM_csc(sparse), blocks->matrix1);
  }
  FrictionContactProblem peer{3, rows.contacts, blocks ? blocks : sparse, rows.free_velocity.data(),
                              rows.friction.data()};
  SolverOptions* options = solver_options_create(solver);
  options->iparam[SICONOS_IPARAM_MAX_ITER] = most_iterations;
  options->dparam[SICONOS_DPARAM_TOL] = kTolerance;
  Eigen::VectorXd reaction = Eigen::VectorXd::Zero(n), velocity = Eigen::VectorXd::Zero(n);
  const double start = cpu_us();
  fc3d_driver(&peer, reaction.data(), velocity.data(), options);
  PeerResult result;
  result.took_ms = 1e-3 * (cpu_us() - start);
  ContactSolution solution;
  solution.resize(rows.contacts);
  for (int i = 0; i < rows.contacts; ++i)
    solution.impulse.segment<3>(4 * i) = reaction.segment<3>(3 * i);
  result.residual = exact_contact_residual(problem, solution);
  solver_options_delete(options);
  std::free(options);
  whole->matrix0 = nullptr;  // not its own
  for (NumericsMatrix* matrix : {whole, sparse, blocks})
    if (matrix) {
      NM_clear(matrix);
      std::free(matrix);
    }
  return result;
}

/// Siconos' solvers of Coulomb's friction and ours, on the same scenes with e_n = 0. Solved means
/// our residual below 1e-6: theirs is another one.
void compare_coulomb() {
  constexpr double kGoodEnough = 1e-6;
  constexpr int kScenes = 24;
  std::printf(
      "\nCold, Coulomb's friction without torque: fc3d of Siconos, tolerance 1e-8; medians over "
      "all "
      "scenes\n%8s %-8s %10s %10s %10s %9s %6s\n",
      "contacts", "solver", "median ms", "p90 ms", "worst ms", "residual", "failed");
  for (const int contacts : {5, 10, 20, 50, 100}) {
    std::vector<ContactLcp> problems =
        make_problems(kScenes, contacts, 16, FrictionRule::ellipsoid);
    for (ContactLcp& problem : problems) problem.eccentricity_m.setZero();
    const Row ours = solve_cold(problems, 1);
    std::printf("%8d %-8s %10.3f %10.3f %10.3f %9.1e %6d\n", contacts, "ours",
                1e-3 * ours.median_us, 1e-3 * ours.p90_us, 1e-3 * ours.worst_us, ours.residual,
                ours.failures);
    for (const int solver : {SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_NSN_AC}) {
      // It takes seconds per scene.
      if (solver == SICONOS_FRICTION_3D_NSN_AC && contacts > 50) continue;
      std::vector<double> times_ms;
      double residual = 0;
      int failures = 0;
      for (const ContactLcp& problem : problems) {
        const PeerResult result = solve_by_fc3d(problem, solver);
        times_ms.push_back(result.took_ms);
        if (result.residual <= kGoodEnough)
          residual = std::max(residual, result.residual);
        else
          ++failures;
      }
      std::printf("%8d %-8s %10.3f %10.3f %10.3f %9.1e %6d\n", contacts,
                  solver == SICONOS_FRICTION_3D_NSGS ? "NSGS" : "NSN_AC", quantile(times_ms, 0.5),
                  quantile(times_ms, 0.9), quantile(times_ms, 1), residual, failures);
      std::fflush(stdout);
    }
  }
}

#endif

}  // namespace
}  // namespace softfinger

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "exact") {
    softfinger::show_exact();
    return 0;
  }
#ifdef SOFTFINGER_SICONOS
  if (argc > 1 && std::string(argv[1]) == "coulomb") {
    softfinger::compare_coulomb();
    return 0;
  }
#endif
  softfinger::compare_cold(argc > 1 ? std::atof(argv[1]) : 20);
  softfinger::compare_warm(true);
  softfinger::compare_warm(false);
  softfinger::show_exact();
#ifdef SOFTFINGER_SICONOS
  softfinger::compare_coulomb();
#endif
}
