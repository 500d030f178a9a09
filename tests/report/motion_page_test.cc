#include "comparisons/report/motion_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "comparisons/report/hold.h"
#include "comparisons/report/motion_data.h"
#include "from_base64.h"
#include "page_text.h"
#include "sample_motion.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

using simulation::Recording;
using tests::contains;
using tests::from_base64;
using tests::without_scripts;

TEST(MotionPage, SaysWithoutScriptsWhatMovedAndWhatTouchesAtTheEnd) {
  MotionPageOptions options;
  options.scene_text = "[[body]]\nname = \"a <b> & c\"\n";
  options.version = "1.2.3";
  options.command = "softfinger simulate box.toml --output \"my folder\"";
  const Recording recording = tests::sample_motion();
  const std::string text = without_scripts(motion_page(recording, options));
  for (const char* part :
       {"<h1>box_in_pinch</h1>", "held off its centre", "4\u00a0bodies (3 of them movable)",
        "400\u00a0steps over 2\u00a0s", "6\u00a0contacts", "thumb – box", "index finger – box",
        "table – box 4", "[[body]]\nname = &quot;a &lt;b&gt; &amp; c&quot;", "1.2.3",
        "softfinger simulate box.toml --output &quot;my folder&quot;", "three.js"})
    EXPECT_TRUE(contains(text, part)) << part;
  const std::string final_table =
      text.substr(text.find("id=\"final\""),
                  text.find("id=\"contacts-over-time\"") - text.find("id=\"final\""));
  for (const char* part : {"thumb – box", "<td>4.000</td>", "<td>3.20</td>", "winkler", "sticks"})
    EXPECT_TRUE(contains(final_table, part)) << part;
  EXPECT_FALSE(contains(final_table, "table – box")) << "it has been lifted";
}

TEST(MotionPage, AnswersInItsFirstLine) {
  const std::string text = without_scripts(motion_page(tests::sample_motion(), {}));
  const std::size_t lead = text.find("class=\"lead\"");
  ASSERT_NE(lead, std::string::npos);
  EXPECT_EQ(text.find("<p", text.find("class=\"subtitle\"")), lead - 3)
      << "nothing comes before it";
  const std::string first = text.substr(lead, text.find("</p>", lead) - lead);
  EXPECT_TRUE(contains(first, "<b>It holds until 1.2")) << first;
  EXPECT_TRUE(contains(first, "then thumb – box slips first")) << first;
  EXPECT_TRUE(contains(first, "From 1.9")) << first;
}

TEST(MotionPage, HasItsPlayerRightAfterTheAnswerAndSaysAFactOnce) {
  Recording recording = tests::sample_motion();
  recording.unknown.resize(1);
  recording.unknown[0].a = 0;
  recording.unknown[0].b = 1;
  const std::string text = without_scripts(motion_page(recording, {}));
  const std::size_t lead = text.find("class=\"lead\""), player = text.find("class=\"player\"");
  ASSERT_LT(lead, player);
  // One more paragraph: that there are doubts, which are told below.
  EXPECT_EQ(tests::occurrences(text.substr(lead, player - lead), "<p"), 1u);
  EXPECT_LT(player, text.find("id=\"unknown\""));
  for (const char* fact : {"steps over", "movable", "µm"})
    EXPECT_EQ(tests::occurrences(text, fact), 1u) << fact;
}

/// One finger on a block that is pulled along x by `slip_m(time)`.
Recording pulled_block(const std::function<double(double)>& slip_m) {
  Recording recording;
  recording.time_step_s = 0.01;
  recording.bodies = {{"finger", true, {}}, {"block", true, {}}};
  for (int i = 0; i <= 100; ++i) {
    simulation::Frame frame;
    frame.time_s = 0.01 * i;
    Eigen::Isometry3d block = Eigen::Isometry3d::Identity();
    block.translation().x() = slip_m(frame.time_s);
    frame.poses = {Eigen::Isometry3d::Identity(), block};
    frame.velocities_m_per_s.assign(2, Eigen::Vector3d::Zero());
    frame.angular_velocities_rad_per_s.assign(2, Eigen::Vector3d::Zero());
    simulation::RecordedContact contact;
    contact.a = 0;
    contact.b = 1;
    contact.semi_axis_a_m = contact.semi_axis_b_m = 2e-3;
    contact.eccentricity_m = 1e-3;
    contact.normal_force_N = 1;
    contact.friction_coefficient = 0.5;
    contact.slides = slip_m(frame.time_s) != slip_m(frame.time_s - 0.01);
    contact.utilisation = contact.slides ? 1 : 0.9 * frame.time_s;
    frame.contacts.push_back(contact);
    recording.frames.push_back(frame);
  }
  return recording;
}

