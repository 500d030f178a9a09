#include "comparisons/exporting/robot_lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <unordered_map>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/constants.h"
#include "softfinger/pads/convex_outline.h"

namespace softfinger::exporting {
namespace {

using Eigen::Vector3d;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// No pair of materials that robots have slides at more; simulators' files have 100 and 1e6 for
/// "never slides".
constexpr double kLargestFriction = 10;

/// The words of an attribute or a leaf; each is a number or none.
struct Word {
  std::string typed;
  double value = kNone;
};

std::vector<Word> words_of(const std::string& text) {
  std::vector<Word> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t\r\n", at)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    Word word;
    word.typed = text.substr(at, end - at);
    char* rest = nullptr;
    const double value = std::strtod(word.typed.c_str(), &rest);
    if (rest != word.typed.c_str() && *rest == '\0' && std::isfinite(value)) word.value = value;
    words.push_back(std::move(word));
    at = end;
  }
  return words;
}

double value_at(const std::vector<Word>& words, std::size_t i, double otherwise) {
  return i < words.size() && std::isfinite(words[i].value) ? words[i].value : otherwise;
}

std::string millimetres(double length_m) { return fmt::format("{:.3g} mm", 1e3 * length_m); }

std::string owner_of(const XmlElement& element) {
  for (const XmlElement* at = &element; at; at = at->parent)
    for (const char* key : {"name", "class", "reference"})
      if (!at->value(key).empty()) return at->name + " \"" + text::shortened(at->value(key)) + "\"";
  return element.name;
}

/// A shape with its limits.
struct Sized {
  const RobotShape* shape = nullptr;
  PadLimits limits;
};

class Linter {
 public:
  Linter(const XmlFile& file, const LintConditions& conditions, const MeshSize& mesh_size)
      : file_(file),
        format_(format_of(file)),
        mjcf_(file),
        shapes_(read_shapes(file, format_, mjcf_)),
        conditions_(conditions),
        mesh_size_(mesh_size) {
    for (const RobotShape& shape : shapes_.shapes) by_element_[shape.element] = &shape;
    for (const XmlElement* element : file.elements()) order_.emplace(element, order_.size());
  }

  std::vector<LintedNumber> run() {
    if (format_ == RobotFormat::mjcf)
      lint_mjcf();
    else
      lint_links();
    std::stable_sort(result_.begin(), result_.end(),
                     [this](const LintedNumber& one, const LintedNumber& other) {
                       return order_.at(one.element) < order_.at(other.element);
                     });
    return std::move(result_);
  }

 private:
  /// Adds a number that so far is possible.
  LintedNumber& add(const XmlElement& element, const std::string& name, const std::string& meaning,
                    const Word& word) {
    LintedNumber number;
    number.element = &element;
    number.owner = owner_of(element);
    number.name = name;
    number.meaning = meaning;
    number.typed = word.typed;
    number.value = word.value;
    number.least = number.most = kNone;
    result_.push_back(number);
    if (!std::isfinite(word.value))
      impossible(result_.back(), "is no finite number", "a finite number");
    return result_.back();
  }
  static void impossible(LintedNumber& number, std::string reason, std::string advice) {
    number.verdict = LintVerdict::impossible;
    number.reason = std::move(reason);
    number.advice = std::move(advice);
  }
  static void doubtful(LintedNumber& number, std::string reason, std::string advice) {
    if (number.verdict != LintVerdict::possible) return;
    number.verdict = LintVerdict::doubtful;
    number.reason = std::move(reason);
    number.advice = std::move(advice);
  }

  static void judge_friction(LintedNumber& number) {
    number.least = 0;
    number.most = kLargestFriction;
    if (number.value < 0)
      impossible(number, "a friction coefficient is not negative", "0.3 to 1.5, that of the pair");
    else if (number.value > kLargestFriction)
      impossible(number, "no materials have such a friction coefficient: rubber has up to 3",
                 "0.3 to 1.5, that of the pair");
  }

  static std::string of_shape(const Sized& sized) {
    return fmt::format("{} ({})", in_words(*sized.shape), owner_of(*sized.shape->element));
  }

