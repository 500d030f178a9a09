#include "comparisons/report/hold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

using simulation::Frame;
using simulation::RecordedContact;
using simulation::Recording;

bool is_soft(const RecordedContact& contact) { return contact.semi_axis_a_m > 0; }

/// Slide of a contact from one instant to the next, of body b against body a.
struct SlipStep {
  double along_m = 0, turn_rad = 0;
};

SlipStep slip_between(const Frame& before, const Frame& after, const RecordedContact& contact) {
  const auto moved = [&](int body) {
    return after.poses[std::size_t(body)] * before.poses[std::size_t(body)].inverse();
  };
  const Eigen::Isometry3d back_a = moved(contact.a).inverse(), back_b = moved(contact.b).inverse();
  // Both are the material points that have arrived at the contact.
  const Eigen::Vector3d apart = back_a * contact.point_m - back_b * contact.point_m;
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(back_a.linear() * back_b.linear().transpose()));
  return {(contact.axes.leftCols<2>().transpose() * apart).norm(),
          std::abs(turn.angle() * turn.axis().dot(contact.axes.col(2)))};
}

Hold::Contact examine(const Recording& recording, const ContactTrack& track, std::size_t index) {
  Hold::Contact result;
  result.track = index;
  result.states.assign(recording.frames.size(), Hold::State::absent);
  bool touches = false, has_touched = false;
  double path_m = 0;  // since it began to slide
  // A contact at its limit may stick for single steps; it slides on.
  constexpr int kRest = 10;
  int at_rest = 0;  // instants without sliding
  std::optional<double> slides_from_s;
  std::size_t first_of_slide = 0;  // instants
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const Frame& frame = recording.frames[i];
    if (!track.contacts[i]) {
      touches = false;
      continue;
    }
    const RecordedContact& contact = frame.contacts[*track.contacts[i]];
    if (!touches) {
      if (!has_touched) result.first_s = frame.time_s;
      has_touched = true;
      path_m = 0;
      slides_from_s.reset();
    }
    touches = true;
    result.last_s = frame.time_s;
    result.states[i] = contact.slides ? Hold::State::at_limit : Hold::State::sticks;
    at_rest = contact.slides ? 0 : at_rest + 1;
    if (at_rest > kRest) {
      path_m = 0;
      slides_from_s.reset();
    }
    if (contact.slides && i > 0) {
      const SlipStep step = slip_between(recording.frames[i - 1], frame, contact);
      if (!slides_from_s) {
        slides_from_s = frame.time_s;
        first_of_slide = i;
      }
      path_m += step.along_m + contact.eccentricity_m * step.turn_rad;
      result.slip_m += step.along_m;
      result.turn_rad += step.turn_rad;
      if (path_m > Hold::kLeastSlip_m) {
        if (!result.slips_from_s) result.slips_from_s = slides_from_s;
        result.slips_until_s = frame.time_s;
        // The slide is a slip from its beginning; it is marked once.
        for (; first_of_slide <= i; ++first_of_slide)
          if (result.states[first_of_slide] == Hold::State::at_limit)
            result.states[first_of_slide] = Hold::State::slips;
      }
    }
    if (!result.slips_from_s && contact.utilisation > result.utilisation) {
      result.utilisation = contact.utilisation;
      result.utilisation_s = frame.time_s;
    }
  }
  result.touches_at_end = touches;
  return result;
}

/// Three digits without a power of ten.
std::string three_digits(double value) {
  return value >= 99.95 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

/// " by 0.11 mm and 32°"; what is less than a micrometre or a tenth of a degree is left out.
std::string slip_in_words(const Hold::Contact& contact) {
  const double degrees = contact.turn_rad * 180 / kPi;
  std::string text;
  if (contact.slip_m >= 1e-6)
    text = fmt::format(", by {}\u00a0{}",
                       three_digits((contact.slip_m < 1e-4 ? 1e6 : 1e3) * contact.slip_m),
                       contact.slip_m < 1e-4 ? "µm" : "mm");
  if (degrees >= 0.1)
    text += fmt::format("{} {}°", text.empty() ? ", by" : " and", three_digits(degrees));
  return text.empty() ? text : text + " in all";
}

/// A time as exact as a step.
std::string instant(double time_s) { return fmt::format("{:.4g}\u00a0s", time_s); }

}  // namespace

