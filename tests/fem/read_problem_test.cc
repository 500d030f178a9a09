#include "fem/program/read_problem.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "fem/program/read_pad.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/nesting.h"

namespace softfinger::fem {
namespace {

using nlohmann::json;

const MeshReaders& no_files() {
  static const MeshReaders readers = {
      [](const std::string& path, double) -> TriangleSurface {
        throw InputError(path, "file", "", "no file in this test");
      },
      [](const std::string& path, double, const auto&) -> std::shared_ptr<const meshes::LayerMesh> {
        throw InputError(path, "file", "", "no file in this test");
      }};
  return readers;
}

json problem() {
  return json::parse(R"({"name": "pad", "radii_m": [0.02, 0.01], "axis_rad": 0.1,
    "layer": {"thickness_m": 0.002, "youngs_modulus_Pa": 3e5, "poisson_ratio": 0.45,
      "sublayers": [
        {"name": "skin", "thickness_m": 0.001, "youngs_modulus_Pa": 3e5, "poisson_ratio": 0.45},
        {"name": "pulp", "thickness_m": 0.001, "youngs_modulus_Pa": 1e5, "poisson_ratio": 0.4}]},
    "kinematics": "finite", "load_N": 5, "friction_coefficient": 0.8, "level": 1,
    "fingertip": {
      "pad": {"shape": "ellipsoid", "radii_m": [0.02, 0.01], "turn_rad": 0.2},
      "object": {"shape": "paraboloid", "radii_m": [null, -0.5]}},
    "friction": {"torsion": true, "increments": 10, "twist_axis_m": [0.001, 0],
      "limit_surface": 12, "increments_to_slip": 4}})");
}

std::string refusal_of(const json& input) {
  try {
    read_problem(input, no_files());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadProblem, EveryKeyArrives) {
  const Problem read = read_problem(problem(), no_files());
  EXPECT_EQ(read.name, "pad");
  EXPECT_EQ(read.contact.radii.major_m, 0.02);
  EXPECT_EQ(read.contact.radii.minor_m, 0.01);
  EXPECT_EQ(read.contact.radii.axis_rad, 0.1);
  EXPECT_EQ(read.contact.layer.thickness_m, 0.002);
  EXPECT_EQ(read.contact.layer.youngs_modulus_Pa, 3e5);
  EXPECT_EQ(read.contact.layer.poisson_ratio, 0.45);
  ASSERT_EQ(read.sublayers.size(), 2u);
  EXPECT_EQ(read.sublayers[1].layer.youngs_modulus_Pa, 1e5);
  EXPECT_TRUE(read.finite_strain);
  EXPECT_EQ(read.contact.load.normal_force_N, 5);
  EXPECT_EQ(read.contact.load.friction_coefficient, 0.8);
  EXPECT_EQ(read.level, 1);
  ASSERT_TRUE(read.fingertip);
  EXPECT_GT(read.fingertip.pad->radius_x(), read.fingertip.pad->radius_y());
  EXPECT_DOUBLE_EQ(read.fingertip.object->height(1, 0.1).value(), -0.01);
  EXPECT_TRUE(read.friction.torsion);
  EXPECT_EQ(read.friction.increments, 10);
  EXPECT_EQ(read.friction.twist_axis_x_m, 0.001);
  EXPECT_EQ(read.friction.limit_surface, 12);
  EXPECT_EQ(read.friction.increments_to_slip, 4);
}

TEST(ReadProblem, TakesShearLaws) {
  json input = problem();
  EXPECT_EQ(read_problem(input, no_files()).shear_law, ShearLaw::Kind::coulomb);
  input["shear_law"] = "limited";
  EXPECT_NE(refusal_of(input).find("shear_strength_Pa"), std::string::npos);
  input["shear_strength_Pa"] = 4e4;
  const Problem limited = read_problem(input, no_files());
  EXPECT_EQ(limited.shear_law, ShearLaw::Kind::limited);
  EXPECT_EQ(limited.shear_strength_Pa, 4e4);
  input["shear_law"] = "shear_strength";
  input.erase("friction_coefficient");
  EXPECT_EQ(read_problem(input, no_files()).contact.load.friction_coefficient, 0);
  input["shear_law"] = "stickiness";
  EXPECT_NE(refusal_of(input).find("\"adhesive_shear\""), std::string::npos);
}

TEST(ReadProblem, KeysThatMayBeMissingMayBeNull) {
  json input = problem();
  for (const char* key :
       {"name", "axis_rad", "sphere_radius_m", "kinematics", "level", "fingertip", "friction",
        "approach_m", "compliance_file", "output_directory", "layer_mesh", "lists_forces"})
    input[key] = nullptr;
  const Problem read = read_problem(input, no_files());
  EXPECT_EQ(read.level, 2);
  EXPECT_FALSE(read.fingertip);
  EXPECT_FALSE(read.finite_strain);
}

TEST(ReadProblem, ValuesOutOfRangeAreRefusedByTheirKey) {
  struct Wrong {
    const char *pointer, *key;
    json value;
  };
  const json many_sublayers(51, problem()["layer"]["sublayers"][0]);
  const std::vector<Wrong> all = {
      {"/radii_m", "radii_m", {0.02}},
      {"/radii_m", "radii_m", 0.02},
      {"/radii_m/1", "radii_m[1]", 0},
      {"/radii_m/1", "radii_m[1]", nullptr},
      {"/axis_rad", "axis_rad", "0.1"},
      {"/sphere_radius_m", "sphere_radius_m", -1},
      {"/layer", "layer", json::array()},
      {"/layer/thickness_m", "layer.thickness_m", -0.001},
      {"/layer/thickness_m", "layer.thickness_m", 1e-320},
      {"/layer/thickness_m", "layer.thickness_m is missing", nullptr},
      {"/layer/youngs_modulus_Pa", "layer.youngs_modulus_Pa", true},
      {"/layer/poisson_ratio", "layer.poisson_ratio", 0.51},
      {"/layer/sublayers", "layer.sublayers", many_sublayers},
      {"/layer/sublayers/1/poisson_ratio", "layer.sublayers[1].poisson_ratio", -0.1},
      {"/layer/sublayers/1/thickness_m", "layer.sublayers[1].thickness_m", 0},
      {"/layer/sublayers/0/name", "layer.sublayers[0].name", 7},
      {"/layer/material", "layer.material", "glue"},
      {"/layer/volumetric", "layer.volumetric", 1},
      {"/layer/mooney_rivlin_share", "layer.mooney_rivlin_share", 1.1},
      {"/layer/yeoh_ratios", "layer.yeoh_ratios", {0.1}},
      {"/kinematics", "kinematics", "infinite"},
      {"/load_N", "load_N is missing", nullptr},
      {"/load_N", "load_N", -5},
      {"/approach_m", "approach_m", -1e-3},
      {"/friction_coefficient", "friction_coefficient", 0},
      {"/level", "level", 5},
      {"/level", "level", 1.5},
      {"/level", "level", 4294967297},
      {"/friction/torsion", "friction.torsion", 1},
      {"/friction/increments", "friction.increments", 1001},
      {"/friction/limit_surface", "friction.limit_surface", -1},
      {"/friction/limit_surface", "friction.limit_surface", 1000000000},
      {"/friction/increments_to_slip", "friction.increments_to_slip", 1e300},
      {"/friction/twist_axis_m", "friction.twist_axis_m", {0, 0, 0}},
      {"/fingertip/pad/shape", "fingertip.pad.shape", "cube"},
      {"/fingertip/pad/radii_m/0", "fingertip.pad.radii_m[0]", 0},
      {"/fingertip/pad/turn_rad", "fingertip.pad.turn_rad", "left"},
      {"/fingertip/object/shape", "fingertip.object.shape is missing", nullptr},
      {"/layer_mesh", "layer_mesh.metres_per_unit", {{"mesh", "m"}, {"metres_per_unit", 0}}},
      {"/output_directory", "output_directory", std::string("a\0b", 3)},
      {"/output_directory", "output_directory", std::string(5000, 'x')},
      {"/name", "name", json::array()}};
  for (const Wrong& wrong : all) {
    json input = problem();
    input[json::json_pointer(wrong.pointer)] = wrong.value;
    const std::string message = refusal_of(input);
    EXPECT_NE(message.find(std::string(": ") + wrong.key), std::string::npos)
        << wrong.pointer << " = " << wrong.value.dump() << ": " << message;
    EXPECT_EQ(message.find("json.exception"), std::string::npos) << message;
    EXPECT_LT(message.size(), 200u) << message;
  }
}

TEST(ReadProblem, WhatIsNoProblemAtAllIsRefused) {
  for (const char* text : {"null", "1", "\"text\"", "[]", "{}"})
    EXPECT_NE(refusal_of(json::parse(text)), "") << text;
}

json pad_problem() {
  return json::parse(R"({"name": "cup", "pad": {"outline": {"shape": "rectangle",
      "lengths_m": [0.02, 0.01], "corner_radius_m": 0.001},
      "thickness_m": 0.003, "youngs_modulus_Pa": 1e6, "poisson_ratio": 0.48},
    "face": {"outline": {"shape": "polygon", "points_m": [[0, 0], [0.01, 0], [0, 0.005]]},
      "offset_m": [0.001, 0], "angle_rad": 0.2},
    "pressing": "stuck", "load_N": 7, "load_point_m": [0.001, 0.0005],
    "friction_coefficient": 0.9, "friction": {"limit_surface": 30}, "level": 1})");
}

