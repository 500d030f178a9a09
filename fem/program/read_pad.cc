#include "fem/program/read_pad.h"

#include "fem/program/json_entry.h"

namespace softfinger::fem {
namespace {

/// An outline of more points than the solver takes is refused there, by its corners.
constexpr std::size_t most_points = 1000;

std::array<double, 2> read_point(const Entry& entry) {
  const std::vector<Entry> both = entry.list(2, 2);
  return {both[0].finite(), both[1].finite()};
}

FlatShape read_shape(const Entry& entry) {
  FlatShape shape;
  const std::string name = entry.at("shape").choice({"disc", "rectangle", "polygon"});
  if (name == "disc") {
    shape.radius_m = entry.at("radius_m").positive();
  } else if (name == "rectangle") {
    shape.kind = FlatShape::Kind::rectangle;
    const std::vector<Entry> both = entry.at("lengths_m").list(2, 2);
    shape.lengths_m = {both[0].positive(), both[1].positive()};
    if (const auto radius = entry.find("corner_radius_m"))
      shape.corner_radius_m = radius->number(0, 1e300, "a finite number from 0 on");
  } else {
    shape.kind = FlatShape::Kind::polygon;
    for (const Entry& point : entry.at("points_m").list(3, most_points))
      shape.points_m.push_back(read_point(point));
  }
  return shape;
}

}  // namespace

bool is_pad(const nlohmann::json& input) { return input.is_object() && input.contains("pad"); }

PadProblem read_pad(const nlohmann::json& input) {
  PadProblem problem;
  if (const auto name = Entry(input, "", "pad").find("name")) problem.name = name->text();
  const Entry root(input, "", problem.name);
  const Entry pad = root.at("pad");
  problem.outline = read_shape(pad.at("outline"));
  problem.thickness_m = pad.at("thickness_m").positive();
  problem.youngs_modulus_Pa = pad.at("youngs_modulus_Pa").positive();
  problem.poisson_ratio = pad.at("poisson_ratio").number(0, 0.5, "a number from 0 to 0.5");
  if (const auto edge = pad.find("edge_radius_m"))
    problem.edge_radius_m = edge->number(0, 1e300, "a finite number from 0 on");
  if (const auto face = root.find("face")) {
    ObjectFace object;
    object.shape = read_shape(face->at("outline"));
    if (const auto offset = face->find("offset_m")) object.offset_m = read_point(*offset);
    if (const auto angle = face->find("angle_rad")) object.angle_rad = angle->finite();
    problem.face = object;
  }
  if (const auto curved = root.find("object")) {
    CurvedObject object;
    const std::vector<Entry> radii = curved->at("radii_m").list(2, 2);
    object.radii_m = {radii[0].radius(), radii[1].radius()};
    if (const auto offset = curved->find("offset_m")) object.offset_m = read_point(*offset);
    problem.object = object;
  }
  if (const auto kinematics = root.find("kinematics"))
    if (kinematics->choice({"linear", "finite"}) == "finite")
      kinematics->refuse("\"linear\": flat pads are not solved at finite strain");
  if (root.at("pressing").choice({"frictionless", "stuck"}) == "stuck")
    problem.pressing = PadPressing::stuck;
  problem.load_N = root.at("load_N").positive();
  if (const auto at = root.find("load_point_m")) problem.load_point_m = read_point(*at);
  problem.friction_coefficient = root.at("friction_coefficient").positive();
  if (const auto friction = root.find("friction"))
    if (const auto points = friction->find("limit_surface"))
      problem.limit_surface = points->whole(0, 10000);
  if (const auto level = root.find("level")) problem.level = level->whole(1, 3);
  return problem;
}

}  // namespace softfinger::fem
