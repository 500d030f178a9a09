#include <gtest/gtest.h>

#include <cstddef>
#include <thread>
#include <vector>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

/// Contacts of several sizes and of both layers' kinds, in an order of each thread's own.
std::vector<ContactProblem> problems() {
  std::vector<ContactProblem> all;
  for (const double load_N : {0.2, 1., 5.})
    for (const double poisson_ratio : {0.3, 0.49})
      all.push_back({{0.02, 0.02, 0}, {0.002, 3e5, poisson_ratio}, {load_N, 0.5}, {}, {}});
  return all;
}

struct Answer {
  Prediction prediction;
  double pressure_Pa = 0;
};

Answer ask(const PressureModel& model, const ContactProblem& problem) {
  Answer answer;
  answer.prediction = model.predict(problem);
  answer.pressure_Pa = model.pressure_Pa(problem, answer.prediction, answer.prediction.a_m / 2, 0);
  return answer;
}

// Built with the preset thread_sanitized it also finds what happens to give the right numbers.
TEST(PressureModels, AnswerManyThreadsAsTheyAnswerOne) {
  const auto all = problems();
  const auto& models = all_pressure_models();
  constexpr std::size_t threads = 4;
  std::vector<std::vector<Answer>> answers(threads,
                                           std::vector<Answer>(models.size() * all.size()));
  std::vector<std::thread> running;
  for (std::size_t thread = 0; thread < threads; ++thread)
    running.emplace_back([&, thread] {
      for (std::size_t i = 0; i < answers[thread].size(); ++i) {
        // Each starts elsewhere, so that no two ask the same at the same time.
        const std::size_t k = (i + thread * answers[thread].size() / threads) % answers[0].size();
        answers[thread][k] = ask(*models[k / all.size()], all[k % all.size()]);
      }
    });
  for (std::thread& thread : running) thread.join();
  for (std::size_t k = 0; k < answers[0].size(); ++k) {
    const Answer alone = ask(*models[k / all.size()], all[k % all.size()]);
    for (const auto& of_thread : answers) {
      EXPECT_EQ(of_thread[k].prediction.has_answer, alone.prediction.has_answer);
      EXPECT_EQ(of_thread[k].prediction.a_m, alone.prediction.a_m);
      EXPECT_EQ(of_thread[k].prediction.indentation_m, alone.prediction.indentation_m);
      EXPECT_EQ(of_thread[k].prediction.torque_arm_exact_m, alone.prediction.torque_arm_exact_m);
      EXPECT_EQ(of_thread[k].pressure_Pa, alone.pressure_Pa);
    }
  }
}

}  // namespace
}  // namespace softfinger