TEST(Hold, MeasuresWhenAndHowFarAContactSlips) {
  const Recording recording =
      pulled_block([](double t) { return t < 0.495 ? 0 : 2e-3 * (t - 0.495); });
  const auto tracks = follow_contacts(recording);
  const Hold hold = examine_hold(recording, tracks);
  ASSERT_TRUE(hold.first_slip());
  EXPECT_FALSE(hold.holds());
  EXPECT_NEAR(*hold.first_slip()->slips_from_s, 0.5, 1e-12);
  EXPECT_NEAR(hold.first_slip()->slip_m, 2e-3 * (1 - 0.495), 1e-12);
  EXPECT_NEAR(hold.first_slip()->utilisation, 0.9 * 0.49, 1e-12);
  EXPECT_FALSE(hold.nearest());
  EXPECT_FALSE(hold.holds_again_s());
  EXPECT_TRUE(contains(in_words(hold, recording, tracks),
                       "It holds until 0.5\u00a0s: then finger – block slips first"));
}

TEST(Hold, StatesTheNearestContactWhereNoneSlips) {
  const Recording recording = pulled_block([](double) { return 0; });
  const auto tracks = follow_contacts(recording);
  const Hold hold = examine_hold(recording, tracks);
  EXPECT_TRUE(hold.holds());
  ASSERT_TRUE(hold.nearest());
  EXPECT_NEAR(hold.nearest()->utilisation, 0.9, 1e-12);
  EXPECT_EQ(to_json(hold, recording, tracks)["holds"], true);
}

TEST(Hold, DoesNotCountSlidesTooSmallToSee) {
  // Each slide is of half the least slip; a rest of ten instants lies between them.
  const auto slides = [](double t) { return Hold::kLeastSlip_m / 2 * std::floor(t / 0.2 + 1e-9); };
  const Recording recording = pulled_block(slides);
  EXPECT_TRUE(examine_hold(recording, follow_contacts(recording)).holds());
}

TEST(Hold, TellsAContactThatCreepsFromOneThatSlips) {
  // Half the least slip in all, from 0.2 s to the end: at its limit, and it holds.
  const Recording creeps =
      pulled_block([](double t) { return Hold::kLeastSlip_m / 2 * std::max(0., t - 0.195); });
  const auto of_creeping = states_of(creeps, follow_contacts(creeps)[0]);
  EXPECT_EQ(of_creeping[10], Hold::State::sticks);
  EXPECT_EQ(of_creeping.back(), Hold::State::at_limit);
  std::string text = without_scripts(motion_page(creeps, {}));
  EXPECT_TRUE(contains(text, "It holds to the end")) << text;
  EXPECT_TRUE(contains(text, "is at its friction limit</b> without slipping")) << text;
  EXPECT_TRUE(contains(text, "<td class=\"words\">at its limit</td>")) << text;
  EXPECT_FALSE(contains(text, ">slips</td>"));
  // A thousand times that is a slip, from its first instant on.
  const Recording slips =
      pulled_block([](double t) { return Hold::kLeastSlip_m * 500 * std::max(0., t - 0.195); });
  const auto of_slipping = states_of(slips, follow_contacts(slips)[0]);
  EXPECT_EQ(of_slipping[19], Hold::State::sticks);
  EXPECT_EQ(of_slipping[20], Hold::State::slips);
  text = without_scripts(motion_page(slips, {}));
  EXPECT_TRUE(contains(text, "<td class=\"words\">slips</td>")) << text;
  EXPECT_TRUE(contains(text, "<b>1 of 1\u00a0contact slips</b>")) << text;
}