  /// A length that is mu times a lever.
  /// @param sized  null: no shape has a size
  void judge_torsional(LintedNumber& number, double friction, const Sized* sized) const {
    if (number.verdict == LintVerdict::impossible) return;
    if (number.value < 0) {
      impossible(number, "a length is not negative", "a length in m, > 0, or 0");
      return;
    }
    if (!sized || number.value == 0) return;
    const PadLimits& limits = sized->limits;
    number.least = friction * limits.hertz_lever_m;
    number.most = friction * limits.punch_lever_m;
    const std::string advice = fmt::format(
        "{:.2g} to {:.2g}: mu {:g} times a lever of {} (Hertz at {:g} N) to {} (uniform pressure "
        "{}, rigid punch {})",
        number.least, number.most, friction, millimetres(limits.hertz_lever_m), conditions_.load_N,
        millimetres(limits.punch_lever_m), millimetres(limits.uniform_lever_m),
        millimetres(limits.punch_lever_m));
    if (!(friction > 0)) {
      impossible(number, "there is no torque where the sliding friction is 0", "0");
      return;
    }
    const double lever_m = number.value / friction;
    if (lever_m > limits.reach_m)
      impossible(number,
                 fmt::format("it is a length in m: a lever of {}, but {} reaches only {} from the "
                             "middle of a contact",
                             millimetres(lever_m), of_shape(*sized), millimetres(limits.reach_m)),
                 advice);
    else if (lever_m > 1.01 * limits.punch_lever_m)
      doubtful(number,
               fmt::format("a lever of {}, more than a rigid punch as large as {} has",
                           millimetres(lever_m), of_shape(*sized)),
               advice);
    else if (lever_m < 0.99 * limits.hertz_lever_m)
      doubtful(
          number,
          fmt::format("a lever of {}, less than that of the hardest pad (E {:.3g} kPa) on {}",
                      millimetres(lever_m), 1e-3 * conditions_.youngs_modulus_Pa, of_shape(*sized)),
          advice);
  }

  /// The mean distance by which the load moves ahead of a rolling contact.
  void judge_rolling(LintedNumber& number, const Sized* sized) const {
    if (number.verdict == LintVerdict::impossible) return;
    if (number.value < 0) {
      impossible(number, "a length is not negative", "a length in m, > 0, or 0");
      return;
    }
    if (!sized) return;
    number.least = 0;
    number.most = sized->limits.punch_lever_m;
    if (number.value > sized->limits.reach_m)
      impossible(number,
                 fmt::format("it is a length in m, the load's distance from the middle of the "
                             "contact, but {} reaches only {}",
                             of_shape(*sized), millimetres(sized->limits.reach_m)),
                 fmt::format("0.0001, at most {:.2g}", number.most));
  }

  void judge_stiffness(LintedNumber& number, const Sized* sized) const {
    if (number.verdict == LintVerdict::impossible) return;
    if (!(number.value > 0)) {
      impossible(number, "a contact without stiffness carries no load", "a stiffness in N/m, > 0");
      return;
    }
    if (!sized) return;
    number.least = 0;
    number.most = sized->limits.punch_stiffness_N_per_m;
    if (number.value > 1.01 * number.most)
      impossible(number,
                 fmt::format("a rigid punch as large as {} has at most {:.2g} N/m on a pad of E "
                             "{:.3g} kPa",
                             of_shape(*sized), number.most, 1e-3 * conditions_.youngs_modulus_Pa),
                 fmt::format("dP/dd of the pad, below {:.2g} N/m; --youngs-modulus-kPa says how "
                             "hard the hardest pad is",
                             number.most));
  }

  void judge_patch(LintedNumber& number, const Sized* sized) const {
    if (number.verdict == LintVerdict::impossible) return;
    if (!(number.value > 0)) {
      impossible(number, "a patch has a radius > 0", "the contact's radius in m");
      return;
    }
    if (!sized) return;
    const PadLimits& limits = sized->limits;
    number.least = 16 / (3 * kPi) * limits.hertz_lever_m;
    number.most = 16 / (3 * kPi) * limits.punch_lever_m;
    const std::string advice = fmt::format(
        "{:.2g} to {:.2g}: 16/(3 pi) times a lever of {} (Hertz at {:g} N) to {} (rigid punch)",
        number.least, number.most, millimetres(limits.hertz_lever_m), conditions_.load_N,
        millimetres(limits.punch_lever_m));
    const double lever_m = 3 * kPi / 16 * number.value;
    if (lever_m > limits.reach_m)
      impossible(number,
                 fmt::format("a lever of {}, but {} reaches only {} from the middle of a contact",
                             millimetres(lever_m), of_shape(*sized), millimetres(limits.reach_m)),
                 advice);
    else if (lever_m > 1.01 * limits.punch_lever_m || lever_m < 0.99 * limits.hertz_lever_m)
      doubtful(number,
               fmt::format("a lever of {}, outside of what a pad as large as {} has",
                           millimetres(lever_m), of_shape(*sized)),
               advice);
  }

