#include "comparisons/input/pad_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

constexpr std::size_t kMostOutlinePoints = 200;
/// The least and the largest length that a pad may have: a micrometre and a kilometre.
constexpr double kLeastSide_m = 1e-6, kLargestSide_m = 1e3;
/// Least width over largest of a contact that a pad's theory describes.
constexpr double kThinnest = 0.02;

/// Keys of a figure: of the finger "pad", of the object "face".
struct FigureKeys {
  std::string sides, diameter, outline;
  explicit FigureKeys(const std::string& what)
      : sides(what + "_mm"), diameter(what + "_diameter_mm"), outline(what + "_outline_mm") {}
  bool any(const toml::table& table) const {
    return table.contains(sides) || table.contains(diameter) || table.contains(outline);
  }
};

const FigureKeys kPadKeys("pad"), kFaceKeys("face");

const toml::table* table_of(const toml::table& geometry, const char* name) {
  const toml::node* node = geometry.get(name);
  return node ? node->as_table() : nullptr;
}

double side_of(const TomlReader& reader, const toml::node& node, const std::string& field,
               double typed_mm) {
  const double side_m = typed_mm * kMillimetre;
  if (!(side_m >= kLeastSide_m && side_m <= kLargestSide_m))
    reader.refuse(node, field, "0.001 to 1000000, in mm");
  return side_m;
}

Eigen::Vector2d point_of(const TomlReader& reader, const toml::node& node,
                         const std::string& field) {
  const std::string allowed = "[x, y]: two finite numbers in mm, at most 1000000";
  const auto xy = reader.numbers(node, field, 2, allowed);
  for (const double number : xy)
    if (std::abs(number) * kMillimetre > kLargestSide_m) reader.refuse(node, field, allowed);
  return kMillimetre * Eigen::Vector2d(xy[0], xy[1]);
}

FlatFigure read_figure(const TomlReader& reader, const toml::node& node, const toml::table& table,
                       const std::string& name, const FigureKeys& keys) {
  const int forms = int(table.contains(keys.sides)) + int(table.contains(keys.diameter)) +
                    int(table.contains(keys.outline));
  if (forms != 1)
    reader.say(node, fmt::format("{} needs exactly one of {}, {}, {}", name, keys.sides,
                                 keys.diameter, keys.outline));
  const toml::node* corner = table.get("corner_radius_mm");
  if (corner && !table.contains(keys.sides))
    reader.say(*corner, fmt::format("corner_radius_mm belongs to {}.{}", name, keys.sides));
  if (const toml::node* sides = table.get(keys.sides)) {
    const std::string field = name + "." + keys.sides;
    const auto typed = reader.numbers(*sides, field, 2, "[length, width], both > 0, in mm");
    RectangleFigure figure{side_of(reader, *sides, field, typed[0]),
                           side_of(reader, *sides, field, typed[1]), 0};
    if (corner) {
      const double most_mm = 1e3 * std::min(figure.length_m, figure.width_m) / 2;
      const std::string allowed =
          fmt::format("0 to half of the shorter side, {:g}, in mm", most_mm);
      const double radius_mm = reader.number(*corner, name + ".corner_radius_mm", allowed);
      // Half of a side may round to either side of it.
      constexpr double kRounding = 1e-12;
      if (radius_mm < 0 || radius_mm > most_mm * (1 + kRounding))
        reader.refuse(*corner, name + ".corner_radius_mm", allowed);
      figure.corner_radius_m = std::min(radius_mm, most_mm) * kMillimetre;
    }
    return figure;
  }
  if (const toml::node* diameter = table.get(keys.diameter)) {
    const std::string field = name + "." + keys.diameter;
    return DiscFigure{
        side_of(reader, *diameter, field, reader.number(*diameter, field, "a number > 0, in mm"))};
  }
  const toml::node& outline = *table.get(keys.outline);
  const std::string field = name + "." + keys.outline;
  OutlineFigure figure;
  for (const toml::node& entry :
       reader.list(outline, field, kMostOutlinePoints, "[[x, y], ..]: three points or more, in mm"))
    figure.points_m.push_back(point_of(reader, entry, field));
  try {
    const ConvexOutline checked = ConvexOutline::polygon(figure.points_m);
    if (checked.least_width_m() < kLeastSide_m)
      reader.say(outline, field + " is narrower than 0.001 mm");
  } catch (const InputError& error) {
    if (error.where() != "outline") throw;
    throw InputError(reader.where(outline), field, error.value(), error.allowed());
  }
  return figure;
}