TEST(ReadPad, EveryKeyArrives) {
  EXPECT_TRUE(is_pad(pad_problem()));
  EXPECT_FALSE(is_pad(problem()));
  const PadProblem read = read_pad(pad_problem());
  EXPECT_EQ(read.name, "cup");
  EXPECT_EQ(read.outline.lengths_m[0], 0.02);
  EXPECT_EQ(read.outline.corner_radius_m, 0.001);
  EXPECT_EQ(read.thickness_m, 0.003);
  EXPECT_EQ(read.poisson_ratio, 0.48);
  ASSERT_TRUE(read.face);
  EXPECT_EQ(read.face->shape.points_m.size(), 3u);
  EXPECT_EQ(read.face->offset_m[0], 0.001);
  EXPECT_EQ(read.face->angle_rad, 0.2);
  EXPECT_EQ(read.pressing, PadPressing::stuck);
  EXPECT_EQ(read.load_point_m.value()[1], 0.0005);
  EXPECT_EQ(read.limit_surface, 30);
  EXPECT_EQ(read.level, 1);
}

TEST(ReadPad, ValuesOutOfRangeAreRefusedByTheirKey) {
  struct Wrong {
    const char *pointer, *key;
    json value;
  };
  for (const Wrong& wrong :
       std::vector<Wrong>{{"/pad/outline/shape", "pad.outline.shape", "star"},
                          {"/pad/outline/lengths_m", "pad.outline.lengths_m", {1}},
                          {"/pad/thickness_m", "pad.thickness_m", -1},
                          {"/pad/poisson_ratio", "pad.poisson_ratio", 0.6},
                          {"/pad/edge_radius_m", "pad.edge_radius_m", -0.001},
                          {"/face/outline/points_m", "face.outline.points_m", {{0, 0}, {1, 1}}},
                          {"/pressing", "pressing is missing", nullptr},
                          {"/pressing", "pressing", "glued"},
                          {"/kinematics", "kinematics", "finite"},
                          {"/load_N", "load_N", 0},
                          {"/level", "level", 4}}) {
    json input = pad_problem();
    input[json::json_pointer(wrong.pointer)] = wrong.value;
    std::string message;
    try {
      read_pad(input);
    } catch (const InputError& error) {
      message = error.what();
    }
    EXPECT_NE(message.find(std::string(": ") + wrong.key), std::string::npos)
        << wrong.pointer << ": " << message;
  }
}