TEST(Hold, SaysFirstWhetherTheOutcomeChanges) {
  const Recording holds = pulled_block([](double) { return 0; });
  const Recording slips = pulled_block([](double t) { return t; });
  EXPECT_TRUE(
      contains(outcome_in_words(holds, holds, "by nothing"), "The outcome stays, it holds"));
  const std::string changed = outcome_in_words(slips, holds, "by at most 1000 mm");
  EXPECT_TRUE(contains(changed,
                       "The outcome changes: as the scene is written, it slips; with what "
                       "is chosen here, it holds"))
      << changed;
}

TEST(Hold, SaysWhenItHoldsAgain) {
  const Recording recording =
      pulled_block([](double t) { return 1e-2 * std::clamp(t - 0.295, 0., 0.2); });
  const Hold hold = examine_hold(recording, follow_contacts(recording));
  ASSERT_TRUE(hold.holds_again_s());
  EXPECT_NEAR(*hold.holds_again_s(), 0.51, 1e-12);
}

TEST(MotionPage, EscapesNamesInTextAndData) {
  Recording recording = tests::sample_motion(10);
  recording.scene = recording.bodies[0].name = "</script><script>alert(1)</script>";
  const std::string page = motion_page(recording, {});
  EXPECT_FALSE(contains(page, "<script>alert(1)"));
  EXPECT_TRUE(contains(without_scripts(page), "&lt;script&gt;alert(1)"));
}

TEST(MotionPage, StaysBelowThreeMegabytes) {
  EXPECT_LT(motion_page(tests::large_motion(), {}).size(), 3'000'000u);
  // The stress scene: a hundred contacts. And meshes far finer than a picture needs.
  Recording stress = tests::large_motion();
  for (simulation::Frame& frame : stress.frames)
    while (frame.contacts.size() < 100) frame.contacts.push_back(frame.contacts.front());
  for (int i = 0; i < 5; ++i) {
    input::Mesh& mesh = std::get<input::Mesh>(stress.bodies[5 * i + 4].shapes.front().kind);
    TriangleSurface own = *std::get<input::Mesh>(stress.bodies[25].shapes.front().kind).surface;
    for (Eigen::Vector3d& vertex : own.vertices_m) vertex *= 0.2 + 0.01 * i;
    mesh.surface = std::make_shared<const TriangleSurface>(own);
  }
  EXPECT_LT(motion_page(stress, {}).size(), 3'000'000u);
}

TEST(MotionPage, NeedsNoNetwork) {
  const std::string page = motion_page(tests::sample_motion(10), {});
  EXPECT_FALSE(contains(page, "src=\"http"));
  EXPECT_FALSE(contains(page, "<link"));
  EXPECT_FALSE(contains(page, "{{"));
}

TEST(MotionPage, SurvivesWhatThereIsNotMuchOf) {
  EXPECT_TRUE(contains(motion_page(tests::empty_motion(), {}), "Nothing was recorded."));
  EXPECT_TRUE(contains(motion_page(tests::motion_without_contacts(), {}), "no contact<"));
  EXPECT_TRUE(
      contains(motion_page(tests::motion_of_one_frame(), {}), "0\u00a0steps over 0\u00a0s"));
  Recording shapeless = tests::sample_motion(10);
  for (simulation::RecordedBody& body : shapeless.bodies) body.shapes.clear();
  EXPECT_TRUE(contains(motion_page(shapeless, {}), "thumb – box"));
}

TEST(ShownFrames, AreAtMost300WithTheFirstAndTheLast) {
  for (const int steps : {0, 1, 10, 298, 299, 300, 1000, 1799}) {
    const std::vector<std::size_t> shown = shown_frames(tests::sample_motion(steps));
    EXPECT_LE(shown.size(), 300u);
    EXPECT_GE(2 * shown.size(), std::min(300, steps)) << "and not many fewer";
    EXPECT_EQ(shown.front(), 0u);
    EXPECT_EQ(shown.back(), static_cast<std::size_t>(steps));
  }
  EXPECT_TRUE(shown_frames(tests::empty_motion()).empty());
}

