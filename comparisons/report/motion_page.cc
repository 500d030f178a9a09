#include "comparisons/report/motion_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "comparisons/report/embedded.h"
#include "comparisons/report/hold.h"
#include "comparisons/report/html.h"
#include "comparisons/report/motion_data.h"
#include "comparisons/report/page.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/input/constants.h"

namespace softfinger::report {
namespace {

using simulation::RecordedContact;
using simulation::Recording;

double tangential_force_N(const RecordedContact& contact) {
  return std::hypot(contact.tangent_force_1_N, contact.tangent_force_2_N);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{}\u00a0{}", count, count == 1 ? one : many);
}

/// Counts of the bodies, steps and contacts that were recorded.
Html recorded(const Recording& recording, const std::vector<ContactTrack>& tracks) {
  const std::size_t movable =
      std::count_if(recording.bodies.begin(), recording.bodies.end(),
                    [](const simulation::RecordedBody& body) { return body.movable; });
  const std::size_t shown = shown_frames(recording).size();
  Html text = html("{} ({} of them movable), {} over {}\u00a0s, ",
                   counted(recording.bodies.size(), "body", "bodies"), movable,
                   counted(recording.frames.size() - 1, "step", "steps"),
                   plain(recording.frames.back().time_s - recording.frames.front().time_s));
  text += escape(tracks.empty() ? "no contact" : counted(tracks.size(), "contact", "contacts"));
  if (shown < recording.frames.size())
    text += html(
        "; the player and the charts show {} of the {} recorded instants, the tables are of all",
        shown, recording.frames.size());
  return text;
}

/// The answer: whether it holds, until when, what slips first, how near the rest is to it.
Html verdict(const Recording& recording, const std::vector<ContactTrack>& tracks) {
  if (recording.frames.empty()) return "<p class=\"lead\">Nothing was recorded.</p>\n";
  const std::string words = in_words(examine_hold(recording, tracks), recording, tracks);
  if (words.empty()) return "";
  const std::size_t colon = words.find(':');
  return html("<p class=\"lead\"><b>{}</b>{}</p>\n", words.substr(0, colon), words.substr(colon));
}

using States = std::vector<std::vector<Hold::State>>;  ///< per track, per instant

/// "1 of 5 contacts slips, and 1 of 5 contacts is at its friction limit without slipping: ...".
Html limits_in_words(std::size_t slipping, std::size_t creeping, std::size_t contacts) {
  if (slipping + creeping == 0)
    return html("; <b>{}</b>", contacts == 1 ? "the contact sticks" : "all contacts stick");
  Html text = "; ";
  if (slipping > 0)
    text += html("<b>{} of {} {}</b>", slipping, counted(contacts, "contact", "contacts"),
                 slipping == 1 ? "slips" : "slip");
  if (creeping > 0)
    text += (slipping > 0 ? Html(", and ") : Html("")) +
            html("<b>{} of {} {} at {} friction limit</b> without slipping", creeping,
                 counted(contacts, "contact", "contacts"), creeping == 1 ? "is" : "are",
                 creeping == 1 ? "its" : "their");
  return text;
}

/// State at the end: what still moves, how many contacts slip or are at their limit.
Html outcome(const Recording& recording, const States& states) {
  if (recording.frames.size() < 2) return "";
  const simulation::Frame& end = recording.frames.back();
  constexpr double kRest_m_per_s = 1e-3, kRest_rad_per_s = kPi / 180;
  const auto unrest = [&](std::size_t body) {
    return std::max(end.velocities_m_per_s[body].norm() / kRest_m_per_s,
                    end.angular_velocities_rad_per_s[body].norm() / kRest_rad_per_s);
  };
  std::size_t fastest = recording.bodies.size();
  for (std::size_t body = 0; body < recording.bodies.size(); ++body)
    if (recording.bodies[body].movable &&
        (fastest == recording.bodies.size() || unrest(body) > unrest(fastest)))
      fastest = body;
  Html text = "<p>At the end ";
  if (fastest == recording.bodies.size()) {
    text += "nothing can move";
  } else if (unrest(fastest) < 1) {
    text += "<b>all bodies are at rest</b> (slower than 1\u00a0mm/s and 1°/s)";
  } else {
    text += html("<b>{} still moves</b> fastest, at {}\u00a0mm/s and {}°/s",
                 recording.bodies[fastest].name,
                 significant(1e3 * end.velocities_m_per_s[fastest].norm(), 1, 2),
                 significant(end.angular_velocities_rad_per_s[fastest].norm() * 180 / kPi, 1, 2));
  }
  std::size_t slipping = 0, creeping = 0;
  for (const auto& of_track : states) {
    slipping += of_track.back() == Hold::State::slips;
    creeping += of_track.back() == Hold::State::at_limit;
  }
  if (end.contacts.empty()) return text + ", and nothing touches.</p>\n";
  return text + limits_in_words(slipping, creeping, end.contacts.size()) + ".</p>\n";
}

/// The answer's warning. Its reasons follow the player, which they would push off the screen.
Html doubt(const Recording& recording) {
  if (recording.unknown.empty()) return "";
  return html("<p><b>{} <a href=\"#unknown\">outside what is known</a>.</b></p>\n",
              recording.unknown.size() == 1
                  ? "One soft contact is"
                  : fmt::format("{} soft contacts are", recording.unknown.size()));
}

/// Soft contacts of which nothing is known, and those that are points.
Html doubts(const Recording& recording) {
  Html rows;
  for (const simulation::UnknownContact& contact : recording.unknown)
    rows += html("<li>{}</li>\n",
                 simulation::in_words(contact, recording.bodies, int(recording.frames.size()) - 1));
  return rows.empty() ? rows
                      : "<h2 id=\"unknown\">Outside what is known</h2>\n<ul>\n" + rows + "</ul>\n";
}

/// Empty places that motion.js fills; hidden without it.
constexpr char kPlayer[] = R"(<section class="player" aria-label="Motion in 3-D">
<div class="stage">
<div class="view"><canvas id="view" aria-label="Bodies and contacts"></canvas><p class="scale" id="scale"></p></div>
<div class="transport">
<button type="button" id="play">Play</button>
<input type="range" id="time" min="0" value="0" step="1" aria-label="Time">
<output id="clock"></output>
<label>speed <select id="speed"></select></label>
</div>
<div class="settings of_contacts">
<label>contacts <select id="colouring"><option value="state">state</option><option value="use">utilisation</option></select></label>
<span id="colours"></span>
<label>ellipses <select id="magnification"></select></label>
</div>
<div class="settings">
<label class="of_contacts">forces <select id="force_scale"></select></label>
<span class="of_contacts"><i class="arrow normal"></i> normal <i class="arrow tangential"></i> tangential</span>
<label><input type="checkbox" id="see_through"> see through bodies</label>
<label><input type="checkbox" id="follow"> follow the objects</label>
<button type="button" id="reset">Reset view</button>
</div>
<p class="contacts_head of_contacts">Contacts, with their normal force and utilisation now:</p>
<div class="contacts of_contacts" id="contacts" role="group" aria-label="Contacts"></div>
</div>
<div class="selected of_contacts" aria-live="off">
<h2 id="selected"></h2>
<p class="facts" id="state"></p>
<figure data-chart="wrench"><figcaption><b>Wrench against its limit.</b> <span id="wrench_note"></span></figcaption><div class="plot"></div></figure>
<figure data-chart="normal"><figcaption></figcaption><div class="plot"></div></figure>
<figure data-chart="tangential"><figcaption></figcaption><div class="plot"></div></figure>
<figure data-chart="torque"><figcaption></figcaption><div class="plot"></div></figure>
<figure data-chart="use"><figcaption></figcaption><div class="plot"></div></figure>
</div>
</section>
<noscript><p>The motion in 3-D and the charts need JavaScript; the tables below do not.</p></noscript>
)";

Html final_contacts(const Recording& recording, const std::vector<ContactTrack>& tracks,
                    const States& states) {
  Html out = "<h2 id=\"final\">Contacts at the end</h2>\n" + outcome(recording, states);
  if (recording.frames.empty()) return "";
  if (recording.frames.back().contacts.empty())
    return recording.frames.size() < 2 ? out + "<p>Nothing touches.</p>\n" : out;
  Html rows;
  for (std::size_t track = 0; track < tracks.size(); ++track) {
    const auto index = tracks[track].contacts.back();
    if (!index) continue;
    const RecordedContact& contact = recording.frames.back().contacts[*index];
    const bool is_point = !(contact.semi_axis_a_m > 0);
    const double max_force_N = contact.friction_coefficient * contact.normal_force_N;
    const LimitSurface surface(contact.semi_axis_a_m, contact.semi_axis_b_m,
                               contact.pressure_exponent, max_force_N);
    const double exact_utilisation = surface.utilisation(
        {contact.tangent_force_1_N, contact.tangent_force_2_N, contact.torque_Nm});
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"words\">{}</td>"
        "<td class=\"words\">{}</td><td class=\"words\">{}</td></tr>\n",
        track_name(recording, tracks, track), significant(contact.normal_force_N),
        significant(tangential_force_N(contact)), significant(1e3 * contact.torque_Nm),
        is_point ? "point" : significant(1e3 * contact.semi_axis_a_m, 3),
        is_point ? "" : significant(1e3 * contact.semi_axis_b_m, 3),
        significant(contact.friction_coefficient, 3), significant(1e3 * contact.eccentricity_m, 3),
        significant(contact.utilisation, 3), is_point ? "–" : significant(exact_utilisation, 3),
        in_words(states[track].back()), contact.model, contact.friction->name);
  }
  return out +
         "<p>Forces and torque act on the second body of a pair. Utilisation says how much of its "
         "limit a contact uses, 1 at the limit: by the friction law in the last column with the "
         "e<sub>n</sub> of the table (facets by the ellipsoid around them), and by the exact "
         "limit surface of the ellipse. A contact that <b>slips</b> moves along "
         "the surface, in one go by more than " +
         html("{}\u00a0µm", plain(1e6 * Hold::kLeastSlip_m)) +
         " (a turn counts as e<sub>n</sub> times its angle); one <b>at its limit</b> has "
         "reached it and moves less than that, as a fingertip does that creeps or finds its "
         "place.</p>\n" +
         scrolling_table(column_heading("contact") + column_heading("normal force P", "N") +
                             column_heading("tangential force", "N") +
                             column_heading("torque", "mN·m") + column_heading("a", "mm") +
                             column_heading("b", "mm") + column_heading("μ") +
                             column_heading("eₙ", "mm") + column_heading("utilisation") +
                             column_heading("exact utilisation") +
                             "<th scope=\"col\" class=\"words\">state</th>"
                             "<th scope=\"col\" class=\"words\">pressure model</th>"
                             "<th scope=\"col\" class=\"words\">friction law</th>",
                         rows);
}