/// The flat part of a figure whose edge is rounded: everything `inset_m` further inside.
std::optional<ConvexOutline> outline_of(const FlatFigure& figure, double inset_m) {
  if (const auto* sides = std::get_if<RectangleFigure>(&figure)) {
    const double length_m = sides->length_m - 2 * inset_m, width_m = sides->width_m - 2 * inset_m;
    if (!(length_m > 0 && width_m > 0)) return std::nullopt;
    return ConvexOutline::rounded_rectangle(
        length_m, width_m,
        std::min(std::max(0.0, sides->corner_radius_m - inset_m), std::min(length_m, width_m) / 2));
  }
  if (const auto* disc = std::get_if<DiscFigure>(&figure)) {
    const double diameter_m = disc->diameter_m - 2 * inset_m;
    if (!(diameter_m > 0)) return std::nullopt;
    return ConvexOutline::disc(diameter_m);
  }
  const ConvexOutline whole = ConvexOutline::polygon(std::get<OutlineFigure>(figure).points_m);
  return inset_m > 0 ? whole.shrunk(inset_m) : whole;
}

/// Why a body beside a flat one is none of the flat ones.
[[noreturn]] void refuse_curved(const TomlReader& reader, const toml::node& node, bool is_finger) {
  reader.say(node, is_finger ? "geometry.finger is curved and geometry.object is flat: give "
                               "finger = { pad_mm = [22, 37.5] } for a flat pad, or object = { "
                               "radii_mm = [inf, inf] } for a plane under a curved finger"
                             : "geometry.finger is a flat pad and geometry.object is not flat: a "
                               "pad takes object = { flat = true } (a larger plane), { face_mm = "
                               "[l, w] }, { face_diameter_mm }, { face_outline_mm }, { "
                               "cylinder_radius_mm }, { sphere_radius_mm } or { radii_mm = [Rx, "
                               "Ry] }");
}

constexpr const char* kRoller = "roller_radius_mm";
const std::array<std::string, 3> kCurvedKeys{"cylinder_radius_mm", "sphere_radius_mm", "radii_mm"};

bool is_curved(const toml::table& object) {
  return std::any_of(kCurvedKeys.begin(), kCurvedKeys.end(),
                     [&](const std::string& key) { return object.contains(key); });
}

/// A radius of an object that bulges towards the pad.
double bulge_of(const TomlReader& reader, const toml::node& node, const std::string& field,
                double typed_mm, bool may_be_straight) {
  const double radius_m = typed_mm * kMillimetre;
  if (may_be_straight && std::isinf(radius_m) && radius_m > 0) return radius_m;
  if (radius_m < 0)
    reader.refuse(node, field,
                  "a radius > 0, in mm: a hollow object conforms to the pad and is not answered");
  return side_of(reader, node, field, typed_mm);
}

double bulge_of(const TomlReader& reader, const toml::node& node, const std::string& field) {
  return bulge_of(reader, node, field, reader.number(node, field, "a radius > 0, in mm"), false);
}