TEST(FollowContacts, DoesNotDependOnTheOrderWithinAFrame) {
  const Recording recording = tests::sample_motion(100);
  Recording shuffled = recording;
  std::mt19937 random(1);
  // The first frame numbers the tracks.
  for (std::size_t i = 1; i < shuffled.frames.size(); ++i)
    std::shuffle(shuffled.frames[i].contacts.begin(), shuffled.frames[i].contacts.end(), random);
  const std::vector<ContactTrack> tracks = follow_contacts(recording);
  const std::vector<ContactTrack> shuffled_tracks = follow_contacts(shuffled);
  ASSERT_EQ(tracks.size(), 6u);
  ASSERT_EQ(shuffled_tracks.size(), tracks.size());
  for (std::size_t track = 0; track < tracks.size(); ++track)
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      ASSERT_EQ(tracks[track].contacts[i].has_value(),
                shuffled_tracks[track].contacts[i].has_value());
      if (!tracks[track].contacts[i]) continue;
      EXPECT_EQ(recording.frames[i].contacts[*tracks[track].contacts[i]].point_m,
                shuffled.frames[i].contacts[*shuffled_tracks[track].contacts[i]].point_m);
    }
}

TEST(FollowContacts, ContinuesATrackAfterAGap) {
  Recording recording = tests::sample_motion(100);
  for (int i = 20; i < 40; ++i) recording.frames[i].contacts.clear();
  const std::vector<ContactTrack> tracks = follow_contacts(recording);
  ASSERT_EQ(tracks.size(), 6u);
  EXPECT_EQ(track_name(recording, tracks, 0), "thumb – box");
  EXPECT_TRUE(tracks[0].contacts[19] && !tracks[0].contacts[30] && tracks[0].contacts[40]);
}

/// Seven numbers as motion.js reads them: the position, then the quaternion x, y, z, w.
void expect_pose(const float* numbers, const Eigen::Vector3d& position,
                 const Eigen::Matrix3d& turn) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(numbers[i], static_cast<float>(position[i]));
  const Eigen::Quaterniond read(numbers[6], numbers[3], numbers[4], numbers[5]);
  // Single precision: 6e-8 per number.
  EXPECT_LT((read.toRotationMatrix() - turn).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(MotionData, HoldsPosesAndContactsOfEveryShownFrame) {
  const Recording recording = tests::sample_motion(400);
  const std::vector<ContactTrack> tracks = follow_contacts(recording);
  const Json data = motion_data(recording, tracks);
  const std::vector<std::size_t> shown = shown_frames(recording);
  const auto times = from_base64<float>(data["time_s"]);
  const auto poses = from_base64<float>(data["poses"]);
  const auto contacts = from_base64<float>(data["contacts"]);
  const auto offsets = from_base64<std::uint32_t>(data["contact_offsets"]);
  ASSERT_EQ(times.size(), shown.size());
  ASSERT_EQ(poses.size(), 7 * 4 * shown.size());
  ASSERT_EQ(offsets.size(), shown.size() + 1);
  ASSERT_EQ(offsets.back(), contacts.size());
  const std::vector<std::string> columns = data["columns"];
  const auto column = [&](const char* name) {
    return std::find(columns.begin(), columns.end(), name) - columns.begin();
  };
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const simulation::Frame& frame = recording.frames[shown[i]];
    EXPECT_EQ(times[i], static_cast<float>(frame.time_s));
    for (std::size_t body = 0; body < 4; ++body)
      expect_pose(&poses[7 * (4 * i + body)], frame.poses[body].translation(),
                  frame.poses[body].linear());
    ASSERT_EQ(offsets[i + 1] - offsets[i], columns.size() * frame.contacts.size());
    for (std::size_t at = offsets[i]; at < offsets[i + 1]; at += columns.size()) {
      const auto track = static_cast<std::size_t>(contacts[at]);
      const simulation::RecordedContact& contact =
          frame.contacts[*tracks[track].contacts[shown[i]]];
      expect_pose(&contacts[at + column("x")], contact.point_m, contact.axes);
      for (const auto& [name, value] : {std::pair{"a", contact.semi_axis_a_m},
                                        {"b", contact.semi_axis_b_m},
                                        {"P", contact.normal_force_N},
                                        {"f1", contact.tangent_force_1_N},
                                        {"f2", contact.tangent_force_2_N},
                                        {"tau", contact.torque_Nm},
                                        {"mu", contact.friction_coefficient},
                                        {"e_n", contact.eccentricity_m},
                                        {"use", contact.utilisation}})
        EXPECT_EQ(contacts[at + column(name)], static_cast<float>(value)) << name;
      EXPECT_EQ(contacts[at + column("slides")], contact.slides ? 1 : 0);
      EXPECT_LE(contacts[at + column("slips")], contacts[at + column("slides")]);
    }
  }
}