  /// solimp: dmin, dmax, width, midpoint, power.
  void judge_solimp(const XmlElement& element, const std::string& name,
                    const std::vector<Word>& words) {
    static const char* const meanings[] = {"least impedance", "largest impedance", "width, m",
                                           "midpoint", "power"};
    for (std::size_t i = 0; i < words.size() && i < 5; ++i) {
      LintedNumber& number = add(element, fmt::format("{}[{}]", name, i), meanings[i], words[i]);
      if (number.verdict == LintVerdict::impossible) continue;
      const double value = number.value;
      if (i <= 1 || i == 3) {
        number.least = 0;
        number.most = 1;
        const char* const advice = i == 0 ? "0.9" : i == 1 ? "0.95" : "0.5";
        if (value < 0 || value > 1)
          impossible(number, "it is a share between 0 and 1, to which MuJoCo cuts it", advice);
        else if (i <= 1 && (value == 0 || value == 1))
          doubtful(number, "MuJoCo takes 0.0001 to 0.9999", advice);
      } else if (i == 2 && value < 0) {
        impossible(number, "a width is not negative", "0.001");
      } else if (i == 4 && value < 1) {
        impossible(number, "a power is at least 1", "2");
      }
    }
  }

  /// solref: a time constant and a damping ratio, both > 0, or minus a stiffness and a damping.
  void judge_solref(const XmlElement& element, const std::string& name,
                    const std::vector<Word>& words) {
    const double first = value_at(words, 0, 0.02), second = value_at(words, 1, 1);
    const bool is_direct = first <= 0 && second <= 0;
    const double step_s =
        value_at(words_of(mjcf_.option("option", "timestep")
                              ? mjcf_.option("option", "timestep")->value("timestep")
                              : ""),
                 0, 0.002);
    for (std::size_t i = 0; i < words.size() && i < 2; ++i) {
      const char* const meaning =
          is_direct ? (i == 0 ? "minus the stiffness over a mass, 1/s2" : "minus the damping, 1/s")
                    : (i == 0 ? "time constant, s" : "damping ratio");
      LintedNumber& number = add(element, fmt::format("{}[{}]", name, i), meaning, words[i]);
      if (number.verdict == LintVerdict::impossible) continue;
      if ((first > 0) != (second > 0))
        impossible(number,
                   "of two numbers with different signs MuJoCo takes none, but its defaults",
                   "two numbers > 0, such as 0.02 1, or two < 0");
      else if (is_direct && i == 0 && first == 0)
        impossible(number, "a contact without stiffness carries no load", "0.02 1");
      else if (!is_direct && i == 0 && first < 2 * step_s)
        doubtful(number,
                 fmt::format("MuJoCo raises it to two time steps, {:g} s, unless refsafe is off",
                             2 * step_s),
                 fmt::format("{:g}", 2 * step_s));
    }
  }

  /// Null for a shape without a size. Meshes are read when they are asked for.
  const Sized* sized_of(const XmlElement* element) {
    const auto [place, is_new] = sized_.try_emplace(element);
    if (is_new)
      if (const auto shape = by_element_.find(element); shape != by_element_.end())
        if (const auto limits = limits_of(*shape->second, conditions_, mesh_size_))
          place->second = std::make_unique<Sized>(Sized{shape->second, *limits});
    return place->second.get();
  }

  /// Whether a geom is more than a picture.
  bool touches(const XmlElement& geom) const {
    const auto is_zero = [&](const char* name) {
      const std::string value = mjcf_.value(geom, name);
      return !value.empty() && std::strtol(value.c_str(), nullptr, 0) == 0;
    };
    return !mjcf_.pairs(geom).empty() || !(is_zero("contype") && is_zero("conaffinity"));
  }

  /// The largest shape of the file that touches.
  const Sized* largest() {
    if (has_largest_) return largest_;
    has_largest_ = true;
    for (const RobotShape& shape : shapes_.shapes)
      if (format_ != RobotFormat::mjcf || touches(*shape.element))
        keep_larger(largest_, sized_of(shape.element));
    return largest_;
  }

