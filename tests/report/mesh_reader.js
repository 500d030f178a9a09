// What a reader of a surface does: clicks the surface, chooses every point, moves the region's slider.
// What came of it is stated on the page for the test. The surface is the ellipsoid of write_meshes.cc.
"use strict";

async function read(page) {
  const checks = pageChecks(page);
  if (page.dataset.drawn) {
    const the = (id) => page.querySelector("#" + id);
    const canvas = page.querySelector("canvas"), box = canvas.getBoundingClientRect();
    checks.lookAtLabels("opening");
    let chosen = 0;
    for (const button of the("points").children) {
      button.click();
      chosen += button.getAttribute("aria-pressed") === "true" && the("lines").textContent.includes("point_mm");
    }
    page.dataset.pointsChosen = String(chosen);
    the("reset").click();
    await new Promise((resolve) => setTimeout(resolve, 200));
    const shown = the("lines").textContent;
    for (const kind of ["pointerdown", "pointerup"])
      canvas.dispatchEvent(new PointerEvent(kind, {pointerType: "mouse", pointerId: 1,
        clientX: box.x + box.width / 2, clientY: box.y + box.height / 2}));
    // The clicked point lies on the ellipsoid, and its normal points out of it.
    const line = the("lines").textContent;
    const [place, normal] = ["point_mm", "normal"].map((key) =>
      new RegExp(`${key} = \\[([^\\]]*)\\]`).exec(line)[1].split(",").map(Number));
    const axes = [12, 7, 14];
    const level = Math.hypot(...place.map((x, i) => x / axes[i]));
    const gradient = place.map((x, i) => x / axes[i] ** 2), length = Math.hypot(...gradient);
    const cosine = normal.reduce((sum, n, i) => sum + n * gradient[i] / length, 0);
    page.dataset.clickedSurface = String(line !== shown && level > 0.97 && level < 1.001 && cosine > 0.97);
    const slider = the("radius");
    slider.value = 90;
    slider.dispatchEvent(new Event("input"));
    page.dataset.sliderMoves = String(the("command").textContent.includes(`--radius-mm ${parseFloat(the("radius_mm").textContent)}`));
    checks.lookAtLabels("clicked");
  }
  checks.lookAtColours();
  checks.state();
}
