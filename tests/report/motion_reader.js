// What a reader of a motion does: moves the slider, plays for a while, chooses every contact and every
// setting, clicks the view. What came of it is stated on the page for the test.
"use strict";

async function read(page) {
  if (!page.dataset.frames) return;
  const checks = pageChecks(page);
  const {all, axisOf, expectPlace, pointsOf} = checks;
  const the = (id) => page.querySelector("#" + id);
  const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  checks.lookAtLabels("opening");
  const slider = the("time");
  slider.value = Math.round(slider.max / 2);
  slider.dispatchEvent(new Event("input"));
  page.dataset.sliderMoves = String(page.dataset.frame === slider.value);

  // Forces over time: the cursor stands at the instant of the slider, the line at the force there.
  const data = JSON.parse(page.querySelector("#data").textContent);
  const numbers = (text, Kind) => new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const frame = Number(slider.value), wide = data.columns?.length;
  const normal = page.querySelector('figure[data-chart="normal"] svg');
  if (normal && slider.max > 0) {
    const [times, rows] = [data.time_s, data.contacts].map((text) => numbers(text, Float32Array));
    const offsets = numbers(data.contact_offsets, Uint32Array), column = data.columns.indexOf("P");
    const x = axisOf(normal, "x", {plain: true}), y = axisOf(normal, "y", {plain: true});
    const cursor = normal.querySelector("line[data-cursor]") ?? [...normal.querySelectorAll("line")].at(-1);
    expectPlace("the cursor", [Number(cursor.getAttribute("x1"))], [x.place(times[frame])]);
    const selected = Number(page.dataset.selected ?? 0);
    for (let at = offsets[frame]; at < offsets[frame + 1]; at += wide) {
      if (rows[at] !== selected) continue;
      const near = all('g[aria-label="line"] path', normal).flatMap(pointsOf)
        .map((point) => [Math.hypot(point[0] - x.place(times[frame]), point[1] - y.place(rows[at + column])), point]).sort((a, b) => a[0] - b[0]);
      expectPlace("the normal force", near[0]?.[1] ?? [], [x.place(times[frame]), y.place(rows[at + column])]);
    }
  }
  // The friction ellipsoid is a quarter of a circle of radius 1.
  const wrench = page.querySelector('figure[data-chart="wrench"] svg');
  if (wrench) {
    const x = axisOf(wrench, "x", {plain: true}), y = axisOf(wrench, "y", {plain: true});
    const quarter = pointsOf(wrench.querySelector('g[aria-label="line"] path'));
    expectPlace("the ellipsoid's largest force", quarter[0], [x.place(1), y.place(0)]);
    expectPlace("the ellipsoid's largest torque", quarter.at(-1), [x.place(0), y.place(1)]);
    expectPlace("a unit upwards", [-y.per], [x.per], 1);
  }

  for (const select of all(".player select"))
    for (const option of select.options) {
      select.value = option.value;
      select.dispatchEvent(new Event("change"));
    }
  the("see_through").click();
  // Off and on again: what the camera follows by itself is stated before.
  page.dataset.followsByDefault = page.dataset.follows ?? "none";
  the("follow").click();
  the("follow").click();
  let selected = 0;
  all(".contact").forEach((button, i) => {
    button.click();
    selected += page.dataset.selected === String(i);
  });
  page.dataset.contactsSelected = String(selected);
  checks.lookAtLabels("choosing contacts");
  checks.lookAtColours();
  const box = the("view").getBoundingClientRect();
  for (const kind of ["pointerdown", "pointerup"])
    the("view").dispatchEvent(new PointerEvent(kind, {pointerType: "mouse", pointerId: 1,
      clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
  the("reset").click();
  page.querySelector("[data-chart=use] svg")?.dispatchEvent(new PointerEvent("pointerdown",
    {buttons: 1, clientX: 0}));
  page.dataset.chartSeeks = String(page.dataset.frame === "0");
  if (slider.max > 0) {
    the("play").click();
    await pause(1500);
  }
  page.dataset.plays = String(Number(page.dataset.frame) > 0);
  checks.lookAtLabels("playing");
  checks.state();
}
