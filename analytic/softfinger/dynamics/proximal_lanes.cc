#include "softfinger/dynamics/proximal_lanes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "softfinger/math/repeat.h"
#include "softfinger/math/wide.h"

namespace softfinger::internal {

class ProximalLanes::Vector {
 public:
  virtual ~Vector() = default;
  virtual void begin_problem(const ContactOperator& contacts, const VelocityFactor& factor) = 0;
  virtual void start(int lane, const Eigen::VectorXd& impulse) = 0;
  virtual void advance() = 0;
  virtual void read_best(int lane, Eigen::VectorXd& impulse) const = 0;
};

namespace {

/// A line of the processor's cache.
struct alignas(64) Line {
  double values[8];
};

constexpr int kRows = 4;      // of a contact: along the normal, two of force, torque
constexpr int kFriction = 3;  // of these
constexpr int kPanel = EliminationPattern::kWidestGroup;

// By reference, because what would return vectors depends on the instructions.

/// sum += a b and sum -= a b, rounded once. A number is that of all lanes: to subtract zero makes a
/// vector of it.
template <class V, class A, class B>
inline void add_product(const A& a, const B& b, V& sum) {
  const V left = a - V{}, right = b - V{}, last = sum;
  V next;
  for (int lane = 0; lane < kWidth<V>; ++lane)
    next[lane] = __builtin_fma(left[lane], right[lane], last[lane]);
  sum = next;
}
template <class V, class A, class B>
inline void subtract_product(const A& a, const B& b, V& sum) {
  const V left = a - V{}, right = b - V{}, last = sum;
  V next;
  for (int lane = 0; lane < kWidth<V>; ++lane)
    next[lane] = __builtin_fma(-left[lane], right[lane], last[lane]);
  sum = next;
}

/// Of three numbers, by one division.
template <class V>
inline void invert(const V& a, const V& b, const V& c, V (&inverse)[kFriction]) {
  const V ab = a * b, of_abc = 1 / (ab * c), of_ab = c * of_abc;
  inverse[0] = b * of_ab;
  inverse[1] = a * of_ab;
  inverse[2] = ab * of_abc;
}

/// kWidth<V> starts.
template <class V>
class LanesOf final : public ProximalLanes::Vector {
 public:
  explicit LanesOf(ProximalLanes::Lane* lanes) : lanes_(lanes) {}

  void begin_problem(const ContactOperator& contacts, const VelocityFactor& factor) override;
  void start(int lane, const Eigen::VectorXd& impulse) override;
  void advance() override;
  void read_best(int lane, Eigen::VectorXd& impulse) const override;

  static std::size_t lines(int contacts, int rank);

 private:
  using Mask = decltype(V{} > V{});

  /// What does not depend on the lane.
  struct Contact {
    bool has_friction;
    double metric[kFriction], inverse_metric[kFriction], least_inverse_metric;
    double free_velocity[kRows];
    double unit;          ///< C of friction
    double inverse_size;  ///< of the natural one
    int columns;          ///< of L_i
    const int* column;
    const double* rows[kRows];  ///< of L_i
  };
  /// The contact's part of F, and of its derivative.
  struct State {
    V map[kRows];
    Mask touches, slides;
    V boundary[kFriction];  ///< grad h(nu)
    V length;               ///< |nu|
  };
  /// What `friction_excess` finds, on the way.
  struct Beyond {
    V velocity[kRows];  ///< of a contact that gives way
    V target[kFriction], radius[kFriction];
    V length, least;  ///< |nu|, and a bound below it
    Mask slides, goes_on;
  };
  static constexpr int kBatch = 4;
  /// That many columns of the matrix at once share what is read for them.
  static constexpr int kColumns = 2;
  /// A^-1 B C and A^-1 of a contact's step: along the normal 1/c; from there to friction `turned`
  /// times that; `stiffness` times C and `inverse` of friction.
  struct Derivative {
    V normal, turned[kFriction], stiffness[kFriction][kFriction], inverse[kFriction][kFriction];
  };

