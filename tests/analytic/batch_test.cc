// Many contacts at once: the same bits as one by one, whatever lies among them.
#include "softfinger/pressure/batch.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/math/wide.h"
#include "softfinger/pressure/pressure_model.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

constexpr int kInputs = 9, kOutputs = 6;

struct Arrays {
  std::array<std::vector<double>, kInputs> in;
  std::array<std::vector<double>, kOutputs> out;

  void add(const std::array<double, kInputs>& contact) {
    for (std::size_t i = 0; i < kInputs; ++i) in[i].push_back(contact[i]);
  }
  ContactBatch batch() const {
    ContactBatch batch;
    batch.count = in[0].size();
    batch.normal_force_N = in[0].data();
    batch.youngs_modulus_Pa = in[1].data();
    batch.poisson_ratio = in[2].data();
    batch.thickness_m = in[3].data();
    batch.radius_major_m = in[4].data();
    batch.radius_minor_m = in[5].data();
    batch.finger_xx_per_m = in[6].data();
    batch.finger_yy_per_m = in[7].data();
    batch.finger_xy_per_m = in[8].data();
    batch.options.power_law = {0.002, 0.3, 2.5};
    return batch;
  }
  PredictionBatch answers() {
    for (std::vector<double>& one : out) one.assign(in[0].size(), -1);
    return {out[0].data(), out[1].data(), out[2].data(),
            out[3].data(), out[4].data(), out[5].data()};
  }
};

/// Random contacts, from those of fingertips to far beyond, and some that no model answers.
Arrays contacts(int count) {
  std::mt19937_64 generator(4);
  const auto between = [&](double low, double high) {
    return low + (high - low) * double(generator() >> 11) * 0x1p-53;
  };
  Arrays arrays;
  for (int i = 0; i < count; ++i) {
    const double wild = i % 5 == 0 ? 12 : 1;
    const double minor_m = 0.01 * std::exp(between(-1, 1) * wild);
    const double major_m = minor_m * std::exp(between(0, 2) * wild);
    arrays.add({std::exp(between(-3, 3) * wild), 3e5, i % 7 == 0 ? 0.5 : between(0, 0.5),
                0.002 * std::exp(between(-1, 1) * wild), major_m, i % 11 == 0 ? major_m : minor_m,
                between(0, 1) / major_m, between(0, 1) / minor_m, between(-0.2, 0.2) / minor_m});
  }
  for (const double broken : {0., -1., kInfinity, double(NAN)})
    for (std::size_t input = 0; input < kInputs; ++input) {
      std::array<double, kInputs> contact = {1, 3e5, 0.4, 0.002, 0.02, 0.01, 50, 100, 0};
      contact[input] = broken;
      arrays.add(contact);
    }
  arrays.add({1, 3e5, 0.7, 0.002, 0.02, 0.01, 50, 100, 0});
  arrays.add({1, 3e5, 0.4, 0.002, 0.01, 0.02, 50, 100, 0});
  return arrays;
}

TEST(Batch, HasTheBitsOfSinglePredictions) {
  Arrays arrays = contacts(2000);
  const ContactBatch batch = arrays.batch();
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    const std::string name(model->card().name);
    predict_batch(*model, batch, arrays.answers());
    int answered = 0;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Prediction one = model->predict(batch.problem(i));
      const std::array<double, kOutputs> numbers = {one.a_m,
                                                    one.b_m,
                                                    one.indentation_m,
                                                    one.peak_pressure_Pa,
                                                    one.torque_arm_exact_m,
                                                    one.torque_arm_paper_m};
      for (std::size_t q = 0; q < kOutputs; ++q)
        ASSERT_EQ(arrays.out[q][i], numbers[q]) << name << ", number " << q << " of " << i;
      answered += one.has_answer;
    }
    EXPECT_GT(answered, 1000) << name;
  }
}

