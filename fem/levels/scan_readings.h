#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fem/levels/contact_physics.h"

/// The error of a contact that its scan leaves open. The scan's triangles and the rule for
/// its core are perturbed, and the contact is pressed again with each. How far the answers differ
/// is stated as an error.
namespace softfinger::fem {

/// The contact with which perturbed scans ("readings") are compared, and how they are made.
struct ReadingStart {
  ContactPhysics::PressOther press;  ///< starts from the contact's state
  LayerDiscretisation mesh;          ///< of the contact
  LevelResult best;                  ///< the contact on that mesh, of the unperturbed scan
  OrderedProgress progress;
  /// The shape of the finger by a perturbed scan and a rule for its core.
  std::function<FingertipShape(const Reading&, CoreWays)> shape;
};

/// The start from a contact that is pressed now; `shape_fingertip` makes its shapes.
ReadingStart start_readings(ContactPhysics& physics, const LevelResult& best,
                            const ContactTask& task);

/// Largest change of each quantity by other rules for the core. A core's ridge lies where the lines
/// from surface to core end on it, and no cells are fitted to it: how far other rules for these
/// lines change the answer estimates that error. A core without a ridge has none.
/// @returns FoldedLayer where no other rule gives a layer that can be pressed
Outcome<RelativeError, FoldedLayer> core_error(const ReadingStart& start, const ContactTask& task);

/// The error that the scan's triangles leave open, from perturbed scans; none where these cannot be
/// pressed.
///
/// At random: where the surface lies. Vertices are moved by what facets leave open. The finger is
/// held by its own normal, which they change too. Two samples are taken, four where they tell much.
/// Systematic: what is smoothed away, and the frame, whose normal was fitted over a larger region
/// than the contact asks for where facets are large.
std::optional<RelativeError> geometry_error(const ReadingStart& start, const ContactTask& task);

/// Changes by several perturbed scans; none for one that cannot be pressed.
using Changes = std::vector<std::optional<RelativeError>>;

/// The interval of 95 % around no change, by Student's factor for as many random changes as are
/// known, plus the norm of the systematic changes. None where no random change is known.
/// @param random  at most four
std::optional<RelativeError> left_open(const Changes& random,
                                       const std::vector<RelativeError>& systematic);

}  // namespace softfinger::fem