CurvedFace read_curved(const TomlReader& reader, const toml::node& node, const toml::table& table) {
  reader.check_keys(table, "object", {kCurvedKeys[0], kCurvedKeys[1], kCurvedKeys[2], "offset_mm"});
  if (std::count_if(kCurvedKeys.begin(), kCurvedKeys.end(),
                    [&](const std::string& key) { return table.contains(key); }) != 1)
    reader.say(node, "object needs exactly one of cylinder_radius_mm, sphere_radius_mm, radii_mm");
  if (const toml::node* cylinder = table.get(kCurvedKeys[0]))
    return {kInfinity, bulge_of(reader, *cylinder, "object.cylinder_radius_mm")};
  if (const toml::node* sphere = table.get(kCurvedKeys[1])) {
    const double radius_m = bulge_of(reader, *sphere, "object.sphere_radius_mm");
    return {radius_m, radius_m};
  }
  const toml::node& both = *table.get(kCurvedKeys[2]);
  const auto typed = reader.numbers(both, "object.radii_mm", 2,
                                    "[Rx, Ry]: radii > 0, in mm; inf along a straight direction",
                                    /*infinity_allowed=*/true);
  const CurvedFace face{bulge_of(reader, both, "object.radii_mm", typed[0], true),
                        bulge_of(reader, both, "object.radii_mm", typed[1], true)};
  if (std::isinf(face.radius_x_m) && std::isinf(face.radius_y_m))
    reader.say(both, "object.radii_mm = [inf, inf] is a plane: give flat = true");
  if (std::isinf(face.radius_y_m))
    reader.say(both,
               "object.radii_mm = [R, inf] is a cylinder along the pad's second side: exchange "
               "both sides of pad_mm, and give cylinder_radius_mm = R");
  return face;
}

/// A cylinder with a sleeve of the layer, on a plane or on a cylinder whose axis is parallel.
void read_roller(const TomlReader& reader, const toml::table& geometry, const toml::table& table,
                 PadPair& pair) {
  reader.check_keys(table, "finger", {kRoller, "length_mm"});
  const double radius_m = bulge_of(reader, *table.get(kRoller), std::string("finger.") + kRoller);
  const toml::node& length = reader.required(table, "finger", "length_mm");
  const double length_m =
      side_of(reader, length, "finger.length_mm",
              reader.number(length, "finger.length_mm", "the length of the line > 0, in mm"));
  pair.is_roller = true;
  // A contact stays far from the sides of such a pad.
  pair.finger.figure = RectangleFigure{length_m, 2 * radius_m, 0};
  const toml::node& node = reader.required(geometry, "[geometry]", "object");
  const toml::table* object = node.as_table();
  const std::string allowed =
      "a roller takes object = { flat = true }, or { cylinder_radius_mm = R } with a parallel axis";
  if (!object || object->contains("flat") == object->contains(kCurvedKeys[0]))
    reader.say(node, allowed);
  double curvature_per_m = 1 / radius_m;
  if (object->contains("flat")) {
    reader.check_keys(*object, "object", {"flat"});
    if (!reader.boolean(*object->get("flat"), "object.flat", "true, a larger plane"))
      reader.say(node, allowed);
  } else {
    reader.check_keys(*object, "object", {kCurvedKeys[0]});
    curvature_per_m +=
        1 / bulge_of(reader, *object->get(kCurvedKeys[0]), "object.cylinder_radius_mm");
  }
  pair.curved = CurvedFace{kInfinity, 1 / curvature_per_m};
}

