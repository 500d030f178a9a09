#include "comparisons/input/measurements.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "comparisons/input/measured_silicones.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// The line that refuses the text; empty when it is accepted.
std::string table_refusal(const std::string& text) {
  try {
    parse_measurements(text, "data.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Measurements, AreReadInSiWithTheirLinesAndLoads) {
  const MeasurementTable table = parse_measurements(
      "\xef\xbb\xbf# ink on paper\r\n"
      "load_N, a_mm ,a_mm_std,\"area_mm2\",max_torque_mNm,tangential_force_N\r\n"
      "2,4.0,0.1,30,,\r\n"
      "\r\n"
      "# pressed again\r\n"
      "0.5,\"2.5\",,,1.5,0.4\r\n"
      "2,4.1,0.2,,,\r\n"
      ",,,,,\r\n",
      "data.csv");
  ASSERT_EQ(table.loads_N, (std::vector<double>{0.5, 2}));
  ASSERT_EQ(table.values.size(), 6u);
  const auto expect = [&](std::size_t i, MeasuredQuantity quantity, std::size_t contact,
                          double value, double std, int line) {
    EXPECT_EQ(table.values[i].quantity, quantity) << i;
    EXPECT_EQ(table.values[i].contact, contact) << i;
    EXPECT_DOUBLE_EQ(table.values[i].value, value) << i;
    EXPECT_DOUBLE_EQ(table.values[i].std, std) << i;
    EXPECT_EQ(table.lines[i], line) << i;
  };
  expect(0, MeasuredQuantity::a, 1, 4.0e-3, 0.1e-3, 3);
  expect(1, MeasuredQuantity::area, 1, 30e-6, 0, 3);
  expect(2, MeasuredQuantity::a, 0, 2.5e-3, 0, 6);
  expect(3, MeasuredQuantity::max_torque, 0, 1.5e-3, 0, 6);
  expect(4, MeasuredQuantity::tangential_force, 0, 0.4, 0, 6);
  expect(5, MeasuredQuantity::a, 1, 4.1e-3, 0.2e-3, 7);
}

TEST(Measurements, SkipAMachinesRowsBeforeTheTouch) {
  const MeasurementTable table = parse_measurements(
      "load_N,position_mm\n0.01,0.0\n-0.01,0.2\n0,0.4\n0.1,0.6\n0.3,0.8\n", "data.csv");
  EXPECT_TRUE(table.has_unknown_zero);
  ASSERT_EQ(table.values.size(), 2u);
  EXPECT_EQ(table.lines, (std::vector<int>{5, 6}));
  EXPECT_DOUBLE_EQ(table.values[0].value, 0.6e-3);
  EXPECT_EQ(table.loads_N, (std::vector<double>{0.1, 0.3}));
  const MeasurementTable part = table.only({1});
  EXPECT_EQ(part.loads_N, (std::vector<double>{0.3}));
  EXPECT_EQ(part.values[0].contact, 0u);
  EXPECT_TRUE(part.has_unknown_zero);
  EXPECT_FALSE(parse_measurements("load_N,indentation_mm\n1,2\n", "d").has_unknown_zero);
  EXPECT_TRUE(has(table_refusal("load_N,indentation_mm\n0,0.4\n"), "load_N"));
  EXPECT_TRUE(has(table_refusal("load_N,position_mm\n0,0.4\n"), "no measured value"));
  EXPECT_TRUE(has(table_refusal("load_N,position_mm,indentation_mm\n1,1,1\n"), "once"));
}

TEST(Measurements, MeanTheSameInMillimetresAndMetres) {
  const MeasurementTable one =
      parse_measurements("load_N,a_mm,area_mm2,indentation_mm,max_torque_mNm\n1,2,3,4,5\n", "one");
  const MeasurementTable other = parse_measurements(
      "load_N,a_m,area_m2,indentation_m,max_torque_Nm\n1,2e-3,3e-6,4e-3,5e-3\n", "other");
  ASSERT_EQ(one.values.size(), other.values.size());
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    EXPECT_EQ(one.values[i].quantity, other.values[i].quantity);
    EXPECT_DOUBLE_EQ(one.values[i].value, other.values[i].value);
  }
}

TEST(Measurements, AreRefusedInOneLineThatNamesThePlace) {
  struct Wrong {
    const char* text;
    std::vector<const char*> parts;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {"", {"data.csv", "empty"}},
           {"# nothing\n\n", {"empty"}},
           {"a_mm\n2\n", {"data.csv:1", "load_N"}},
           {"load_N\n2\n", {"data.csv:1", "measured quantity"}},
           {"load_N,a\n1,2\n", {"data.csv:1", "without a unit", "\"a\"", "a_mm or a_m"}},
           {"load,a_mm\n1,2\n", {"without a unit", "load_N"}},
           {"load_N,max_torque\n1,2\n", {"max_torque_mNm or max_torque_Nm"}},
           {"load_N,area_cm2\n1,2\n", {"unknown column", "area_mm2"}},
           {"load_N,a_mm,a_mm\n1,2,3\n", {"each column once"}},
           {"load_N,a_mm,a_m\n1,2,3\n", {"each quantity once", "a_mm"}},
           {"load_N,a_mm,b_mm_std\n1,2,3\n", {"b_mm is missing"}},
           {"load_N,load_N_std,a_mm\n1,2,3\n", {"no error of the load"}},
           {"load_N;a_mm\n1;2\n", {"semicolons"}},
           {"\xff\xfel\0o\0", {"UTF-16"}},
           {"load_N,a_mm\n", {"no measured value"}},
           {"load_N,a_mm\n1,\n", {"no measured value"}},
           {"load_N,a_mm\n,2\n", {"data.csv:2", "load_N"}},
           {"load_N,a_mm\n0,2\n", {"data.csv:2", "load_N = 0", "> 0"}},
           {"load_N,a_mm\n-1,2\n", {"load_N = -1"}},
           {"load_N,a_mm\n1,two\n", {"data.csv:2", "a_mm = \"two\"", "empty cell"}},
           {"load_N,a_mm\n1,nan\n", {"a_mm = \"nan\""}},
           {"load_N,a_mm\ninf,1\n", {"load_N = \"inf\""}},
           {"load_N,a_mm\n1,1e999\n", {"a_mm"}},
           {"load_N,a_mm\n1,1e-300\n", {"a_mm = 1e-300"}},
           {"load_N,a_mm\n1,0\n", {"a_mm = 0"}},
           {"load_N,a_mm,a_mm_std\n1,2,0\n", {"a_mm_std = 0", "standard deviation > 0"}},
           {"load_N,a_mm,a_mm_std\n1,2,-1\n", {"a_mm_std = -1"}},
           {"load_N,a_mm,a_mm_std\n1,,0.1\n", {"a_mm_std", "as a_mm is empty"}},
           {"load_N,a_mm\n1,2,3\n", {"data.csv:2", "number of cells = 3", "decimal comma"}},
           {"load_N,a_mm\n1\n", {"number of cells = 1"}},
       }) {
    const std::string line = table_refusal(wrong.text);
    for (const char* part : wrong.parts)
      EXPECT_TRUE(has(line, part)) << wrong.text << "\n" << line << "\nhas no " << part;
    EXPECT_FALSE(has(line, "\n")) << line;
  }
}

