// The page of `softfinger calibrate`: data and fit, residuals, confidence; the rest is shared.
"use strict";

(() => {
  const {report, present, number, base, TICK_AT_END, plot, tip, legend, stacked} = Charts;

  // Ticks of a logarithmic axis: decades with 2 and 5 between them, as many as fit.
  const ticksOf = ([low, high], room) => {
    const all = d3.range(-12, 13).flatMap((k) => [1, 2, 5].map((m) => Number(`${m}e${k}`)));
    const inside = all.filter((v) => v >= low && v <= high);
    if (inside.length >= 2 && inside.length <= room) return inside;
    const decades = inside.filter((v) => /^1/.test(v.toExponential()));
    if (inside.length > room && decades.length >= 2) return decades;
    return d3.ticks(low, high, Math.min(room, 5));
  };
  const widened = ([low, high], factor) => [low / factor, high * factor];
  const labelOf = (value) => number(value);

  function drawFit(width, {element}) {
    const quantity = report.quantities.find((q) => q.name === element.dataset.quantity);
    if (!quantity) return null;
    const curve = quantity.curve.filter((p) => p.value > 0);
    const band = curve.filter((p) => p.low > 0 && present(p.high));
    const points = quantity.points.map((p) => ({
      ...p, x: p.load, y: p.measured, low: p.measured - 2 * p.std, high: p.measured + 2 * p.std,
      title: () => `${number(p.load)} N: ${number(p.measured)} ${quantity.unit}\nfit ${number(p.predicted)} ${quantity.unit}, ${number(Number(p.sigma.toPrecision(2)))} σ${p.outlier ? "\nleft out" : ""}`,
    }));
    const seen = [...points.map((p) => p.measured), ...points.flatMap((p) => (p.outlier ? [] : [p.low, p.high])), ...curve.map((p) => p.value)].filter((v) => v > 0);
    if (!seen.length) return null;
    const range = widened(d3.extent(seen), 1.12);
    const domain = d3.extent([...points.map((p) => p.load), ...curve.map((p) => p.load)]);
    const shown = domain[0] < domain[1] ? domain : widened(domain, 1.5);
    const [used, left] = [points.filter((p) => !p.outlier), points.filter((p) => p.outlier)];
    return plot({
      ...base(width, 290), ...TICK_AT_END, marginLeft: 56,
      x: {type: "log", domain: shown, label: "load, N →", ticks: ticksOf(shown, width / 55), tickFormat: labelOf},
      y: {type: "log", domain: range, label: `↑ ${quantity.label}, ${quantity.unit}`, ticks: ticksOf(range, 7), tickFormat: labelOf, clamp: true},
      marks: [
        Plot.areaY(band, {x: "load", y1: "low", y2: "high", fill: quantity.colour, fillOpacity: 0.35, clip: true}),
        Plot.line(curve, {x: "load", y: "value", stroke: quantity.colour, strokeWidth: 1.25}),
        Plot.link(used.filter((p) => p.low > 0), {x1: "x", x2: "x", y1: "low", y2: "high", stroke: "var(--ink)", strokeOpacity: 0.6, clip: true}),
        Plot.dot(used, {x: "x", y: "y", r: 3.5, fill: "var(--ink)"}),
        Plot.dot(left, {x: "x", y: "y", r: 5, symbol: "times", stroke: "var(--bad)", strokeWidth: 2}),
        tip(points),
      ],
    });
  }

  function drawResiduals(width) {
    const points = report.quantities.flatMap((quantity) => quantity.points.filter((p) => present(p.sigma)).map((p) => ({
      x: p.load, y: p.sigma, colour: quantity.colour, outlier: p.outlier,
      title: () => `${quantity.label} at ${number(p.load)} N\n${number(Number(p.sigma.toPrecision(2)))} σ${p.outlier ? ", left out" : ""}`,
    })));
    if (!points.length) return null;
    // Outliers far away would flatten all others: they stand at the edge.
    const used = points.filter((p) => !p.outlier);
    const reach = Math.max(3, 1.15 * (d3.max(used, (p) => Math.abs(p.y)) ?? 0), Math.min(5, 1.1 * d3.max(points, (p) => Math.abs(p.y))));
    const domain = d3.extent(points, (p) => p.x);
    const shown = domain[0] < domain[1] ? widened(domain, 1.1) : widened(domain, 1.5);
    const inside = (p) => ({...p, y: Math.max(-reach, Math.min(reach, p.y))});
    const picture = plot({
      ...base(width, 260), ...TICK_AT_END,
      x: {type: "log", domain: shown, label: "load, N →", ticks: ticksOf(shown, width / 55), tickFormat: labelOf},
      y: {domain: [-reach, reach], label: "↑ residual, σ", ticks: 7},
      marks: [
        Plot.ruleY([-1.96, 1.96], {strokeOpacity: 0.6, strokeDasharray: "4 3"}),
        Plot.ruleY([0], {strokeOpacity: 0.5}),
        Plot.dot(used, {x: "x", y: "y", r: 4, fill: "colour"}),
        Plot.dot(points.filter((p) => p.outlier).map(inside), {x: "x", y: "y", r: 5, symbol: "times", stroke: "colour", strokeWidth: 2}),
        tip(points.map(inside)),
      ],
    });
    return stacked(picture, legend(report.quantities.map(({label, colour}) => ({label, colour}))));
  }

  function drawConfidence(width, {element}) {
    const ellipse = report.ellipses[Number(element.dataset.ellipse)];
    if (!ellipse || ellipse.points.length < 3) return null;
    const {x, y, points} = ellipse;
    const axis = (of, place, room, arrow) => {
      const values = points.map((p) => p[place]);
      const [low, high] = d3.extent(values);
      // Intervals that go on for ever must not flatten the ellipse.
      const reach = of.logarithmic ? [low / (high / low) ** 0.4, high * (high / low) ** 0.4] : [low - 0.4 * (high - low), high + 0.4 * (high - low)];
      const domain = d3.extent([low, high, Math.max(reach[0], of.low ?? low), Math.min(reach[1], of.high ?? high)]);
      const pad = of.logarithmic ? (domain[1] / domain[0]) ** 0.06 : 0.06 * (domain[1] - domain[0]);
      const shown = of.logarithmic ? [domain[0] / pad, domain[1] * pad] : [domain[0] - pad, domain[1] + pad];
      return {type: of.logarithmic ? "log" : "linear", domain: shown, label: arrow(of.label), ticks: of.logarithmic ? ticksOf(shown, room) : Math.min(room, 5), tickFormat: labelOf};
    };
    const across = axis(x, 0, Math.max(3, width / 70), (words) => `${words} →`), up = axis(y, 1, 7, (words) => `↑ ${words}`);
    const inside = ([low, high], value, otherwise) => Math.max(low, Math.min(high, value ?? otherwise));
    const box = [{
      x1: inside(across.domain, x.low, across.domain[0]), x2: inside(across.domain, x.high, across.domain[1]),
      y1: inside(up.domain, y.low, up.domain[0]), y2: inside(up.domain, y.high, up.domain[1]),
    }];
    const best = [{x: x.value, y: y.value, title: () => `${x.label}: ${number(x.value)}\n${y.label}: ${number(y.value)}`}];
    return plot({
      ...base(width, 300), ...TICK_AT_END, marginLeft: 60,
      x: across, y: up,
      marks: [
        Plot.rect(box, {x1: "x1", x2: "x2", y1: "y1", y2: "y2", stroke: "var(--muted)", strokeDasharray: "4 3", fill: "none"}),
        Plot.line(points, {x: (p) => p[0], y: (p) => p[1], curve: "linear-closed", stroke: "var(--model-1)", strokeWidth: 2, fill: "var(--model-1)", fillOpacity: 0.12}),
        Plot.dot(best, {x: "x", y: "y", r: 4.5, fill: "var(--ink)"}),
        tip(best),
      ],
    });
  }

  Charts.start({fit: drawFit, residuals: drawResiduals, confidence: drawConfidence}, []);
})();