/// Refuses what only a flat face has.
void check_curved(const TomlReader& reader, const toml::table& geometry, const toml::table& contact,
                  PadPair& pair) {
  const toml::node& node = *geometry.get("finger");
  const auto* sides = std::get_if<RectangleFigure>(&pair.finger.figure);
  if (!sides)
    reader.say(node, "under a curved object the pad is a rectangle: finger = { pad_mm = [l, w] }");
  if (const toml::node* angle = geometry.get("angle_deg"))
    reader.say(*angle,
               "a curved object's axes lie along the pad's sides: for a cylinder along the second "
               "side exchange both sides of pad_mm");
  if (const toml::node* at = contact.get("load_at_mm"))
    reader.say(*at, "load_at_mm is for flat faces: a curved object is pressed without turning");
  if (const toml::node* pressing = contact.get("pressing"))
    if (reader.choice(*pressing, "pressing", {"stuck", "frictionless"}) == "stuck")
      reader.say(*pressing,
                 "pressing = \"stuck\" is for flat faces: under a curved object points come into "
                 "contact one after the other; \"frictionless\" is answered, whose torque holds "
                 "for both");
  pair.pressing = PadPressing::frictionless;
  if (std::abs(pair.offset_m.x()) >= sides->length_m / 2 ||
      std::abs(pair.offset_m.y()) >= sides->width_m / 2)
    reader.say(*geometry.get("object"),
               "object.offset_mm puts the object's middle outside of the pad");
}

FlatPad read_pad(const TomlReader& reader, const toml::table& geometry) {
  const toml::node& node = reader.required(geometry, "[geometry]", "finger");
  const toml::table* table = node.as_table();
  if (!table || !kPadKeys.any(*table)) refuse_curved(reader, node, true);
  reader.check_keys(
      *table, "finger",
      {kPadKeys.sides, kPadKeys.diameter, kPadKeys.outline, "corner_radius_mm", "edge_radius_mm"});
  FlatPad pad;
  pad.figure = read_figure(reader, node, *table, "finger", kPadKeys);
  if (const toml::node* edge = table->get("edge_radius_mm")) {
    const double half_mm = 1e3 * outline_of(pad.figure, 0)->least_width_m() / 2;
    const std::string allowed =
        fmt::format("0 to less than half of the pad's least width, {:.4g}, in mm", half_mm);
    const double radius_mm = reader.number(*edge, "finger.edge_radius_mm", allowed);
    pad.edge_radius_m = radius_mm * kMillimetre;
    if (radius_mm < 0 || !(radius_mm < half_mm) || !outline_of(pad.figure, pad.edge_radius_m))
      reader.refuse(*edge, "finger.edge_radius_mm", allowed);
  }
  return pad;
}

void read_face(const TomlReader& reader, const toml::table& geometry, PadPair& pair) {
  const toml::node* node = geometry.get("object");
  if (!node)
    reader.say(geometry,
               "[geometry] has no object: a plane larger than the pad is object = { flat = true }, "
               "a face of its own object = { face_mm = [length, width] }");
  const toml::table* table = node->as_table();
  if (!table || (!kFaceKeys.any(*table) && !table->contains("flat")))
    refuse_curved(reader, *node, false);
  reader.check_keys(*table, "object",
                    {"flat", kFaceKeys.sides, kFaceKeys.diameter, kFaceKeys.outline,
                     "corner_radius_mm", "offset_mm", "angle_deg"});
  if (const toml::node* flat = table->get("flat")) {
    if (!reader.boolean(*flat, "object.flat", "true, a plane larger than the pad"))
      reader.refuse(*flat, "object.flat", "true, a plane larger than the pad");
    for (const auto& [key, value] : *table)
      if (key.str() != "flat")
        reader.say(value, fmt::format("object.{} belongs to a face with an end, and object.flat is "
                                      "a plane without one: give face_mm = [l, w] in its place",
                                      key.str()));
    return;
  }
  pair.object.figure = read_figure(reader, *node, *table, "object", kFaceKeys);
  if (const toml::node* offset = table->get("offset_mm"))
    pair.offset_m = point_of(reader, *offset, "object.offset_mm");
  const toml::node *inner = table->get("angle_deg"), *outer = geometry.get("angle_deg");
  if (inner && outer)
    reader.say(*inner, "object.angle_deg and angle_deg say the same: one of them");
  if (const toml::node* angle = inner ? inner : outer) {
    const std::string allowed = "a finite number of degrees, at most 1e6";
    const double degrees = reader.number(*angle, "angle_deg", allowed);
    if (std::abs(degrees) > 1e6) reader.refuse(*angle, "angle_deg", allowed);
    pair.angle_rad = kDegree * degrees;
  }
}