TEST(Batch, PressesWithFrictionAsSinglePredictionsDo) {
  Arrays arrays = contacts(2000);
  ContactBatch batch = arrays.batch();
  std::vector<double> mu;
  for (std::size_t i = 0; i < batch.count; ++i)
    mu.push_back(i % 9 == 0 ? 0 : i % 9 == 1 ? kInfinity : 0.1 * double(i % 9));
  batch.pressing_friction_coefficient = mu.data();
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().hot_path) continue;
    const std::string name(model->card().name);
    PredictionBatch answers = arrays.answers();
    std::vector<double> pressure_arm_m(batch.count, -1), a_m(batch.count, -1), b_m(batch.count, -1);
    answers.pressure_arm_m = pressure_arm_m.data();
    answers.frictionless_a_m = a_m.data();
    answers.frictionless_b_m = b_m.data();
    const std::size_t before = testing::allocations();
    predict_batch(*model, batch, answers);
    EXPECT_EQ(testing::allocations(), before) << name;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const Prediction one = model->predict(batch.problem(i));
      const Prediction pressed = one.has_answer && knows_pressing_friction(*model)
                                     ? rubbed(*model, one, batch.problem(i), mu[i])
                                     : one;
      ASSERT_EQ(arrays.out[0][i], pressed.a_m) << name << " " << i;
      ASSERT_EQ(arrays.out[1][i], pressed.b_m) << name << " " << i;
      ASSERT_EQ(arrays.out[2][i], pressed.indentation_m) << name << " " << i;
      ASSERT_EQ(arrays.out[3][i], pressed.peak_pressure_Pa) << name << " " << i;
      ASSERT_EQ(arrays.out[4][i], one.torque_arm_exact_m) << name << " " << i;
      ASSERT_EQ(arrays.out[5][i], one.torque_arm_paper_m) << name << " " << i;
      ASSERT_EQ(pressure_arm_m[i], pressed.torque_arm_exact_m) << name << " " << i;
      ASSERT_EQ(a_m[i], one.a_m) << name << " " << i;
      ASSERT_EQ(b_m[i], one.b_m) << name << " " << i;
      for (const auto& numbers : arrays.out) ASSERT_TRUE(std::isfinite(numbers[i])) << name << i;
    }
  }
}

TEST(Batch, HasTheSameBitsWithoutWideInstructions) {
  Arrays arrays = contacts(2000);
  const ContactBatch batch = arrays.batch();
  for (const char* name : {"bonded_layer", "fingertip_layer"}) {
    const PressureModel& model = *find_pressure_model(name);
    predict_batch(model, batch, arrays.answers());
    const auto wide = arrays.out;
    const bool had_wide_instructions = std::exchange(has_wide_instructions, false);
    predict_batch(model, batch, arrays.answers());
    const Prediction one = model.predict(batch.problem(1));
    has_wide_instructions = had_wide_instructions;
    EXPECT_EQ(arrays.out, wide) << name;
    EXPECT_EQ(one.a_m, wide[0][1]) << name;
    EXPECT_EQ(one.torque_arm_exact_m, wide[4][1]) << name;
  }
}

TEST(Batch, TakesAnyNumberAndLeavesOutWhatIsNotWanted) {
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  const Prediction expected = model.predict(contacts(1).batch().problem(0));
  for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 7u, 8u}) {
    Arrays arrays = contacts(20);
    ContactBatch batch = arrays.batch();
    batch.count = count;
    std::vector<double> radii(20, -1);
    PredictionBatch wanted;
    wanted.a_m = radii.data();
    predict_batch(model, batch, wanted);
    for (std::size_t i = 0; i < radii.size(); ++i) EXPECT_EQ(radii[i] > 0, i < count);
    if (count > 0) {
      EXPECT_EQ(radii[0], expected.a_m);
    }
  }
}

TEST(Batch, WithoutCurvatureIsOfFlatLayers) {
  Arrays arrays = contacts(8);
  ContactBatch batch = arrays.batch();
  batch.count = 8;
  batch.finger_xx_per_m = batch.finger_yy_per_m = batch.finger_xy_per_m = nullptr;
  batch.are_objects_spherical = true;
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  predict_batch(model, batch, arrays.answers());
  for (std::size_t i = 0; i < 8; ++i) {
    ContactProblem problem = arrays.batch().problem(i);
    problem.finger_curvature = {};
    problem.is_object_spherical = true;
    EXPECT_EQ(arrays.out[2][i], model.predict(problem).indentation_m);
  }
}

TEST(Batch, NeverAllocates) {
  Arrays arrays = contacts(64);
  const ContactBatch batch = arrays.batch();
  const PredictionBatch answers = arrays.answers();
  const PressureModel& model = *find_pressure_model("fingertip_layer");
  predict_batch(model, batch, answers);
  const std::size_t before = testing::allocations();
  predict_batch(model, batch, answers);
  EXPECT_EQ(testing::allocations(), before);
}

}  // namespace
}  // namespace softfinger