Html contacts_over_time(const Recording& recording, const std::vector<ContactTrack>& tracks,
                        const States& states) {
  if (tracks.empty()) return "";
  Html rows;
  for (std::size_t track = 0; track < tracks.size(); ++track) {
    std::size_t touching = 0, creeping = 0, slipping = 0;
    double first_s = 0, last_s = 0, largest_force_N = 0, largest_use = 0, largest_use_s = 0;
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      if (!tracks[track].contacts[i]) continue;
      const double time_s = recording.frames[i].time_s;
      const RecordedContact& contact = recording.frames[i].contacts[*tracks[track].contacts[i]];
      if (touching++ == 0) first_s = time_s;
      last_s = time_s;
      creeping += states[track][i] == Hold::State::at_limit;
      slipping += states[track][i] == Hold::State::slips;
      largest_force_N = std::max(largest_force_N, contact.normal_force_N);
      if (contact.utilisation > largest_use) {
        largest_use = contact.utilisation;
        largest_use_s = time_s;
      }
    }
    rows += html(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
        "<td>{}</td><td>{}</td><td>{}</td></tr>\n",
        track_name(recording, tracks, track), significant(first_s), significant(last_s), touching,
        creeping, slipping, significant(largest_force_N), significant(largest_use, 3),
        significant(largest_use_s));
  }
  return "<h2 id=\"contacts-over-time\">Contacts over the whole motion</h2>\n" +
         scrolling_table(column_heading("contact") + column_heading("first", "s") +
                             column_heading("last", "s") + column_heading("instants in contact") +
                             column_heading("of these at its limit") +
                             column_heading("of these slipping") +
                             column_heading("largest normal force", "N") +
                             column_heading("largest utilisation") + column_heading("at", "s"),
                         rows);
}