/// Sets where pad and face touch.
void intersect(const TomlReader& reader, const toml::table& geometry, PadPair& pair) {
  pair.pad = pair.contact = *outline_of(pair.finger.figure, pair.finger.edge_radius_m);
  if (pair.object.figure) {
    const ConvexOutline face =
        outline_of(*pair.object.figure, 0)->moved(pair.angle_rad, pair.offset_m);
    const auto common = pair.pad.common_with(face);
    if (!common)
      reader.say(*geometry.get("object"),
                 "the object's face does not touch the pad: its offset_mm is larger than both");
    pair.contact = *common;
    pair.covered = std::min(1.0, common->area_m2() / pair.pad.area_m2());
  }
  if (pair.contact.least_width_m() < kThinnest * pair.contact.largest_width_m())
    reader.say(
        geometry,
        fmt::format("pad and face touch in a sliver of {:.3g} x {:.3g} mm: allowed: a "
                    "contact at least a fiftieth as wide as it is long; move the face by "
                    "offset_mm, or give a line contact as radii_mm",
                    1e3 * pair.contact.largest_width_m(), 1e3 * pair.contact.least_width_m()));
}

}  // namespace

bool is_flat_geometry(const toml::table& geometry) {
  const toml::table *finger = table_of(geometry, "finger"), *object = table_of(geometry, "object");
  return (finger && (kPadKeys.any(*finger) || finger->contains(kRoller))) ||
         (object && (object->contains("flat") || kFaceKeys.any(*object)));
}

PadPair read_pad_pair(const TomlReader& reader, const toml::table& geometry,
                      const toml::table& contact) {
  reader.check_keys(geometry, "[geometry]", {"finger", "object", "angle_deg"});
  PadPair pair;
  const toml::table *finger = table_of(geometry, "finger"), *object = table_of(geometry, "object");
  if (finger && finger->contains(kRoller)) {
    read_roller(reader, geometry, *finger, pair);
    check_curved(reader, geometry, contact, pair);
    pair.pad = pair.contact = *outline_of(pair.finger.figure, 0);
    return pair;
  }
  pair.finger = read_pad(reader, geometry);
  if (object && is_curved(*object)) {
    pair.curved = read_curved(reader, *geometry.get("object"), *object);
    if (const toml::node* offset = object->get("offset_mm"))
      pair.offset_m = point_of(reader, *offset, "object.offset_mm");
    check_curved(reader, geometry, contact, pair);
    pair.pad = pair.contact = *outline_of(pair.finger.figure, pair.finger.edge_radius_m);
    return pair;
  }
  read_face(reader, geometry, pair);
  if (!pair.object.figure)
    if (const toml::node* angle = geometry.get("angle_deg"))
      reader.say(*angle, "angle_deg turns a face with an end, and object.flat has none");
  intersect(reader, geometry, pair);
  if (const toml::node* pressing = contact.get("pressing"))
    if (reader.choice(*pressing, "pressing", {"stuck", "frictionless"}) == "frictionless")
      pair.pressing = PadPressing::frictionless;
  if (const toml::node* at = contact.get("load_at_mm")) {
    pair.load_at_m = point_of(reader, *at, "load_at_mm");
    pair.load_at_where = reader.where(*at);
    if (!pair.contact.contains(*pair.load_at_m)) {
      const Eigen::Vector2d centre = 1e3 * pair.contact.centroid_m();
      reader.refuse(*at, "load_at_mm",
                    fmt::format("a point of the contact, whose middle is [{:.4g}, {:.4g}]: the pad "
                                "tips over a load outside of it",
                                centre.x(), centre.y()));
    }
  }
  return pair;
}

}  // namespace softfinger::input