  void move_all();
  void find_velocities();
  void find_map(const Mask& where);
  void find_target(int i, Beyond& beyond);
  void find_lengths(Beyond (&beyond)[kBatch]) const;
  void improve_length(Beyond& beyond) const;
  void finish_map(int i, const Beyond& beyond, const Mask& where);
  void find_derivative(const Contact& contact, int i, Derivative& derivative) const;
  void assemble();
  void eliminate();
  template <int rows>
  void add_contact(const Contact& contact, const Derivative& derivative);
  template <int rows, int count>
  void add_columns(const Contact& contact, const Derivative& derivative, int next);
  template <int width>
  void eliminate_group(int first);
  template <int width, int count>
  void eliminate_columns(V* const (&own)[width], int first, const EliminationPattern::Rows& rows,
                         int next);
  void substitute();
  void move_points();
  void end_points();

  V* element(int row, int column) { return matrix_ + std::size_t(column) * stride_ + row; }
  void load_compliances() {
    for (int lane = 0; lane < kWidth<V>; ++lane) compliance_[lane] = lanes_[lane].course.compliance;
  }
  void load_running(Mask& running) const {
    for (int lane = 0; lane < kWidth<V>; ++lane) running[lane] = lanes_[lane].is_running ? -1 : 0;
  }