  /// The smallest of the geoms that a number is for; where they have no size, the largest of the
  /// file.
  const Sized* smallest_of(const std::vector<const XmlElement*>& geoms) {
    const Sized* smallest = nullptr;
    for (const XmlElement* geom : geoms)
      if (const Sized* sized = sized_of(geom))
        if (!smallest || sized->limits.reach_m < smallest->limits.reach_m) smallest = sized;
    return smallest ? smallest : largest();
  }

  void lint_mjcf() {
    // The geoms and pairs that take their friction from an element.
    std::unordered_map<const XmlElement*, std::vector<const XmlElement*>> users;
    std::unordered_map<std::string, const XmlElement*> by_name;
    for (const RobotShape& shape : shapes_.shapes) {
      const XmlElement& geom = *shape.element;
      if (!touches(geom)) continue;
      if (const XmlElement* const source = mjcf_.source(geom, "friction"))
        users[source].push_back(&geom);
      by_name.emplace(geom.value("name"), &geom);
      largest_condim_ = std::max(largest_condim_, condim_of(geom));
    }
    for (const XmlElement* element : file_.elements()) {
      const std::string& kind = element->name;
      const bool is_pair = kind == "pair";
      if ((kind == "geom" || is_pair) && element->attribute("friction")) {
        if (is_pair)
          lint_pair(*element, by_name);
        else
          lint_geom(*element, users[element]);
      }
      if (kind == "option" && element->attribute("o_friction")) {
        const std::vector<Word> words = words_of(element->value("o_friction"));
        for (std::size_t i = 0; i < words.size() && i < 2; ++i)
          judge_friction(
              add(*element, fmt::format("o_friction[{}]", i), "sliding friction", words[i]));
      }
      for (const auto& attribute : element->attributes) {
        const std::string& name = attribute.name;
        if (name.rfind("solimp", 0) == 0 || name == "o_solimp")
          judge_solimp(*element, name, words_of(attribute.value));
        else if (name.rfind("solref", 0) == 0 || name == "o_solref")
          judge_solref(*element, name, words_of(attribute.value));
      }
    }
  }

  int condim_of(const XmlElement& element) const {
    const std::string typed = mjcf_.value(element, "condim");
    return typed.empty() ? 3 : int(value_at(words_of(typed), 0, 3));
  }

  /// @param condim   of the contacts that the number is for
  /// @param others   the largest condim of the geoms that may meet them
  /// @param usual    MuJoCo's default, which says nothing
  static void judge_effect(LintedNumber& number, int condim, int others, int needed, double usual,
                           const char* what) {
    if (number.verdict == LintVerdict::impossible || number.value == 0 || number.value == usual ||
        std::max(condim, others) >= needed)
      return;
    impossible(number,
               fmt::format("it has no effect: condim is {}, and {} friction needs {}{}", condim,
                           what, needed, others > 0 ? ", which no geom of the file has" : ""),
               fmt::format("condim=\"{}\" beside it, or no {} number", needed, what));
  }

  void lint_geom(const XmlElement& element, const std::vector<const XmlElement*>& users) {
    const std::vector<Word> words = words_of(element.value("friction"));
    const Sized* const sized = smallest_of(users);
    int condim = users.empty() && element.attribute("condim") ? condim_of(element) : 0;
    for (const XmlElement* user : users) condim = std::max(condim, condim_of(*user));
    const bool is_used = !users.empty();
    if (!words.empty()) judge_friction(add(element, "friction[0]", "sliding friction", words[0]));
    const double friction = value_at(words, 0, 1);
    if (words.size() > 1) {
      LintedNumber& number = add(element, "friction[1]", "torsional friction, m", words[1]);
      judge_torsional(number, friction, sized);
      if (is_used) judge_effect(number, condim, largest_condim_, 4, 0.005, "torsional");
    }
    if (words.size() > 2) {
      LintedNumber& number = add(element, "friction[2]", "rolling friction, m", words[2]);
      judge_rolling(number, sized);
      if (is_used) judge_effect(number, condim, largest_condim_, 6, 0.0001, "rolling");
    }
  }