std::vector<Hold::State> states_of(const Recording& recording, const ContactTrack& track) {
  return examine(recording, track, 0).states;
}

const char* in_words(Hold::State state) {
  switch (state) {
    case Hold::State::sticks:
      return "sticks";
    case Hold::State::at_limit:
      return "at its limit";
    case Hold::State::slips:
      return "slips";
    default:
      return "";
  }
}

const Hold::Contact* Hold::first_slip() const {
  const Contact* first = nullptr;
  for (const Contact& contact : contacts)
    if (contact.slips_from_s && (!first || *contact.slips_from_s < *first->slips_from_s))
      first = &contact;
  return first;
}

bool Hold::holds() const { return !contacts.empty() && !first_slip(); }

const Hold::Contact* Hold::nearest() const {
  const Contact* nearest = nullptr;
  for (const Contact& contact : contacts)
    if (!contact.slips_from_s && (!nearest || contact.utilisation > nearest->utilisation))
      nearest = &contact;
  return nearest;
}

std::optional<double> Hold::holds_again_s() const {
  double until_s = start_s;
  bool touches = false;
  for (const Contact& contact : contacts) {
    touches = touches || contact.touches_at_end;
    if (contact.slips_from_s) until_s = std::max(until_s, contact.slips_until_s);
  }
  // Two steps: whether a contact goes on sliding cannot be seen at the last one.
  if (!touches || !first_slip() || until_s > end_s - 2 * time_step_s) return std::nullopt;
  return until_s + time_step_s;
}

Hold examine_hold(const Recording& recording, const std::vector<ContactTrack>& tracks) {
  Hold hold;
  if (recording.frames.empty()) return hold;
  hold.start_s = recording.frames.front().time_s;
  hold.end_s = recording.frames.back().time_s;
  hold.time_step_s = recording.time_step_s;
  const auto any_soft = [&](const ContactTrack& track) {
    for (std::size_t i = 0; i < recording.frames.size(); ++i)
      if (track.contacts[i] && is_soft(recording.frames[i].contacts[*track.contacts[i]]))
        return true;
    return false;
  };
  const auto between_movable = [&](const ContactTrack& track) {
    return recording.bodies[std::size_t(track.a)].movable &&
           recording.bodies[std::size_t(track.b)].movable;
  };
  hold.soft_only = std::any_of(tracks.begin(), tracks.end(), any_soft);
  const bool movable_only = std::any_of(tracks.begin(), tracks.end(), between_movable);
  for (std::size_t t = 0; t < tracks.size(); ++t)
    if (hold.soft_only ? any_soft(tracks[t]) : !movable_only || between_movable(tracks[t]))
      hold.contacts.push_back(examine(recording, tracks[t], t));
  return hold;
}