  ProximalLanes::Lane* lanes_;
  const EliminationPattern* pattern_ = nullptr;
  std::vector<Contact> contacts_;
  int rank_ = 0;
  std::size_t stride_ = 0;
  std::vector<Line> memory_;
  // By rows of the contacts: where Newton's steps are, r0, the last proximal point, how it differs
  // from the one before, the best point, u.
  V *point_ = nullptr, *centre_ = nullptr, *reached_ = nullptr, *move_ = nullptr, *best_ = nullptr,
    *velocity_ = nullptr;
  V* common_ = nullptr;  ///< y
  V* matrix_ = nullptr;  ///< of y
  V* panel_ = nullptr;   ///< of a group's columns, row by row
  State* states_ = nullptr;
  V compliance_ = {}, size_ = {};
};

template <class V>
std::size_t LanesOf<V>::lines(int contacts, int rank) {
  constexpr std::size_t kPerLine = sizeof(Line) / sizeof(V);
  const std::size_t n = std::size_t(contacts), r = std::size_t(rank);
  const std::size_t vectors =
      (6 * kRows + sizeof(State) / sizeof(V)) * n + (1 + kPanel) * r + r * (r | 1);
  return vectors / kPerLine + 1;
}

template <class V>
void LanesOf<V>::begin_problem(const ContactOperator& contacts, const VelocityFactor& factor) {
  pattern_ = &factor.pattern();
  const int nc = contacts.contacts();
  rank_ = factor.rank();
  stride_ =
      std::size_t(rank_) | 1;  // odd, so that a row's elements do not share a set of the cache
  contacts_.resize(std::size_t(nc));
  for (int i = 0; i < nc; ++i) {
    Contact& contact = contacts_[std::size_t(i)];
    contact.has_friction = contacts.has_friction(i);
    Eigen::Vector3d::Map(contact.metric) = contacts.friction_metric(i);
    Eigen::Vector3d::Map(contact.inverse_metric) = contacts.friction_metric(i).cwiseInverse();
    contact.least_inverse_metric = 1 / contacts.friction_metric(i).maxCoeff();
    Eigen::Vector4d::Map(contact.free_velocity) = contacts.free_velocity().segment<4>(4 * i);
    contact.unit = factor.unit(i)[1];
    contact.inverse_size = 1 / contacts.natural_size(i);
    contact.columns = factor.rows().column_count(i);
    contact.column = factor.rows().columns(i);
    for (int row = 0; row < kRows; ++row)
      contact.rows[row] = factor.rows().values(i) + row * contact.columns;
  }
  const std::size_t needed = lines(nc, rank_);
  if (memory_.size() < needed) memory_.resize(needed);
  V* next = reinterpret_cast<V*>(memory_.data());
  for (V** part : {&point_, &centre_, &reached_, &move_, &best_, &velocity_}) {
    *part = next;
    next += kRows * nc;
  }
  states_ = reinterpret_cast<State*>(next);
  next += sizeof(State) / sizeof(V) * std::size_t(nc);
  common_ = next;
  panel_ = common_ + rank_;
  matrix_ = panel_ + kPanel * rank_;
  std::fill(memory_.begin(), memory_.end(), Line{});
}

template <class V>
void LanesOf<V>::start(int lane, const Eigen::VectorXd& impulse) {
  for (int row = 0; row < kRows * int(contacts_.size()); ++row) {
    point_[row][lane] = centre_[row][lane] = reached_[row][lane] = best_[row][lane] = impulse[row];
    move_[row][lane] = 0;
  }
  for (int i = 0; i < int(contacts_.size()); ++i) states_[i].length[lane] = 0;
}

template <class V>
void LanesOf<V>::read_best(int lane, Eigen::VectorXd& impulse) const {
  for (int row = 0; row < kRows * int(contacts_.size()); ++row) impulse[row] = best_[row][lane];
}

template <class V>
void LanesOf<V>::advance() {
  const auto move = [this] { move_all(); };
  if constexpr (kWidth<V> == kEight)
    with_widest_instructions(move);
  else
    with_best_instructions(move);
}

template <class V>
void LanesOf<V>::move_all() {
  load_compliances();
  Mask all = {}, news = {};
  for (int k = 0; k < kWidth<V>; ++k) {
    all[k] = -1;
    news[k] = lanes_[k].is_new ? -1 : 0;
  }
  if (has_any(news)) {
    find_velocities();
    find_map(news);
    for (int k = 0; k < kWidth<V>; ++k) {
      if (lanes_[k].is_new) lanes_[k].course.begin(size_[k]);
      lanes_[k].is_new = false;
    }
  }
  assemble();
  eliminate();
  substitute();
  move_points();
  find_velocities();
  find_map(all);
  end_points();
}

/// u = C L L^T r + v_free
template <class V>
void LanesOf<V>::find_velocities() {
  std::fill(common_, common_ + rank_, V{});
  const V* r = point_;
  for (const Contact& contact : contacts_) {
    const auto& l = contact.rows;
    for (int k = 0; k < contact.columns; ++k) {
      V& y = common_[contact.column[k]];
      for (int row = 0; row < kRows; ++row) add_product(l[row][k], r[row], y);
    }
    r += kRows;
  }
  V* u = velocity_;
  for (const Contact& contact : contacts_) {
    const auto& l = contact.rows;
    V sum[kRows] = {};
    for (int k = 0; k < contact.columns; ++k)
      for (int row = 0; row < kRows; ++row)
        add_product(l[row][k], common_[contact.column[k]], sum[row]);
    u[0] = sum[0] + contact.free_velocity[0];
    for (int row = 1; row < kRows; ++row)
      u[row] = contact.unit * sum[row] + contact.free_velocity[row];
    u += kRows;
  }
}

/// F at point_ from velocity_, and its size, in the lanes `where`; the others stay as they are to
/// the last bit. A few contacts at a time: each waits for its own divisions
/// and roots, and the processor has others to go on with.
template <class V>
void LanesOf<V>::find_map(const Mask& where) {
  size_ = V{};
  const int nc = int(contacts_.size());
  for (int first = 0; first < nc; first += kBatch) {
    const int count = std::min(kBatch, nc - first);
    Beyond beyond[kBatch] = {};
    for (int k = 0; k < count; ++k) find_target(first + k, beyond[k]);
    find_lengths(beyond);
    for (int k = 0; k < count; ++k) finish_map(first + k, beyond[k], where);
  }
}

/// See ExactNewton::find_map.
template <class V>
void LanesOf<V>::find_target(int i, Beyond& beyond) {
  const Contact& contact = contacts_[std::size_t(i)];
  const V *own = point_ + kRows * i, *centre = centre_ + kRows * i, *u = velocity_ + kRows * i;
  beyond.velocity[0] = u[0] + compliance_ * (own[0] - centre[0]);
  if (!contact.has_friction) return;
  const V limit = own[0] > 0 ? own[0] : V{}, inverse_limit = 1 / limit;
  V squares = {}, gauge = {}, mean = {};
  for (int k = 0; k < kFriction; ++k) {
    beyond.velocity[k + 1] =
        u[k + 1] + contact.metric[k] * (compliance_ * (own[k + 1] - centre[k + 1]));
    const V target = contact.metric[k] * own[k + 1] - beyond.velocity[k + 1];
    beyond.target[k] = target;
    beyond.radius[k] = contact.metric[k] * limit;
    squares = squares + target * target;
    mean = mean + target * target * beyond.radius[k];
    const V part = target * (contact.inverse_metric[k] * inverse_limit);
    gauge = gauge + part * part;
  }
  V reach = squares;
  take_root(reach, reach);
  beyond.slides = (squares > 0) & ~((limit > 0) & (gauge <= 1));
  beyond.goes_on = beyond.slides & (limit > 0);
  const V least = reach - mean / squares;
  beyond.least = least > 0 ? least : V{};
  const V& last = states_[i].length;
  const V length = last > beyond.least ? last : beyond.least;
  beyond.length = beyond.goes_on ? length : reach;
}

/// As `excess_length` of friction_shape.cc, but from the last length, if there is one: from above,
/// Newton's first step leads below, because the function is concave.
template <class V>
void LanesOf<V>::find_lengths(Beyond (&beyond)[kBatch]) const {
  constexpr int kUsualIterations = 3, kMostIterations = 60;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    Mask goes_on = {};
    for (Beyond& one : beyond) {
      improve_length(one);
      goes_on = goes_on | one.goes_on;
    }
    // Most need no more, and the processor need not guess whether they do.
    if (iteration + 1 >= kUsualIterations && !has_any(goes_on)) return;
  }
}

template <class V>
void LanesOf<V>::improve_length(Beyond& beyond) const {
  constexpr double kSmall = 1e-8;  // of the length: the next step is its square
  V inverse[kFriction], sum = {}, slope = {};
  invert(beyond.radius[0] + beyond.length, beyond.radius[1] + beyond.length,
         beyond.radius[2] + beyond.length, inverse);
  for (int k = 0; k < kFriction; ++k) {
    const V ratio = beyond.target[k] * inverse[k], square = ratio * ratio;
    sum = sum + square;
    slope = slope + square * inverse[k];
  }
  V root = sum;
  take_root(root, root);
  const V step = (root - 1) * sum / slope;
  V next = beyond.length + step;
  next = next > beyond.least ? next : beyond.least;
  beyond.length = beyond.goes_on ? next : beyond.length;
  const V size = step < 0 ? -step : step;
  beyond.goes_on = beyond.goes_on & (size > kSmall * next);
}

template <class V>
void LanesOf<V>::finish_map(int i, const Beyond& beyond, const Mask& where) {
  const Contact& contact = contacts_[std::size_t(i)];
  State& state = states_[i];
  const V& pressure = point_[kRows * i];
  const Mask touches = pressure > beyond.velocity[0];
  const V normal = touches ? beyond.velocity[0] : pressure;
  state.touches = where ? touches : state.touches;
  state.map[0] = where ? normal : state.map[0];
  V size = normal < 0 ? -normal : normal;
  if (contact.has_friction) {
    const Mask slides = beyond.slides & (beyond.length > 0);
    const V length = slides ? beyond.length : V{};
    state.slides = where ? slides : state.slides;
    state.length = where ? length : state.length;
    V direction[kFriction], norm = {};
    invert(beyond.radius[0] + length, beyond.radius[1] + length, beyond.radius[2] + length,
           direction);
    for (int k = 0; k < kFriction; ++k) {
      direction[k] = beyond.target[k] * direction[k];
      norm = norm + direction[k] * direction[k];
    }
    take_root(norm, norm);
    const V limit = pressure > 0 ? pressure : V{};
    const V inverse = 1 / norm, weight = 1 / (limit + length * contact.least_inverse_metric);
    for (int k = 0; k < kFriction; ++k) {
      const V boundary = slides ? direction[k] * inverse : V{};
      const V map = beyond.velocity[k + 1] + length * boundary;
      state.boundary[k] = where ? boundary : state.boundary[k];
      state.map[k + 1] = where ? map : state.map[k + 1];
      V part = map < 0 ? -map : map;
      part = slides ? part * ((limit + length * contact.inverse_metric[k]) * weight) : part;
      size = part <= size ? size : part;
    }
  }
  size = size * contact.inverse_size;
  // What is not a number stays.
  size_ = size <= size_ ? size_ : size;
}

/// With q = c P/|nu|, h = 1/(1 + q A), b = grad h(nu) and g = h b, that of a contact that slides is
///   A_t^-1 = h/A + q g g^T/s + K,  K = A_t^-1 B_t = P/|nu| (h - g g^T/s),  s = g^T b,
/// and the part of its friction that follows the normal impulse g/s. (Sherman, Morrison.)
template <class V>
void LanesOf<V>::find_derivative(const Contact& contact, int i, Derivative& derivative) const {
  const State& state = states_[i];
  const V none = {}, inverse_compliance = 1 / compliance_;
  derivative.normal = state.touches ? inverse_compliance : none;
  if (!contact.has_friction) return;
  const V pressure = point_[kRows * i] > 0 ? point_[kRows * i] : none;
  const V ratio = state.slides ? pressure / state.length : none, q = compliance_ * ratio;
  V h[kFriction], g[kFriction], s = {};
  invert(1 + q * contact.metric[0], 1 + q * contact.metric[1], 1 + q * contact.metric[2], h);
  for (int k = 0; k < kFriction; ++k) {
    g[k] = h[k] * state.boundary[k];
    s = s + g[k] * state.boundary[k];
  }
  const V inverse_s = 1 / s;
  const Mask slides = state.touches & state.slides, sticks = state.touches & ~state.slides;
  for (int k = 0; k < kFriction; ++k) {
    const double inverse_metric = contact.inverse_metric[k];
    derivative.turned[k] = slides ? g[k] * inverse_s : none;
    for (int j = 0; j < kFriction; ++j) {
      const V both = g[k] * g[j] * inverse_s, own = j == k ? h[k] : none;
      const V slipping = ratio * (own - both);
      const V sticking = j == k ? inverse_metric * inverse_compliance : none;
      derivative.stiffness[k][j] = slides ? slipping : sticks ? sticking : none;
      derivative.inverse[k][j] = slides   ? slipping + (inverse_metric * own + q * both)
                                 : sticks ? sticking
                                          : none;
    }
  }
}

/// The matrix of y, and in common_ its right side.
template <class V>
void LanesOf<V>::assemble() {
  for (int column = 0; column < rank_; ++column) {
    *element(column, column) = V{} + 1;
    common_[column] = V{};
    const EliminationPattern::Rows rows = pattern_->rows(column);
    for (int a = 0; a < rows.count; ++a)
      *element(rows.first[a], column) = *element(column, rows.first[a]) = V{};
  }
  Derivative derivative;
  for (int i = 0; i < int(contacts_.size()); ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    const State& state = states_[i];
    const V* own = point_ + kRows * i;
    find_derivative(contact, i, derivative);
    const int rows = contact.has_friction ? kRows : 1;
    V right[kRows];
    const V normal = -derivative.normal * state.map[0];
    right[0] = state.touches ? normal : -own[0];
    for (int row = 1; row < rows; ++row) {
      V sum = derivative.turned[row - 1] * normal;
      for (int k = 0; k < kFriction; ++k)
        sum = sum - derivative.inverse[row - 1][k] * state.map[k + 1];
      right[row] = state.touches ? sum : -own[row];
    }
    for (int a = 0; a < contact.columns; ++a) {
      V side = common_[contact.column[a]];
      for (int row = 0; row < rows; ++row) add_product(contact.rows[row][a], right[row], side);
      common_[contact.column[a]] = side;
    }
    if (!has_any(state.touches)) continue;
    if (contact.has_friction)
      add_contact<kRows>(contact, derivative);
    else
      add_contact<1>(contact, derivative);
  }
}

/// The part of a contact with so many rows.
template <class V>
template <int rows>
void LanesOf<V>::add_contact(const Contact& contact, const Derivative& derivative) {
  int next = 0;
  for (; next + kColumns <= contact.columns; next += kColumns)
    add_columns<rows, kColumns>(contact, derivative, next);
  for (; next < contact.columns; ++next) add_columns<rows, 1>(contact, derivative, next);
}

/// The contact's part of `count` of its columns, from its column `next` on.
template <class V>
template <int rows, int count>
void LanesOf<V>::add_columns(const Contact& contact, const Derivative& derivative, int next) {
  const auto& l = contact.rows;
  V *columns[count], stiff[count][rows];
  for (int c = 0; c < count; ++c) {
    columns[c] = element(0, contact.column[next + c]);
    V& normal = stiff[c][0];
    normal = derivative.normal * l[0][next + c];
    repeat<rows - 1>([&](int row) {
      V own = {};
      repeat<kFriction>(
          [&](int k) { add_product(derivative.stiffness[row][k], l[k + 1][next + c], own); });
      own = contact.unit * own;
      add_product(derivative.turned[row], normal, own);
      stiff[c][row + 1] = own;
    });
  }
  for (int b = 0; b < contact.columns; ++b) {
    const int at = contact.column[b];
    V values[count];
    repeat<count>([&](int c) { values[c] = columns[c][at]; });
    repeat<rows>([&](int row) {
      repeat<count>([&](int c) { add_product(l[row][b], stiff[c][row], values[c]); });
    });
    repeat<count>([&](int c) { columns[c][at] = values[c]; });
  }
}

/// The matrix becomes L_M below its diagonal and U_M, whose diagonal is inverted; common_ becomes
/// L_M^-1 common_.
template <class V>
void LanesOf<V>::eliminate() {
  static_assert(kPanel == 6);
  for (int first = 0; first < rank_; first += pattern_->width(first)) {
    switch (pattern_->width(first)) {
      case 1:
        eliminate_group<1>(first);
        break;
      case 2:
        eliminate_group<2>(first);
        break;
      case 3:
        eliminate_group<3>(first);
        break;
      case 4:
        eliminate_group<4>(first);
        break;
      case 5:
        eliminate_group<5>(first);
        break;
      default:
        eliminate_group<6>(first);
        break;
    }
  }
}

template <class V>
template <int width>
void LanesOf<V>::eliminate_group(int first) {
  V *own[width], *y = common_ + first;
  for (int p = 0; p < width; ++p) own[p] = element(0, first + p);
  for (int p = 0; p < width; ++p) {
    V& pivot = own[p][first + p];
    pivot = 1 / pivot;
    for (int row = p + 1; row < width; ++row) {
      V& factor = own[p][first + row];
      factor = factor * pivot;
      for (int q = p + 1; q < width; ++q)
        subtract_product(factor, own[q][first + p], own[q][first + row]);
      subtract_product(factor, y[p], y[row]);
    }
  }
  const EliminationPattern::Rows rows = pattern_->rows(first + width - 1);
  for (int a = 0; a < rows.count; ++a) {
    const int row = rows.first[a];
    V factors[width], side = common_[row];
    repeat<width>([&](int p) {
      V value = own[p][row];
      for (int q = 0; q < p; ++q) subtract_product(factors[q], own[p][first + q], value);
      factors[p] = value * own[p][first + p];
      own[p][row] = panel_[width * a + p] = factors[p];
      subtract_product(factors[p], y[p], side);
    });
    common_[row] = side;
  }
  int next = 0;
  for (; next + kColumns <= rows.count; next += kColumns)
    eliminate_columns<width, kColumns>(own, first, rows, next);
  for (; next < rows.count; ++next) eliminate_columns<width, 1>(own, first, rows, next);
}

/// `count` of the columns that the group `own` meets, from the one of `rows.first[next]` on.
template <class V>
template <int width, int count>
void LanesOf<V>::eliminate_columns(V* const (&own)[width], int first,
                                   const EliminationPattern::Rows& rows, int next) {
  V *columns[count], above[count][width];
  repeat<count>([&](int c) {
    columns[c] = element(0, rows.first[next + c]);
    repeat<width>([&](int p) {
      V value = columns[c][first + p];
      for (int q = 0; q < p; ++q) subtract_product(own[q][first + p], above[c][q], value);
      columns[c][first + p] = above[c][p] = value;
    });
  });
  for (int a = 0; a < rows.count; ++a) {
    const int row = rows.first[a];
    const V* factors = panel_ + width * a;
    V values[count];
    repeat<count>([&](int c) { values[c] = columns[c][row]; });
    repeat<width>([&](int p) {
      repeat<count>([&](int c) { subtract_product(factors[p], above[c][p], values[c]); });
    });
    repeat<count>([&](int c) { columns[c][row] = values[c]; });
  }
}

/// common_ = y
template <class V>
void LanesOf<V>::substitute() {
  for (int k = rank_ - 1; k >= 0; --k) {
    const EliminationPattern::Rows rows = pattern_->rows(k);
    V sum = common_[k];
    for (int a = 0; a < rows.count; ++a)
      subtract_product(*element(k, rows.first[a]), common_[rows.first[a]], sum);
    common_[k] = sum * *element(k, k);
  }
}

/// Newton's step, in lanes that run.
template <class V>
void LanesOf<V>::move_points() {
  Mask running = {};
  load_running(running);
  Derivative derivative;
  for (int i = 0; i < int(contacts_.size()); ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    const State& state = states_[i];
    find_derivative(contact, i, derivative);
    V* own = point_ + kRows * i;
    V velocity[kRows] = {};
    for (int k = 0; k < contact.columns; ++k)
      for (int row = 0; row < kRows; ++row)
        add_product(contact.rows[row][k], common_[contact.column[k]], velocity[row]);
    const V normal = -derivative.normal * (state.map[0] + velocity[0]);
    for (int row = 1; row < (contact.has_friction ? kRows : 1); ++row) {
      V step = derivative.turned[row - 1] * normal;
      for (int k = 0; k < kFriction; ++k)
        step = step - (derivative.inverse[row - 1][k] * state.map[k + 1] +
                       derivative.stiffness[row - 1][k] * (contact.unit * velocity[k + 1]));
      const V next = state.touches ? own[row] + step : V{};
      own[row] = running ? next : own[row];
    }
    const V next = state.touches ? own[0] + normal : V{};
    own[0] = running ? next : own[0];
  }
}

/// Lanes whose steps have ended begin the next proximal point, or do not run any more.
template <class V>
void LanesOf<V>::end_points() {
  using Progress = ProximalCourse::Progress;
  const int n = kRows * int(contacts_.size());
  Progress progress[kWidth<V>];
  Mask ends = {}, reaches = {};
  for (int k = 0; k < kWidth<V>; ++k) {
    progress[k] = lanes_[k].is_running ? lanes_[k].course.take_step(size_[k]) : Progress::going;
    ends[k] = progress[k] != Progress::going ? -1 : 0;
    reaches[k] = progress[k] == Progress::reached ? -1 : 0;
  }
  if (!has_any(ends)) return;

  V product = {}, lengths[2] = {};
  for (int row = 0; row < n; ++row) {
    const V move = point_[row] - reached_[row];
    product = product + move * move_[row];
    lengths[0] = lengths[0] + move * move;
    lengths[1] = lengths[1] + move_[row] * move_[row];
    move_[row] = reaches ? move : move_[row];
    reached_[row] = reaches ? point_[row] : reached_[row];
    point_[row] = ends ? reached_[row] : point_[row];
    centre_[row] = ends ? reached_[row] : centre_[row];
  }
  for (int k = 0; k < kWidth<V>; ++k) {
    const double both = std::sqrt(lengths[0][k]) * std::sqrt(lengths[1][k]);
    if (progress[k] == Progress::reached)
      lanes_[k].course.reach(both > 0 ? product[k] / both : 0);
    else if (progress[k] == Progress::failed)
      lanes_[k].course.fail();
  }
  load_compliances();
  find_velocities();
  find_map(ends);

  V stride = {};
  Mask betters = {}, strides = {};
  for (int k = 0; k < kWidth<V>; ++k) {
    if (progress[k] == Progress::going) continue;
    betters[k] = lanes_[k].course.arrive(size_[k]) ? -1 : 0;
    stride[k] = lanes_[k].course.stride - 1;
    strides[k] = stride[k] > 0 ? -1 : 0;
  }
  const bool has_strides = has_any(strides);
  for (int row = 0; row < n; ++row) {
    best_[row] = betters ? point_[row] : best_[row];
    if (!has_strides) continue;
    const V ahead = centre_[row] + stride * move_[row];
    centre_[row] = strides ? ahead : centre_[row];
    point_[row] = strides ? ahead : point_[row];
  }
  if (has_strides) {
    find_velocities();
    find_map(strides);
  }
  for (int k = 0; k < kWidth<V>; ++k) {
    if (progress[k] == Progress::going) continue;
    if (strides[k]) lanes_[k].course.residual = size_[k];
    lanes_[k].is_running = lanes_[k].course.goes_on(lanes_[k].most_iterations);
  }
}

}  // namespace