  void lint_pair(const XmlElement& pair,
                 const std::unordered_map<std::string, const XmlElement*>& by_name) {
    const std::vector<Word> words = words_of(pair.value("friction"));
    std::vector<const XmlElement*> geoms;
    for (const char* end : {"geom1", "geom2"})
      if (const auto found = by_name.find(pair.value(end)); found != by_name.end())
        geoms.push_back(found->second);
    const Sized* const sized = smallest_of(geoms);
    const int condim = condim_of(pair);
    const double friction = value_at(words, 0, 1);
    for (std::size_t i = 0; i < words.size() && i < 5; ++i) {
      const char* const meaning = i < 2    ? "sliding friction"
                                  : i == 2 ? "torsional friction, m"
                                           : "rolling friction, m";
      LintedNumber& number = add(pair, fmt::format("friction[{}]", i), meaning, words[i]);
      if (i < 2) {
        judge_friction(number);
      } else if (i == 2) {
        judge_torsional(number, friction, sized);
        judge_effect(number, condim, 0, 4, 0.005, "torsional");
      } else {
        judge_rolling(number, sized);
        judge_effect(number, condim, 0, 6, 0.0001, "rolling");
      }
    }
  }

  /// The number of a leaf of URDF or SDF: its text, or the attribute `value`.
  static std::optional<Word> word_of(const XmlElement& element) {
    const std::vector<Word> words =
        words_of(element.attribute("value") ? element.value("value") : element.text);
    if (words.empty()) return std::nullopt;
    return words.front();
  }

  /// The largest shape of the collision or link around an element, or of the link that a <gazebo>
  /// refers to: a number for all of them must fit one.
  const Sized* shape_around(const XmlElement& element) {
    if (by_link_.empty())
      for (const RobotShape& shape : shapes_.shapes) {
        const XmlElement* const link = shape.element->parent;
        by_link_[shape.element].push_back(shape.element);
        by_link_[link].push_back(shape.element);
        by_link_name_[link->value("name")].push_back(shape.element);
      }
    const std::vector<const XmlElement*>* collisions = nullptr;
    for (const XmlElement* at = &element; at && !collisions; at = at->parent) {
      if (const auto found = by_link_.find(at); found != by_link_.end())
        collisions = &found->second;
      else if (at->name == "gazebo")
        collisions = &by_link_name_[at->value("reference")];
    }
    const Sized* kept = nullptr;
    if (collisions)
      for (const XmlElement* collision : *collisions) keep_larger(kept, sized_of(collision));
    return kept;
  }
  static void keep_larger(const Sized*& kept, const Sized* sized) {
    if (sized && (!kept || kept->limits.reach_m < sized->limits.reach_m)) kept = sized;
  }

  /// The sliding friction beside a number, 1 where there is none.
  static double friction_beside(const XmlElement& element) {
    for (const XmlElement* at = element.parent; at; at = at->parent) {
      if (at->name == "link" || at->name == "model" || at->name == "robot") break;
      std::vector<const XmlElement*> open(at->children.begin(), at->children.end());
      for (std::size_t i = 0; i < open.size() && open.size() < 1000; ++i) {
        const std::string& name = open[i]->name;
        if (name == "lateral_friction" || name == "mu" || name == "mu1" ||
            name == "friction_coefficient")
          if (const auto word = word_of(*open[i]); word && word->value > 0) return word->value;
        open.insert(open.end(), open[i]->children.begin(), open[i]->children.end());
      }
    }
    return 1;
  }

  static bool has_parent(const XmlElement& element, const char* name) {
    return element.parent && element.parent->name == name;
  }

  void lint_links() {
    for (const XmlElement* element : file_.elements()) {
      const auto word = word_of(*element);
      if (!word || !element->children.empty()) continue;
      std::string name = element->name;
      if (name.rfind("drake:", 0) == 0) name = name.substr(6);
      const bool is_coulomb =
          name == "mu" || name == "mu1" || name == "mu2" || name == "lateral_friction" ||
          name == "mu_static" || name == "mu_dynamic" ||
          (has_parent(*element, "bullet") && (name == "friction" || name == "friction2"));
      if (is_coulomb) {
        judge_friction(add(*element, element->name, "sliding friction", *word));
      } else if (name == "spinning_friction") {
        judge_torsional(add(*element, element->name, "torsional friction, m", *word),
                        friction_beside(*element), shape_around(*element));
      } else if (name == "rolling_friction") {
        judge_rolling(add(*element, element->name, "rolling friction, m", *word),
                      shape_around(*element));
      } else if (name == "kp" || name == "point_contact_stiffness" ||
                 (name == "stiffness" && has_parent(*element, "contact"))) {
        judge_stiffness(add(*element, element->name, "stiffness, N/m", *word),
                        shape_around(*element));
      } else if (name == "patch_radius") {
        judge_patch(add(*element, element->name, "patch radius, m", *word), shape_around(*element));
      } else if (name == "coefficient" && has_parent(*element, "torsional")) {
        judge_friction(add(*element, element->name, "torsional friction coefficient", *word));
      }
    }
  }