TEST(ParseProblems, TextThatIsNoJsonIsRefusedWithItsPlace) {
  for (const auto& [text, place] : std::vector<std::pair<std::string, std::string>>{
           {"", "line 1, column 1"}, {"{\n  \"a\": }", "line 2, column 8"}}) {
    try {
      parse_problems(text, "some.json");
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), "some.json: not JSON at " + place);
    }
  }
  EXPECT_THROW(parse_problems("[1e999]", "some.json"), InputError);
}

// The copy of the pad's text alone overflowed the stack, from about 100,000 brackets on.
TEST(ParseProblems, DeepNestingIsRefused) {
  const auto nested = [](std::size_t depth) {
    json input = problem();
    std::string text = input.dump();
    text.pop_back();
    return text + ", \"more\": " + std::string(depth, '[') + std::string(depth, ']') + "}";
  };
  EXPECT_NO_THROW(read_problem(parse_problems(nested(63), "some.json"), no_files()));
  EXPECT_THROW(parse_problems(nested(64), "some.json"), InputError);
  EXPECT_THROW(parse_problems(nested(300000), "some.json"), InputError);
}

TEST(Nesting, BracketsInsideStringsDoNotCount) {
  EXPECT_EQ(deepest_nesting(""), 0);
  EXPECT_EQ(deepest_nesting("[[], {\"a\": [1]}]"), 3);
  EXPECT_EQ(deepest_nesting("\"[[[\""), 0);
  EXPECT_EQ(deepest_nesting("[\"\\\"[[\"]"), 1);
  EXPECT_EQ(deepest_nesting("[\"\\\\\"[[\"]"), 3);
}

}  // namespace
}  // namespace softfinger::fem