std::string in_words(const Hold& hold, const Recording& recording,
                     const std::vector<ContactTrack>& tracks) {
  if (hold.contacts.empty()) return "";
  const auto name = [&](const Hold::Contact& contact) {
    return track_name(recording, tracks, contact.track);
  };
  const char* kind = hold.soft_only ? "soft contact" : "contact";
  const Hold::Contact* near = hold.nearest();
  const Hold::Contact* first = hold.first_slip();
  const auto nearness = [&] {
    return fmt::format("{}, with {} of its friction limit used at {}", name(*near),
                       percent(near->utilisation), instant(near->utilisation_s));
  };
  if (!first) {
    std::string text = fmt::format("It holds to the end, {}: no {} slips. Nearest comes {}.",
                                   instant(hold.end_s - hold.start_s), kind, nearness());
    std::vector<const Hold::Contact*> opened;
    for (const Hold::Contact& contact : hold.contacts)
      if (!contact.touches_at_end) opened.push_back(&contact);
    if (!opened.empty())
      text += fmt::format(" {} of {} {}s no longer {} at the end.", opened.size(),
                          hold.contacts.size(), kind, opened.size() == 1 ? "touches" : "touch");
    return text;
  }
  const double from_s = *first->slips_from_s;
  const bool at_once = from_s <= first->first_s + 2 * hold.time_step_s;
  std::string text = at_once ? fmt::format("It slips as soon as it touches, at {}: {} slips first",
                                           instant(from_s), name(*first))
                             : fmt::format("It holds until {}: then {} slips first",
                                           instant(from_s), name(*first));
  text += slip_in_words(*first);
  std::size_t slipping = 0;
  for (const Hold::Contact& contact : hold.contacts) slipping += contact.slips_from_s.has_value();
  text += fmt::format("; {} of {} {}{} in time.", slipping, hold.contacts.size(), kind,
                      slipping == 1 && hold.contacts.size() == 1 ? " slips" : "s slip");
  if (near) text += fmt::format(" Nearest of those that never do comes {}.", nearness());
  const auto touches = [](const Hold::Contact& contact) { return contact.touches_at_end; };
  if (const auto again = hold.holds_again_s())
    text += fmt::format(" From {} on no {} slips any more.", instant(*again), kind);
  else if (std::none_of(hold.contacts.begin(), hold.contacts.end(), touches))
    text += fmt::format(" At the end no {} is left.", kind);
  return text;
}

std::string outcome_of(const Hold& hold) {
  if (hold.contacts.empty()) return "touches nothing";
  const bool is_left =
      std::any_of(hold.contacts.begin(), hold.contacts.end(),
                  [](const Hold::Contact& contact) { return contact.touches_at_end; });
  if (!is_left) return "lets go";
  if (hold.holds()) return "holds";
  return hold.holds_again_s() ? "slips and holds again" : "slips";
}

std::string outcome_in_words(const Recording& plain, const Recording& chosen,
                             const std::string& change) {
  const auto tracks_plain = follow_contacts(plain), tracks_chosen = follow_contacts(chosen);
  const Hold before = examine_hold(plain, tracks_plain), now = examine_hold(chosen, tracks_chosen);
  const std::string was = outcome_of(before), is = outcome_of(now);
  if (was == is)
    return fmt::format(
        "The outcome stays, it {}: against the scene as it is written the motion changes {}.", is,
        change);
  return fmt::format(
      "The outcome changes: as the scene is written, it {}; with what is chosen here, it {}. "
      "Between the two the motion changes {}. As written: {} As chosen: {}",
      was, is, change, in_words(before, plain, tracks_plain), in_words(now, chosen, tracks_chosen));
}

Json to_json(const Hold& hold, const Recording& recording,
             const std::vector<ContactTrack>& tracks) {
  const auto bodies = [&](const Hold::Contact* contact) {
    if (!contact) return Json();
    const ContactTrack& track = tracks.at(contact->track);
    return Json{recording.bodies.at(std::size_t(track.a)).name,
                recording.bodies.at(std::size_t(track.b)).name};
  };
  const Hold::Contact *first = hold.first_slip(), *near = hold.nearest();
  const auto again = hold.holds_again_s();
  return {{"holds", hold.contacts.empty() ? Json() : Json(hold.holds())},
          {"until_s", first ? Json(*first->slips_from_s) : Json()},
          {"first_slip", bodies(first)},
          {"again_s", again ? Json(*again) : Json()},
          {"nearest", bodies(near)},
          {"utilisation", near ? Json(near->utilisation) : Json()}};
}

}  // namespace softfinger::report