  const XmlFile& file_;
  RobotFormat format_;
  Mjcf mjcf_;
  RobotShapes shapes_;
  LintConditions conditions_;
  const MeshSize& mesh_size_;
  std::unordered_map<const XmlElement*, const RobotShape*> by_element_;
  std::unordered_map<const XmlElement*, std::unique_ptr<Sized>> sized_;
  std::unordered_map<const XmlElement*, std::size_t> order_;
  std::unordered_map<const XmlElement*, std::vector<const XmlElement*>> by_link_;
  std::unordered_map<std::string, std::vector<const XmlElement*>> by_link_name_;
  const Sized* largest_ = nullptr;
  bool has_largest_ = false;
  int largest_condim_ = 0;
  std::vector<LintedNumber> result_;
};

/// The reach of a shape, the largest circle that it holds, its smallest radius, and the lever of
/// uniform pressure on its largest face; 0: that of the circle.
struct Extent {
  double reach_m = 0, circle_m = 0, radius_m = 0, face_lever_m = 0;

  Extent operator()(const std::monostate&) const { return {}; }
  Extent operator()(const NamedMesh&) const { return {}; }
  Extent operator()(const input::Sphere& sphere) const {
    return {sphere.radius_m, sphere.radius_m, sphere.radius_m};
  }
  Extent operator()(const input::Capsule& capsule) const {
    return {capsule.length_m / 2 + capsule.radius_m, capsule.radius_m, capsule.radius_m};
  }
  Extent operator()(const input::Cylinder& cylinder) const {
    return {std::hypot(cylinder.length_m / 2, cylinder.radius_m), cylinder.radius_m,
            cylinder.radius_m};
  }
  Extent operator()(const input::Ellipsoid& ellipsoid) const {
    Vector3d axes = ellipsoid.semi_axes_m;
    std::sort(axes.data(), axes.data() + 3);
    // The sharpest pole: the middle of the radii there is that of the longest axis.
    return {axes[2], axes[1], axes[0] * axes[0] / axes[2]};
  }
  Extent operator()(const input::Box& box) const {
    Vector3d size = box.size_m;
    std::sort(size.data(), size.data() + 3);
    // The circle has the area of the largest face.
    Extent extent{std::hypot(size[1], size[2]) / 2, std::sqrt(size[1] * size[2] / kPi),
                  size[0] / 2};
    if (!(size[1] > 0)) return extent;
    const auto face = ConvexOutline::rounded_rectangle(size[2], size[1]);
    extent.face_lever_m = face.radius_integral_m3(face.centroid_m()) / face.area_m2();
    return extent;
  }
};

}  // namespace

const char* name_of(LintVerdict verdict) {
  return verdict == LintVerdict::impossible ? "impossible"
         : verdict == LintVerdict::doubtful ? "doubtful"
                                            : "possible";
}

std::optional<PadLimits> limits_of(const RobotShape& shape, const LintConditions& conditions,
                                   const MeshSize& mesh_size) {
  Extent extent;
  if (const auto* named = std::get_if<NamedMesh>(&shape.kind)) {
    if (const auto size_m = mesh_size(*named)) extent = Extent()(input::Box{*size_m});
  } else {
    extent = std::visit(Extent(), shape.kind);
  }
  if (!(extent.reach_m > 0) || !std::isfinite(extent.reach_m)) return std::nullopt;
  constexpr double kIncompressible = 0.5;
  const double plane_modulus_Pa =
      conditions.youngs_modulus_Pa / (1 - kIncompressible * kIncompressible);
  const double hertz_m = std::min(
      extent.circle_m, std::cbrt(0.75 * conditions.load_N * extent.radius_m / plane_modulus_Pa));
  PadLimits limits;
  limits.reach_m = extent.reach_m;
  limits.hertz_lever_m = 3 * kPi / 16 * hertz_m;
  limits.uniform_lever_m = std::max(2. / 3 * extent.circle_m, extent.face_lever_m);
  // A round punch's lever over that of uniform pressure is taken for any face.
  limits.punch_lever_m = 3 * kPi / 8 * limits.uniform_lever_m;
  limits.punch_stiffness_N_per_m = 2 * plane_modulus_Pa * extent.circle_m;
  return limits;
}

std::vector<LintedNumber> lint(const XmlFile& file, const LintConditions& conditions,
                               const MeshSize& mesh_size) {
  return Linter(file, conditions, mesh_size).run();
}

}  // namespace softfinger::exporting
