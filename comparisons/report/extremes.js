// The page of `softfinger extremes`: what each model answered over the decades.
"use strict";

(() => {
  const {report, settings, base, TICK_AT_END, plot, number} = Charts;
  const KINDS = [["valid", "answered, valid", "var(--map-0)"], ["answered", "answered outside its validity", "var(--map-1)"],
    ["refused", "refused", "var(--model-8)"]];

  const power = (value) => {
    const exponent = Math.round(Math.log10(value));
    return Math.abs(exponent) < 3 ? number(value) : `10${String(exponent).replace(/[-0-9]/g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)])}`;
  };

  function drawDecades(width, {element}) {
    const axis = report.axes.find((a) => a.key === settings.axis) ?? report.axes[0];
    const model = report.models.find((m) => m.model === element.dataset.model);
    const bins = model?.decades?.[axis?.key] ?? [];
    if (!bins.length) return null;
    const bars = bins.flatMap((bin) => {
      const all = bin.valid + bin.answered + bin.refused;
      let bottom = 0;
      return KINDS.map(([key, words, colour]) => {
        const part = 100 * bin[key] / all;
        const bar = {x1: bin.from, x2: bin.to, y1: bottom, y2: bottom + part, colour,
          title: `${number(bin.from)} to ${number(bin.to)}\n${words}: ${bin[key]} of ${all}`};
        bottom += part;
        return bar;
      });
    }).filter((bar) => bar.y2 > bar.y1);
    return plot({
      ...base(width, 170), ...TICK_AT_END,
      x: {type: axis.logarithmic ? "log" : "linear", label: `${axis.name} →`, tickFormat: axis.logarithmic ? power : "~g", ticks: 4},
      y: {domain: [0, 100], label: "↑ %", ticks: 4},
      marks: [
        Plot.rect(bars, {x1: "x1", x2: "x2", y1: (b) => b.y1, y2: (b) => b.y2, fill: (b) => b.colour, title: "title", insetLeft: 0.5, insetRight: 0.5}),
        Plot.ruleY([0], {strokeOpacity: 0.4}),
      ],
    });
  }

  Charts.start({decades: drawDecades}, []);
})();
