#pragma once

#include <array>
#include <limits>

#include "fem/problem/result.h"

/// The errors that the solvers state, from the answers of two levels by plain numbers. Relative, at
/// about 95 % confidence.
///
/// Two levels that agree are no proof: what refining the contact does not change is not in their
/// difference. So every stated error is
///   |coarse - fine| / |fine| / (r^q - 1) + constants,
/// r the ratio of their elements per semi-axis, q a cautious order of convergence (Richardson
/// extrapolation of the finer answer), and the constants what both levels miss alike. All constants
/// stand in the tables below; docs/measurements/finite_elements.md says what they were measured
/// against.
namespace softfinger::fem {

/// All quantities that have an error.
constexpr std::array<double RelativeError::*, 7> relative_errors{&RelativeError::a,
                                                                 &RelativeError::b,
                                                                 &RelativeError::area,
                                                                 &RelativeError::indentation,
                                                                 &RelativeError::peak_pressure,
                                                                 &RelativeError::max_torque,
                                                                 &RelativeError::load};

/// The error of one kind of quantity.
struct ErrorConstants {
  double order;   ///< q, at most the order observed
  double common;  ///< missed by both levels of every contact
  /// On the mesh of a larger contact the edge lies across cells, and there are fewer: missed where
  /// a cell is an eighth of the semi-axis; otherwise it goes with the cell's square. Measured for
  /// contacts 1.05 to 2 times smaller than their mesh's, nu 0 and 0.3, a/h 0.1 to 5.
  double across = 0;
  /// Missed on coarse levels: with four elements per semi-axis, and the power of the cell with
  /// which it falls. Where four elements are the only ones too few, because level 0 has three, a
  /// high one.
  double coarse = 0, coarse_order = 2;
};

/// If no smooth pressure fits, the edge is known from the nodes that touch: up to a share of a
/// cell, by how it happens to lie between them.
struct OutlineScatter {
  double axes;    ///< of a and b, in cells
  double radius;  ///< of the radius of a circle of the same area, in cells
};

/// When the edge of the stuck contact is taken to lie between the nodes of both levels.
struct StuckEdge {
  bool without_symmetry;  ///< in every contact without symmetry
  double largest_misfit;  ///< else where contact and mesh differ by more than this share in size
};

/// Constants of the error estimate for one kind of physics.
struct ErrorTable {
  ErrorConstants integral;  ///< approach, load, torque
  ErrorConstants edge;      ///< a, b
  ErrorConstants area, peak;
  OutlineScatter outline;
  double unresolved_edge;  ///< of a, b: see `unresolved_edge` below
  double cells_away;       ///< of the approach of a long contact: see `cells_away` below
  /// Both levels may miss so much of the approach and twice that of the load, by the load steps and
  /// by the edge of what sticks.
  double load_steps;
  StuckEdge stuck_edge;
};

/// Contacts of one size are given the very same mesh: sizes are rounded to 0.1 %. A contact that
/// differs from its mesh by more than twice that has its edge between the mesh's lines.
constexpr double edge_on_cells = 2e-3;

constexpr ErrorTable linear_elasticity{
    // Observed order 2 to 3. Common: the mesh away from the contact. Coarse: against level 4, with
    // nu from 0 to 1/2, a/h from 0.2 to 7 and R'/R'' to 7, level 1 was up to 0.04 % farther off in
    // d, 0.2 % in the torque, 0.2 % in b, 0.5 % in the peak than without it.
    /*integral*/ {1.6, 1e-4, 2e-4, 5e-4, 4},
    // The edge is found to a fraction of a cell: observed order 1 to 2, not always of one sign.
    // Common: the shape that is fitted to the pressure.
    /*edge*/ {1, 1e-3, 1.5e-3, 2e-3, 4},
    /*area*/ {1, 1e-3, 1.5e-3, 4e-3, 4},
    /*peak*/ {1, 2e-3, 2e-3, 5e-3, 4},
    // 95 % of 40 turned ellipses (a/b 1 to 2, nu 0.3 to 0.49, a/h 0.4 to 2.5, flat and on spheres
    // of 3 to 20 h) on level 2, against the fit of the same contact's quarter on level 3. Median:
    // 0.011 and 0.007 cells.
    /*outline*/ {0.034, 0.021},
    /*unresolved_edge*/ 0.2,
    /*cells_away*/ 6e-4,
    // Level 2, in d: on 36 round contacts, nu 0.3 to 0.49, a/h 0.5 to 3, mu 0.1 to no slip, 0.02 %
    // in the median, but 0.26 % on a thin layer that sticks, where 0.10 % would be stated.
    /*load_steps*/ 1e-3,
    // The extrapolation's own correction covers the misfit of the trial mesh: stated up to 3.7 %,
    // true 1.3 %.
    {/*without_symmetry*/ false, std::numeric_limits<double>::infinity()}};

constexpr ErrorTable finite_strain{
    // As in linear elasticity. Meshes are not shared: no edge lies across cells. Coarse: against
    // the axisymmetric references of thin and thick fingers (h/R 0.2 and 0.4, d/h 0.05 to 0.4) on
    // level 1 a was 0.3 to 1.0 % large, the area up to 1.6 %, d and torque 0.07 and 0.2 % off.
    /*integral*/ {1.6, 1e-4, 0, 2e-4},
    /*edge*/ {1, 1e-3, 0, 6e-3},
    /*area*/ {1, 2e-3, 0, 1e-2},
    // The fit of a strongly deformed contact: its peak was 0.3 % low, up to 0.5 %, on the finer of
    // two levels that agreed to 0.2 % (level 2, d/h from 0.05 to 0.4).
    /*peak*/ {1, 4e-3},
    // As in linear elasticity.
    /*outline*/ {0.034, 0.021},
    // Neither was measured at finite strain.
    /*unresolved_edge*/ 0,
    /*cells_away*/ 0,
    // On nine spheres, d/h 0.02 to 0.35, up to 0.11 % in d, where 0.05 % would be stated. Level 2
    // with the drag of level 1, on 21 fingers (nu 0.3 to 0.499, d/h 0.1 to 0.4, mu 0.1 to no slip)
    // against load steps on level 2: 0.03 % in the median, up to 0.13 %.
    /*load_steps*/ 1.5e-3,
    // The stiffness was 5 % off at n = 8, 14 % at n = 4, where a ring of nodes was missing.
    {/*without_symmetry*/ true, edge_on_cells}};

/// Pressing with friction: the ring where slip turns into stick converges to the first order.
constexpr double order_of_rubbed_pressing = 1;
/// Stick leaves a cusp in the middle of the pressure where the surface would slip inwards, which a
/// smooth fit rounds off: by 0.9 to 2.1 % at nu = 0.3, a/h = 0.5. It goes with the coupling of
/// normal and tangential displacements, Dundurs' (1 - 2 nu)/(2 (1 - nu)).
constexpr double rounded_cusp = 0.055;

/// Friction, of both physics. Order of the integrals as above; common: the friction problem's mesh.
constexpr ErrorConstants friction_integral{1.6, 2e-4};
/// Tractions of a stuck contact grow without bound at its edge, as one over a root: a node more or
/// less there counts. Observed order on six layers: 1.3 to 1.6. Coarse: two levels of three and
/// four elements may agree by chance: of eleven ellipses (R'/R'' 1.5 to 7) five were 3 to 12 % off
/// on level 1, 2.6 to 5.1 % more than was stated without it.
constexpr ErrorConstants stuck_stiffness{1.45, 1e-3, 0, 5.2e-2};
/// The stiffness before slip is proportional to the third power of the contact's radius. Where the
/// edge lies between the nodes of both levels, this radius is known to a quarter of a cell.
/// (Measured on a user's own mesh: the stiffness was 4 % off.)
constexpr double stuck_edge_cells = 3 * 0.25;

/// Elements per semi-axis, fine over coarse.
double refinement_of(const LevelResult& coarse, const LevelResult& fine);

/// @param difference  of the two levels, relative
/// @param elements    per semi-axis, of the finer one
double stated_error(double difference, double refinement, const ErrorConstants& constants,
                    double crossed_cells = 0, int elements = 4);

/// (cell / (a/8))² where the edge of a contact lies across the cells of a larger contact's mesh,
/// which miss it to the second order; 0 on a mesh of its own.
double crossed_cells(const LevelResult& level);

/// Error of a and b where cells are not small against the thickness: weight (cell/h)³ h/b. The
/// pressure falls to zero within about h from the edge, which both levels may fail to resolve.
/// Measured on thin layers: 0.3 % at cells of 0.8 h, b = 20 h.
double unresolved_edge(const LevelResult& fine, double thickness_m, double weight);

/// Error of the approach of a long contact that is small against the thickness. It comes from the
/// cells away from the contact. Both levels have the same ones, so that their difference does not
/// contain it: `largest` up to s = sqrt(ab)/h = 0.1, then `largest` 0.1/s.
/// Measured against a spectral solver on 297 contacts, R'/R'' 2 to 10, s from 0.06 to 8: 0.08 % at
/// s = 0.06, 0.04 % at 0.17. Circular contacts, whose cells are cubes, lose 0.02 %: 0 for a <= 1.02
/// b.
/// Sublayers: 0.05 % at s = 0.15, on round contacts too.
double cells_away(const LevelResult& fine, double thickness_m, bool layered, double largest);

/// Error of the approach and the torque on a scan, whose surroundings have larger cells: 1e-3 and
/// 5e-4 up to s = 0.1 and 0.5, falling with 1/s.
double cells_on_scan(const LevelResult& fine, double thickness_m, double largest, double up_to);

/// Error of what an outline tells that scatters on each level by itself. A difference that such
/// scatter explains says nothing; what exceeds it is extrapolated to the first order.
/// @param coarse,fine  scatter of the two levels, relative
double outline_error(double difference, double coarse, double fine, double refinement);

/// Share of the wall's correction, half of the difference between a free and a clamped wall, that
/// is stated. Their mean is nearly exact: on 24 flat layers whose wall stood at a + h to a + 3.5 h
/// (nu 0 to 0.499, a/h 0.4 to 4, a/b to 3.5), against a wall at a + 8 h, 0 to 0.2 of the
/// correction were missed in d where it exceeded 0.2 %, at most 0.33 where it was 0.17 %.
constexpr double missed_of_wall = 0.4;

/// Properties of a contact that its error depends on, besides the two levels.
struct ErrorSetting {
  double thickness_m = 0;
  bool fitted = true;    ///< the edge is that of a fitted pressure
  bool layered = false;  ///< of several sublayers
  bool is_scan = false;
  bool approach_given = false;  ///< by the user, in place of the load
  WallChange wall;              ///< half the difference of a clamped wall, 0 where it is far away
  bool rounded_edges = false;   ///< the object's facets are replaced by a smooth surface
  /// The meshes were made for the largest contact of a history, and have fewer elements for a
  /// smaller one.
  bool in_time = false;
  /// The contact is pressed with friction; Dundurs' coupling of its surface.
  bool rubbed = false;
  double coupling = 0;
};

/// Change of a contact by elements whose Poisson's ratio is a little below the layer's 1/2.
/// Measured on linear layers that stick, nu 0.4999 in place of 0.5, a/h 2.4 to 5.9: 1.5 to 2.1
/// ab/h² times the difference in d, at most 0.6 in a, 1.2 in the peak and 0.3 in the torque.
/// @param compressed  by how much it is below
RelativeError error_of_compressing(const LevelResult& contact, double thickness_m,
                                   double compressed);

/// Error by the meshes alone, without the parts that the kind of contact adds.
/// @pre the fine level has more elements per semi-axis than the coarse one
RelativeError error_of_levels(const ErrorTable& table, const LevelResult& coarse,
                              const LevelResult& fine, const ErrorSetting& setting);

/// The whole error. The given quantity, load or approach, has none.
RelativeError error_of_contact(const ErrorTable& table, const LevelResult& coarse,
                               const LevelResult& fine, const ErrorSetting& setting);

/// Whether an answer on a larger contact's meshes is accurate enough: a and b known to an eighth of
/// the cells that the contact would have on a mesh of its own, approach and torque five times as
/// well.
/// @param own_elements  per semi-axis, of that mesh
bool is_useful(const RelativeError& error, int own_elements);

/// A stiffness extrapolated to infinitely fine meshes; the whole correction is stated as its error.
struct ExtrapolatedStiffness {
  double value, error;
};
/// @param elements  per semi-axis, of the finer mesh
ExtrapolatedStiffness extrapolated_stiffness(double coarse, double fine, double refinement,
                                             int elements);

/// Error of the stiffness before slip because the edge of the contact lies between the mesh's
/// lines; 0 where it lies on them.
/// @param misfit        largest of both levels: |ln(size of the contact / size of the mesh)|
/// @param mesh_is_ours  false for a user's mesh, whose lines do not follow the contact's edge
double stuck_edge_error(const ErrorTable& table, int elements_per_semi_axis, bool symmetric,
                        bool mesh_is_ours, double misfit);

}  // namespace softfinger::fem