TEST(Measurements, AreRefusedWhenThereAreTooMany) {
  std::string text = "load_N,a_mm\n";
  for (std::size_t i = 0; i < kMostMeasuredRows; ++i) text += std::to_string(i + 1) + ",2\n";
  EXPECT_EQ(parse_measurements(text, "data.csv").values.size(), kMostMeasuredRows);
  EXPECT_TRUE(has(table_refusal(text + "5,2\n"), "at most 1000"));
  std::string wide = "load_N";
  for (int i = 0; i < 200; ++i) wide += ",a_mm";
  EXPECT_TRUE(has(table_refusal(wide + "\n"), "number of columns"));
}

TEST(Measurements, HaveAColumnForEveryQuantity) {
  for (std::size_t i = 0; i < kMeasuredQuantities; ++i) {
    const MeasuredColumn column = measured_column(MeasuredQuantity(i));
    const MeasurementTable table =
        parse_measurements("load_N," + column.name + "\n1,2\n", "data.csv");
    EXPECT_EQ(table.values[0].quantity, MeasuredQuantity(i));
    EXPECT_DOUBLE_EQ(table.values[0].value * column.per_SI, 2);
  }
}

TEST(MeasuredSilicones, AreFoundByTheirNamesAndModuli) {
  const MeasuredSilicone& skin = find_measured_silicone("dragon skin 10");
  EXPECT_EQ(skin.name, "Dragon Skin 10 MEDIUM");
  EXPECT_EQ(skin.to_30_kPa, 147);
  EXPECT_EQ(skin.low_kPa(), 111);
  EXPECT_EQ(skin.high_kPa(), 201);
  // A whole name counts even where another begins with it.
  EXPECT_EQ(find_measured_silicone("Dragon Skin FX Pro").to_30_kPa, 99);
  EXPECT_THROW(find_measured_silicone("Dragon Skin"), InputError);
  EXPECT_THROW(find_measured_silicone(""), InputError);
  const auto like = silicones_like(150e3);
  ASSERT_FALSE(like.empty());
  EXPECT_EQ(like.front()->name, "Dragon Skin 10 MEDIUM");
  EXPECT_TRUE(silicones_like(1e9).empty());
  for (const MeasuredSilicone& one : measured_silicones()) {
    EXPECT_LE(one.low_kPa(), one.to_30_kPa) << one.name;
    EXPECT_GE(one.high_kPa(), one.to_30_kPa) << one.name;
  }
}

}  // namespace
}  // namespace softfinger::input