Html provenance(const Recording& recording, const std::vector<ContactTrack>& tracks,
                const MotionPageOptions& options) {
  Html rows;
  const auto row = [&](const char* name, const Html& value) {
    if (!value.empty()) rows += html("<dt>{}</dt><dd>{}</dd>", name, value);
  };
  if (!recording.frames.empty()) row("recorded", recorded(recording, tracks));
  row("version", escape(options.version));
  row("date", escape(options.date));
  Html out = "<h2 id=\"provenance\">Where this comes from</h2>\n";
  if (!rows.empty()) out += "<dl class=\"provenance\">" + rows + "</dl>\n";
  if (!options.command.empty())
    out += html("<p>To repeat it:</p>\n<pre>{}</pre>\n", options.command);
  if (!options.scene_text.empty())
    out += html("<details><summary>The scene</summary>\n<pre>{}</pre></details>\n",
                options.scene_text);
  return out + html(
                   "<details><summary>Licences of the libraries in this file</summary>\n"
                   "<pre>three.js\n\n{}\n{}</pre></details>\n",
                   embedded::three_licence, embedded::licences);
}

}  // namespace

std::string motion_page(const Recording& recording, const MotionPageOptions& options) {
  const std::vector<ContactTrack> tracks = follow_contacts(recording);
  States states;
  for (const ContactTrack& track : tracks) states.push_back(states_of(recording, track));
  const Html body =
      html("<header><h1>{}</h1>\n<p class=\"subtitle\">{}</p>\n{}</header>\n", recording.scene,
           recording.question, verdict(recording, tracks) + doubt(recording)) +
      (recording.frames.empty() ? Html("") : kPlayer) + doubts(recording) +
      final_contacts(recording, tracks, states) + contacts_over_time(recording, tracks, states) +
      provenance(recording, tracks, options);
  return render_page({escape(recording.scene),
                      {embedded::report_css, embedded::motion_css},
                      body,
                      motion_data(recording, tracks),
                      {embedded::d3_js, embedded::plot_js, embedded::motion_js}});
}

}  // namespace softfinger::report