TEST(MotionData, SectionsAreThoseOfTheLimitSurface) {
  const Recording recording = tests::sample_motion(400);
  const std::vector<ContactTrack> tracks = follow_contacts(recording);
  const Json data = motion_data(recording, tracks);
  const auto contacts = from_base64<float>(data["contacts"]);
  const auto radii = from_base64<float>(data["sections"]["radii"]);
  const int points = data["sections"]["points"];
  const std::vector<std::string> columns = data["columns"];
  const std::size_t section_column =
      std::find(columns.begin(), columns.end(), "section") - columns.begin();
  const std::vector<std::size_t> shown = shown_frames(recording);
  std::size_t at = 0;
  int checked = 0;
  for (const std::size_t i : shown)
    for (const ContactTrack& track : tracks) {
      if (!track.contacts[i]) continue;
      const simulation::RecordedContact& contact = recording.frames[i].contacts[*track.contacts[i]];
      const int section = static_cast<int>(contacts[at + section_column]);
      EXPECT_FLOAT_EQ(contacts[at + section_column + 1], 1) << "the sample uses the exact e_n";
      at += columns.size();
      if (contact.semi_axis_a_m == 0) {
        EXPECT_EQ(section, -1) << "a point has no limit surface to draw";
        continue;
      }
      const LimitSurface surface(contact.semi_axis_a_m, contact.semi_axis_b_m,
                                 contact.pressure_exponent, 1);
      const double direction = std::atan2(contact.tangent_force_2_N, contact.tangent_force_1_N);
      for (const int k : {0, 5, 12, 20, points - 1}) {
        const double angle = kPi / 2 * k / (points - 1);
        const double radius = radii.at(section * points + k);
        // Half a rounding step of aspect and direction moves the section by less than a pixel.
        EXPECT_NEAR(surface.utilisation({radius * std::cos(angle) * std::cos(direction),
                                         radius * std::cos(angle) * std::sin(direction),
                                         radius * std::sin(angle) * surface.eccentricity_m()}),
                    1, 0.004)
            << "direction " << direction << ", angle " << angle;
        ++checked;
      }
    }
  EXPECT_GT(checked, 1000);
}

TEST(MotionData, EqualSurfacesAreKeptOnce) {
  const Recording recording = tests::large_motion();
  const Json data = motion_data(recording, follow_contacts(recording));
  // 20 different links, one fingertip, the glass, the table.
  EXPECT_EQ(data["geometries"].size(), 23u);
  EXPECT_EQ(data["bodies"].size(), 27u);
}

TEST(MotionData, ABoxHasSharpEdgesAndASphereNone) {
  Recording recording = tests::sample_motion(1);
  const auto vertices = [&](const input::ShapeKind& kind) {
    recording.bodies[0].shapes = {{kind, Eigen::Isometry3d::Identity()}};
    const Json data = motion_data(recording, {});
    return from_base64<float>(data["geometries"][0]["positions"]).size() / 3;
  };
  EXPECT_EQ(vertices(input::Box{{1, 2, 3}}), 24u);
  EXPECT_EQ(vertices(input::Sphere{1}), 2u + 36 * 17);
}

}  // namespace
}  // namespace softfinger::report