ProximalLanes::ProximalLanes() {
  if (has_widest_instructions) {
    vectors_.push_back(std::make_unique<LanesOf<Eight>>(lanes_));
  } else {
    for (int first = 0; first < kLanes; first += kFour)
      vectors_.push_back(std::make_unique<LanesOf<Four>>(lanes_ + first));
  }
}

ProximalLanes::~ProximalLanes() = default;

void ProximalLanes::begin_problem(const ContactOperator& contacts, const VelocityFactor& factor) {
  for (Lane& lane : lanes_) lane = {};
  for (const auto& vector : vectors_) vector->begin_problem(contacts, factor);
}

double ProximalLanes::memory(int contacts, int rank) {
  return double(sizeof(Line) * LanesOf<Eight>::lines(contacts, rank));
}

void ProximalLanes::start(int lane, const Eigen::VectorXd& impulse, int most_iterations) {
  const int width = kLanes / int(vectors_.size());
  lanes_[lane] = {true, true, most_iterations, {}};
  vectors_[std::size_t(lane / width)]->start(lane % width, impulse);
}

void ProximalLanes::advance() {
  for (const auto& vector : vectors_) vector->advance();
}

void ProximalLanes::read_best(int lane, Eigen::VectorXd& impulse) const {
  const int width = kLanes / int(vectors_.size());
  vectors_[std::size_t(lane / width)]->read_best(lane % width, impulse);
}

}  // namespace softfinger::internal
