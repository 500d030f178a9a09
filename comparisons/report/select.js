// The page of `softfinger select`: the stated errors over the load; the rest is shared.
"use strict";

(() => {
  const {report, styleOf, present, number, magnitude, decades, base, plot, tip, legend, stacked} = Charts;

  function drawSweep(width, {load}) {
    const {load_N: loads, models} = report.curves;
    const lines = models.map((m) => ({
      style: styleOf(m.model),
      points: m.worst.map((error, i) => (present(error) && error > 0 ? {
        x: loads[i], y: error, title: () => `${styleOf(m.model).label}\n${number(loads[i])} N: within ${magnitude(error)}`,
      } : {x: loads[i], y: NaN})),
    })).filter((line) => line.points.some((p) => p.y > 0));
    if (!lines.length) return null;
    const known = lines.flatMap((line) => line.points.filter((p) => p.y > 0));
    const range = [0.6 * Math.min(report.tolerance, d3.min(known, (p) => p.y)), 1.6 * Math.max(report.tolerance, d3.max(known, (p) => p.y))];
    const domain = d3.extent(loads);
    const picture = plot({
      ...base(width, 300),
      marginLeft: 60,
      x: {type: "log", domain, label: "load, N →", tickFormat: "~g", ticks: 6},
      y: {type: "log", domain: range, label: "↑ stated error, largest of the chosen quantities",
        ticks: decades(range), tickFormat: (v) => `${Number((100 * v).toPrecision(1))} %`},
      marks: [
        Plot.ruleY([report.tolerance], {strokeOpacity: 0.5, strokeDasharray: "3 3"}),
        Plot.ruleX(report.cases[0].loads.map((l) => l.load_N), {strokeOpacity: 0.15}),
        Plot.ruleX([load.load_N], {stroke: "var(--ink)", strokeWidth: 1.5}),
        ...lines.map((line) => Plot.line(line.points, {x: "x", y: "y", curve: "linear", stroke: line.style.colour, strokeWidth: 2, strokeDasharray: line.style.dash})),
        tip(known),
      ],
    });
    return stacked(picture, legend(lines.map((line) => line.style)));
  }

  Charts.start({sweep: drawSweep}, report.cases);
})();
