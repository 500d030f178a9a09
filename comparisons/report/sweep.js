// The page of `softfinger sweep`: one picture, whose axes, quantity and models the reader chooses.
"use strict";

(() => {
  const {report, styleOf, number, magnitude, percent, ramp, base, plot, tip, legend, stacked, start} = Charts;
  const page = document.documentElement;

  // Values of a variable that a slider or a row of pictures can carry; more are drawn as points.
  const FEW = 60, FACETS = 6;
  const BANDS = [0.01, 0.05, 0.1, 0.25]; // of the deviation, as on the maps of the error atlas
  const SHADES = 40;

  // Columns are decoded when they are drawn: most of them never are.
  const bytesOf = (text) => {
    const characters = atob(text);
    const bytes = new Uint8Array(characters.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
    return bytes;
  };
  const floats = (text) => new Float32Array(bytesOf(text).buffer);
  const remembered = (make) => {
    const known = new Map();
    return (key) => known.get(key) ?? known.set(key, make(key)).get(key);
  };
  const sources = new Map(report.sources.map((s) => [s.name, {
    name: s.name,
    style: styleOf(s.name),
    values: remembered((quantity) => floats(s.values[quantity])),
    errors: remembered((quantity) => (s.errors[quantity] ? floats(s.errors[quantity]) : null)),
    valid: bytesOf(s.valid),
  }]));
  const fem = sources.get("fem");
  const models = [...sources.values()].filter((s) => s !== fem);
  const allRows = d3.range(report.rows);

  const variables = report.variables.map((v) => {
    const values = floats(v.values);
    const levels = d3.sort(new Set(values.filter((value) => Number.isFinite(value))));
    // 0.49995 is not 0.49999: as many digits as tell the values apart.
    const digits = levels.length > FEW ? 4 : d3.range(4, 8).find((count) => new Set(levels.map(d3.format(`.${count}~r`))).size === levels.length) ?? 7;
    const words = d3.format(`.${digits}~r`);
    const order = new Map(levels.map((level, i) => [level, i]));
    return {
      ...v, values, levels, words,
      log: v.log && levels[0] > 0,
      level: Int32Array.from(values, (value) => order.get(value) ?? -1), // of each row
      title: v.unit ? `${v.label}, ${v.unit}` : v.label,
      says: (value) => `${v.label} ${words(value)}${v.unit ? ` ${v.unit}` : ""}`,
    };
  });
  const named = new Map(variables.map((v) => [v.key, v]));
  const varying = variables.filter((v) => v.levels.length > 1);

  // Zipped keys, and random ones: the value of one tells the other's.
  const together = (u, v) => {
    if (u.levels.length !== v.levels.length) return false;
    const partner = new Map();
    return allRows.every((row) => {
      const known = partner.get(u.level[row]);
      if (known === undefined) partner.set(u.level[row], v.level[row]);
      return known === undefined || known === v.level[row];
    });
  };
  const few = varying.filter((v) => v.levels.length <= FEW);

  // How many of the pairs of values there are, were they a grid: 1 for a whole one.
  const fill = (rows, u, v) => {
    const pairs = new Set(rows.map((row) => u.level[row] * v.levels.length + v.level[row]));
    return pairs.size / (new Set(rows.map((row) => u.level[row])).size * new Set(rows.map((row) => v.level[row])).size);
  };

  const keys = varying.filter((v) => v.key !== "load_N");
  const load = varying.find((v) => v.key === "load_N");
  const [first, second] = keys.length ? keys : varying;
  const flat = keys.length > 1 && (keys.length === 2 ? !monotone(allRows, first, [second]) : fill(allRows, first, second) > 0.5 && keys.length < 5);
  const usable = sources.get(report.first) ?? models[0] ?? fem;
  const state = {
    picture: flat ? "map" : "curves",
    quantity: "max_torque",
    show: fem && flat ? "deviation" : "value",
    x: (first ?? variables.find((v) => v.levels.length) ?? variables[0])?.key,
    y: (second ?? load)?.key,
    colour: "model",
    facet: load && load !== first && load.levels.length <= FEW ? load.key : "",
    model: usable?.name,
    models: new Set(sources.keys()),
    level: new Map(few.map((v) => [v.key, Math.floor((v.levels.length - 1) / 2)])), // -1: all
  };
  // Points that follow no line: one model, coloured by another key.
  if (keys.length > 2 && !flat) state.colour = second.levels.length > FEW || !together(first, second) ? second.key : "model";

  const oneModel = () => state.picture === "map" || state.colour !== "model";
  const deviates = () => fem && state.show === "deviation";
  const quantity = () => report.quantities.find((q) => q.name === state.quantity);
  const quantityTitle = () => (deviates() ? `${quantity().label}: deviation from FEM` : `${quantity().label}, ${quantity().unit}`);
  const valueOf = (source) => {
    const values = source.values(state.quantity);
    if (!deviates()) return (row) => values[row];
    const reference = fem.values(state.quantity);
    return (row) => values[row] / reference[row] - 1;
  };
  const said = (value) => (deviates() ? percent(value) : `${number(value)} ${quantity().unit}`);

  const placed = () => (state.picture === "map" ? [state.x, state.y] : [state.x, state.colour, state.facet]).map((key) => named.get(key)).filter((v) => v);
  // The variables that sliders hold: those on no axis that no axis tells.
  function held() {
    const settled = placed(), list = [];
    for (const v of few)
      if (![...settled, ...list].some((other) => other === v || together(other, v))) list.push(v);
    return list;
  }
  function chosenRows() {
    const limits = held().map((v) => [v.level, state.level.get(v.key)]).filter(([, level]) => level >= 0);
    const rows = allRows.filter((row) => limits.every(([levels, level]) => levels[row] === level));
    const axes = placed(), x = named.get(state.x);
    const shown = rows.filter((row) => [x, ...axes].every((v) => v.level[row] >= 0));
    state.without = rows.length - shown.length;
    return shown;
  }
  const withoutText = () => (state.without ? `Not drawn: ${state.without} without a finite value on an axis.` : "");

  // Rows that are a line over x: each x once, and everything else that changes goes one way with it.
  function monotone(rows, x, others) {
    const sorted = d3.sort(rows, (row) => x.values[row]);
    return sorted.every((row, i) => i === 0 || x.level[row] > x.level[sorted[i - 1]]) && others.every((v) => {
      const steps = d3.pairs(sorted, (one, next) => v.level[next] - v.level[one]);
      return steps.every((step) => step >= 0) || steps.every((step) => step <= 0);
    });
  }

  // Ticks at 1, 2, 5 of every decade, or fewer, so that no two labels meet.
  function logTicks([low, high], most) {
    const among = (steps, every = 1) => d3.range(Math.floor(Math.log10(low)), Math.ceil(Math.log10(high)) + 1)
      .filter((power) => power % every === 0).flatMap((power) => steps.map((step) => Number(`${step}e${power}`)))
      .filter((value) => value >= low * (1 - 1e-6) && value <= high * (1 + 1e-6));
    const ticks = [among([1, 2, 5]), among([1, 3]), among([1]), among([1], 2), among([1], 3)].find((list) => list.length <= most) ?? [];
    return ticks.length > 1 ? ticks : d3.ticks(low, high, Math.min(4, most));
  }
  const ticksOf = (log, domain, most) => (log ? logTicks(domain, most) : d3.ticks(...domain, most - 1));
  // A single value in the middle of an axis of its own.
  const widened = ([low, high], log, part) => {
    if (log) return [low / (high / low) ** part, high * (high / low) ** part];
    return [low - part * (high - low), high + part * (high - low)];
  };
  const opened = ([low, high], log) => (low < high ? [low, high] : log ? [low / 2, low * 2] : low === 0 ? [-1, 1] : d3.sort([0.5 * low, 1.5 * low]));
  const spread = (values) => values[0] > 0 && values.at(-1) / values[0] > 20;

  // Ticks may be closer than four digits tell.
  const wordsOf = (ticks) => (new Set(ticks.map(number)).size === ticks.length ? number : (value) => String(Number(value.toPrecision(9))));
  const fitting = (words, width) => {
    const most = Math.max(8, Math.floor(width / 7.5));
    return words.length <= most ? words : `${words.slice(0, Math.floor(most / 2) - 1)}…${words.slice(words.length - Math.ceil(most / 2) + 1)}`;
  };
  // The x axis, and the margin that its last label needs.
  function across(v, domain, width, marginLeft) {
    const inner = width - marginLeft - 12;
    const choices = d3.range(Math.max(2, Math.floor(inner / 64)), 1, -1).map((most) => {
      const ticks = ticksOf(v.log, domain, most), words = wordsOf(ticks);
      return {ticks, words, longest: d3.max([0, ...ticks.map((tick) => words(tick).length)])};
    });
    const {ticks, words, longest} = choices.find((c) => c.ticks.length * (7.5 * c.longest + 12) <= inner) ?? choices.at(-1);
    return {
      marginLeft, marginRight: Math.max(12, 4 * longest),
      x: {type: v.log ? "log" : "linear", domain, label: fitting(`${v.title} →`, width), grid: false, ticks, tickFormat: words},
    };
  }
  const leftOf = (ticks, words) => 18 + 7 * d3.max([3, ...ticks.map((tick) => words(tick).length)]);

  // One path for all points of a colour: 20,000 elements would take seconds, one takes milliseconds.
  let clips = 0;
  const path = (makePath, attributes) => (_, scales, __, {width, height, marginLeft, marginRight, marginTop, marginBottom}) => {
    const id = `frame-${++clips}`;
    const group = d3.create("svg:g").attr("clip-path", `url(#${id})`);
    group.append("clipPath").attr("id", id).append("rect").attr("x", marginLeft - 5).attr("y", marginTop - 5)
      .attr("width", width - marginLeft - marginRight + 10).attr("height", height - marginTop - marginBottom + 10);
    const drawn = group.append("path").attr("d", makePath(scales)).attr("fill", "none");
    for (const [name, value] of Object.entries(attributes)) drawn.attr(name, value);
    return group.node();
  };
  const short = (value) => value.toFixed(1);
  const dots = (points, colour, size, opacity = 1) => path(
    ({x, y}) => points.map((p) => `M${short(x(p.x))},${short(y(p.y))}h0`).join(""),
    {stroke: colour, "stroke-width": size, "stroke-linecap": "round", "stroke-opacity": opacity, class: "points"});
  const lineParts = (points, wanted) => ({x, y}) => d3.pairs(points)
    .filter(([one, next]) => !Number.isNaN(one.y) && !Number.isNaN(next.y) && (one.valid && next.valid) === wanted)
    .map(([one, next]) => `M${short(x(one.x))},${short(y(one.y))}L${short(x(next.x))},${short(y(next.y))}`).join("");

  const told = (source, row, value) => [
    `${source.style.label}: ${said(value)}${source.valid[row] ? "" : " (not usable)"}`,
    ...variables.filter((v) => Number.isFinite(v.values[row])).map((v) => v.says(v.values[row])),
  ].join("\n");

  // Curves over x -------------------------------------------------------------------------------

  function seriesOf(rows, x) {
    const colourBy = named.get(state.colour);
    const list = [];
    const add = (source, members, style) => {
      const value = valueOf(source);
      const errors = source === fem && !deviates() ? fem.errors(state.quantity) : null;
      const free = varying.filter((v) => v !== x);
      const points = d3.sort(members, (row) => x.values[row]).map((row) => {
        const y = value(row);
        return {x: x.values[row], y, row, valid: source.valid[row] === 1, error: errors ? errors[row] * y : 0, title: () => told(source, row, y)};
      });
      if (points.some((p) => Number.isFinite(p.y))) list.push({source, style, points, line: points.length > 1 && monotone(members, x, free)});
    };
    if (!colourBy) {
      for (const source of [...models, fem])
        if (source && state.models.has(source.name) && !(source === fem && deviates())) add(source, rows, source.style);
      return list;
    }
    const source = sources.get(state.model);
    if (!source) return list;
    if (colourBy.levels.length > FEW) {
      add(source, rows, {label: source.style.label, shade: shadesOf(rows.map((row) => colourBy.values[row]), colourBy.log)});
      return list;
    }
    const members = d3.group(rows, (row) => colourBy.level[row]);
    colourBy.levels.forEach((level, i) => {
      if (members.has(i)) add(source, members.get(i), {label: colourBy.says(level), colour: ramp(i / Math.max(1, colourBy.levels.length - 1))});
    });
    return list;
  }

  // The frame holds the finite elements and the models where their assumptions hold. Other values widen it on either side by at most half its height.
  function valueRange(series) {
    const all = [], trusted = [];
    for (const {source, points} of series)
      for (const p of points) {
        if (!Number.isFinite(p.y)) continue;
        for (const y of [p.y - p.error, p.y + p.error]) {
          if (Number.isNaN(y)) continue;
          all.push(y);
          if (p.valid || source === fem) trusted.push(y);
        }
      }
    const [low, high] = d3.extent(trusted.length ? trusted : all);
    const [least, most] = d3.extent(all);
    const log = !deviates() && least > 0 && spread([low, high]);
    const [from, to] = widened([low, high], log, 0.5);
    if (deviates()) // zero is always in it, more than 100 % hardly
      return {log, domain: [Math.max(-1, Math.min(-0.02, Math.max(least, from))), Math.min(Math.max(1, 1.5 * low), Math.max(0.02, Math.min(most, to)))]};
    return {log, domain: widened(opened([Math.max(least, from), Math.min(most, to)], log), log, 0.04)};
  }

  function drawCurves(width) {
    const x = named.get(state.x), facetBy = named.get(state.facet);
    const rows = chosenRows();
    const picked = facetBy ? d3.range(Math.min(FACETS, facetBy.levels.length)).map((k, _, {length}) =>
      (length > 1 ? Math.round(k * (facetBy.levels.length - 1) / (length - 1)) : 0)) : [null];
    const facets = picked.map((level) => ({
      title: level === null ? "" : facetBy.says(facetBy.levels[level]),
      series: seriesOf(level === null ? rows : rows.filter((row) => facetBy.level[row] === level), x),
    }));
    const everything = facets.flatMap((f) => f.series);
    if (!everything.length) return null;
    const {log, domain} = valueRange(everything);
    const reach = opened(d3.extent(everything.flatMap((s) => s.points), (p) => p.x), x.log);
    const columns = Math.min(facets.length, width >= 900 ? 3 : width >= 560 ? 2 : 1);
    const each = Math.floor((width - 22 * (columns - 1)) / columns);
    const height = facets.length > 1 ? 260 : 380;
    const ticks = ticksOf(log, domain, 7);
    const words = deviates() ? (v) => `${number(100 * v)} %` : wordsOf(ticks);
    const marginLeft = leftOf(ticks, words);
    const single = oneModel();
    let marks = 0, outside = 0, doubted = 0;
    const pictures = facets.map(({title, series}) => {
      const points = series.flatMap((s) => s.points.filter((p) => Number.isFinite(p.y)));
      const inside = points.filter((p) => p.y >= domain[0] && p.y <= domain[1]);
      marks += points.length;
      outside += points.length - inside.length;
      doubted += points.filter((p) => !p.valid).length;
      const picture = plot({
        ...base(each, height), ...across(x, widened(reach, x.log, 0.02), each, marginLeft),
        y: {type: log ? "log" : "linear", domain, label: fitting(`↑ ${quantityTitle()}`, each), ticks, tickFormat: words},
        marks: [
          ...(deviates() ? [Plot.ruleY([0], {strokeOpacity: 0.6})] : []),
          ...series.flatMap((s) => marksOf(s)),
          tip(inside),
        ],
      });
      if (facets.length === 1) return picture;
      const heading = document.createElement("h4");
      heading.textContent = title;
      return stacked(heading, picture);
    });
    const grid = document.createElement("div");
    grid.className = "facets";
    grid.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    grid.append(...pictures);
    const shades = everything[0].style.shade;
    const styles = d3.groups(everything, (s) => s.style.label).map(([, [s]]) => s.style);
    const colourBy = named.get(state.colour);
    caption([
      single ? `${sources.get(state.model).style.label}.` : "",
      heldText(),
      facetBy && facetBy.levels.length > picked.length ? `${picked.length} of ${facetBy.levels.length} values of ${facetBy.label} are drawn.` : "",
      everything.some((s) => s.source === fem) ? "Points with bars: finite elements and the error they state." : "",
      doubted ? "Dashed or faint: where a model’s assumptions fail." : "",
      withoutText(),
      outside ? `${outside} of ${marks} points lie beyond the frame.` : "",
    ]);
    state.marks = marks;
    return stacked(grid, shades ? colourBar(width, shades, colourBy.title)
      : styles.length > 12 ? colourBar(width, shadesOf(colourBy.levels, colourBy.log), colourBy.title) : legend(styles));
  }

  function marksOf({source, style, points, line}) {
    const known = points.filter((p) => Number.isFinite(p.y));
    const size = known.length > 5000 ? 2.5 : known.length > 500 ? 3.5 : 5;
    if (style.shade) {
      const shown = points.map((p) => ({...p, shade: style.shade.of(named.get(state.colour).values[p.row])})).filter((p) => Number.isFinite(p.y));
      return d3.groups(shown, (p) => p.shade, (p) => p.valid).flatMap(([shade, parts]) =>
        parts.map(([valid, group]) => dots(group, shade, size, valid ? 0.9 : 0.3)));
    }
    if (source === fem)
      return [
        path(({x, y}) => known.filter((p) => p.error > 0).map((p) => `M${short(x(p.x))},${short(y(p.y - p.error))}V${short(y(p.y + p.error))}`).join(""),
          {stroke: style.colour, "stroke-width": 1.5}),
        dots(known, style.colour, size + 1.5),
      ];
    const [valid, doubted] = [known.filter((p) => p.valid), known.filter((p) => !p.valid)];
    const small = line ? (known.length > FEW ? 0 : 4) : size;
    return [
      ...(line ? [
        path(lineParts(points, true), {stroke: style.colour, "stroke-width": 2}),
        path(lineParts(points, false), {stroke: style.colour, "stroke-width": 1.5, "stroke-dasharray": "3 3", "stroke-opacity": 0.7}),
      ] : []),
      ...(small ? [dots(valid, style.colour, small), dots(doubted, style.colour, small, 0.4)] : []),
    ];
  }

  // Map over x and y ----------------------------------------------------------------------------

  function shadesOf(values, log) {
    const known = values.filter((value) => Number.isFinite(value));
    const [low, high] = d3.extent(known);
    const place = log ? d3.scaleLog().domain([low, high]) : d3.scaleLinear().domain([low, high]);
    const shade = (value) => Math.min(SHADES - 1, Math.floor(SHADES * (low < high ? place.range([0, 1])(value) : 0.5)));
    return {low, high, log, of: (value) => ramp((shade(value) + 0.5) / SHADES)};
  }

  function colourBar(width, {low, high, log}, title, marks) {
    const wide = Math.min(width - 40, 520), left = 20;
    const words = wordsOf(log ? [low, high] : d3.ticks(low, high, 8));
    const svg = d3.create("svg").attr("width", width).attr("height", 52).attr("viewBox", `0 0 ${width} 52`).style("font-size", "12px");
    svg.append("text").attr("x", left).attr("y", 11).attr("fill", "currentColor").text(fitting(title, width - left));
    for (let k = 0; k < SHADES; ++k)
      svg.append("rect").attr("x", left + k * wide / SHADES).attr("y", 17).attr("width", wide / SHADES + 0.5).attr("height", 12).attr("fill", ramp((k + 0.5) / SHADES));
    const ticks = low < high ? marks ?? ticksOf(log, [low, high], Math.floor(wide / 52)) : [];
    const place = (log ? d3.scaleLog() : d3.scaleLinear()).domain([low, high]).range([left, left + wide]);
    const label = (x, value) => svg.append("text").attr("x", x).attr("y", 46).attr("text-anchor", "middle").attr("fill", "currentColor").text(words(value));
    let last = -Infinity;
    for (const tick of ticks) {
      svg.append("path").attr("d", `M${place(tick)},17v15`).attr("stroke", "currentColor");
      if (place(tick) - last < 46) continue;
      label(last = place(tick), tick);
    }
    if (!ticks.length) label(left + wide / 2, low);
    return svg.node();
  }

  // Where the lines between neighbours pass a value: straight in the picture, none across a missing cell.
  function contour(corner, columns, rows, limit) {
    const parts = [];
    for (let i = 0; i + 1 < columns; ++i)
      for (let j = 0; j + 1 < rows; ++j) {
        const corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        if (corners.some((c) => !c || !Number.isFinite(c.z))) continue;
        const passes = corners.map((one, k) => [one, corners[(k + 1) % 4]]).filter(([one, next]) => (one.z >= limit) !== (next.z >= limit))
          .map(([one, next]) => {
            const part = (limit - one.z) / (next.z - one.z);
            return `${short(one.x + part * (next.x - one.x))},${short(one.y + part * (next.y - one.y))}`;
          });
        for (let k = 0; k + 1 < passes.length; k += 2) parts.push(`M${passes[k]}L${passes[k + 1]}`);
      }
    return parts.join("");
  }

  function drawMap(width) {
    const x = named.get(state.x), y = named.get(state.y), source = sources.get(state.model);
    if (!x || !y || !source || (source === fem && deviates())) return null;
    const rows = chosenRows();
    const value = valueOf(source);
    const points = rows.map((row) => {
      const z = value(row);
      return {x: x.values[row], y: y.values[row], z, row, valid: source.valid[row] === 1, title: () => (Number.isFinite(z) ? told(source, row, z) : "no answer")};
    });
    const known = points.filter((p) => Number.isFinite(p.z));
    if (!known.length) return null;
    const extent = d3.extent(known, (p) => p.z);
    const log = !deviates() && spread(extent);
    const shades = shadesOf(known.map((p) => p.z), log);
    const band = (error) => `var(--map-${d3.bisectRight(BANDS, Math.abs(error))})`;
    const colour = deviates() ? (p) => band(p.z) : (p) => shades.of(p.z);

    const [columns, lines] = [x, y].map((v, k) => d3.sort(new Set(points.map((p) => (k ? p.y : p.x)))));
    const cells = columns.length > 1 && lines.length > 1 && points.length > 0.5 * columns.length * lines.length &&
      new Set(points.map((p) => x.level[p.row] * y.levels.length + y.level[p.row])).size === points.length;
    const halfway = (v) => (one, next) => (v.log ? Math.sqrt(one * next) : (one + next) / 2);
    const edges = (v, values) => {
      const inner = d3.pairs(values, halfway(v));
      const mirrored = (value, edge) => (v.log ? value * value / edge : 2 * value - edge);
      return [mirrored(values[0], inner[0]), ...inner, mirrored(values.at(-1), inner.at(-1))];
    };
    const [xEdges, yEdges] = cells ? [edges(x, columns), edges(y, lines)] : [];
    const domain = (v, values, marks) => (marks ? [marks[0], marks.at(-1)] : widened(opened(d3.extent(values), v.log), v.log, 0.02));
    const yDomain = domain(y, lines, yEdges);
    const yTicks = ticksOf(y.log, yDomain, 8);
    const yWords = wordsOf(yTicks);
    const marginLeft = leftOf(yTicks, yWords);
    const limits = deviates() || !(extent[0] < extent[1]) ? [] : ticksOf(log, extent, Math.max(3, Math.floor(Math.min(width - 40, 520) / 60)));

    const marks = [];
    const size = known.length > 5000 ? 3 : known.length > 500 ? 5 : 8;
    if (cells) {
      const column = new Map(columns.map((v, i) => [v, i])), line = new Map(lines.map((v, i) => [v, i]));
      const at = new Map(known.map((p) => [column.get(p.x) * lines.length + line.get(p.y), p]));
      const cell = (i, j) => (i < 0 || j < 0 || i >= columns.length || j >= lines.length ? undefined : at.get(i * lines.length + j));
      for (const [shade, group] of d3.group(known, colour))
        marks.push(path((scales) => group.map((p) => {
          const [i, j] = [column.get(p.x), line.get(p.y)];
          const [left, right, bottom, top] = [scales.x(xEdges[i]), scales.x(xEdges[i + 1]), scales.y(yEdges[j]), scales.y(yEdges[j + 1])];
          return `M${short(left)},${short(top)}H${short(right)}V${short(bottom)}H${short(left)}Z`;
        // The stroke closes the hairlines that rounding leaves between cells.
        }).join(""), {fill: shade, stroke: shade, "stroke-width": 0.7, class: "cells"}));
      if (columns.length > 3 && lines.length > 3 && limits.length)
        marks.push(path((scales) => {
          const corner = (i, j) => {
            const p = cell(i, j);
            return p && {x: scales.x(p.x), y: scales.y(p.y), z: log ? Math.log(p.z) : p.z};
          };
          return limits.map((limit) => contour(corner, columns.length, lines.length, log ? Math.log(limit) : limit)).join("");
        }, {stroke: "var(--page)", "stroke-opacity": 0.75, "stroke-width": 1.2}));
      if (source !== fem && known.some((p) => p.valid) && known.some((p) => !p.valid)) {
        const limit = (scales) => known.filter((p) => p.valid).map((p) => {
          const [i, j] = [column.get(p.x), line.get(p.y)];
          const [left, right, bottom, top] = [scales.x(xEdges[i]), scales.x(xEdges[i + 1]), scales.y(yEdges[j]), scales.y(yEdges[j + 1])].map(short);
          const beyond = (di, dj) => cell(i + di, j + dj)?.valid === false;
          return (beyond(-1, 0) ? `M${left},${bottom}V${top}` : "") + (beyond(1, 0) ? `M${right},${bottom}V${top}` : "") +
            (beyond(0, -1) ? `M${left},${bottom}H${right}` : "") + (beyond(0, 1) ? `M${left},${top}H${right}` : "");
        }).join("");
        // On a seam in the page's colour the line is seen on every shade.
        marks.push(path(limit, {stroke: "var(--page)", "stroke-width": 4, "stroke-opacity": 0.7}), path(limit, {stroke: "var(--ink)", "stroke-width": 2, "stroke-dasharray": "5 3"}));
      }
    } else {
      marks.push(dots(points.filter((p) => !Number.isFinite(p.z)), "var(--muted)", 2));
      for (const [shade, parts] of d3.groups(known, colour, (p) => p.valid))
        for (const [valid, group] of parts) marks.push(dots(group, shade, size, valid || source === fem ? 1 : 0.35));
    }
    const picture = plot({
      ...base(width, Math.max(260, Math.min(460, 0.75 * width))), ...across(x, domain(x, columns, xEdges), width, marginLeft),
      y: {type: y.log ? "log" : "linear", domain: yDomain, label: fitting(`↑ ${y.title}`, width), ticks: yTicks, tickFormat: yWords, grid: false},
      marks: [...marks, tip(points, {maxRadius: 200})],
    });
    const valid = known.filter((p) => p.valid).length;
    caption([
      `${source.style.label}.`, heldText(),
      source === fem ? "" : `It is usable in ${valid} of ${known.length} points${
        valid === 0 || valid === known.length ? "" : cells ? ": the dashed line parts them from the others" : "; the others are faint"}.`,
      known.length < points.length ? `${points.length - known.length} without an answer are ${cells ? "empty" : "small and grey"}.` : "",
      withoutText(),
      cells && limits.length && columns.length > 3 && lines.length > 3 ? "Thin lines: the values marked on the scale." : "",
    ]);
    state.marks = known.length;
    const bandWords = ["below 1 %", "1 to 5 %", "5 to 10 %", "10 to 25 %", "above 25 %"];
    return stacked(picture, deviates() ? legend(bandWords.map((words, k) => ({label: words, colour: `var(--map-${k})`})))
      : colourBar(width, shades, quantityTitle(), limits));
  }

  // What the picture says in words, and what the reader chooses -----------------------------------

  const heldText = () => {
    const parts = held().filter((v) => state.level.get(v.key) >= 0).map((v) => v.says(v.levels[state.level.get(v.key)]));
    return parts.length ? `At ${parts.join(", ")}.` : "";
  };
  function caption(sentences) {
    const title = document.createElement("b");
    const over = named.get(state.x)?.label;
    const words = `${quantityTitle()} over ${over}${state.picture === "map" ? ` and ${named.get(state.y).label}` : ""}. `;
    // a and b are symbols, not words.
    title.textContent = /^[a-z][a-z]/.test(words) ? words[0].toUpperCase() + words.slice(1) : words;
    document.getElementById("said").replaceChildren(title, sentences.filter((s) => s).join(" "));
  }

  function draw(width) {
    state.marks = 0;
    document.getElementById("said").replaceChildren();
    const picture = state.x === undefined || !sources.size ? null : state.picture === "map" ? drawMap(width) : drawCurves(width);
    page.dataset.picture = state.picture;
    page.dataset.marks = String(state.marks);
    return picture;
  }

  let redraw = () => {};
  const controls = document.getElementById("controls");
  function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
  }
  function buttons(label, options, press) {
    const row = element("div", {className: "loads"}, element("span", {textContent: label}));
    row.setAttribute("role", "group");
    row.setAttribute("aria-label", label);
    for (const {value, words, pressed} of options) {
      const button = element("button", {type: "button", textContent: words, onclick: () => change(() => press(value), `${label} ${words}`)});
      button.setAttribute("aria-pressed", String(pressed));
      button.dataset.name = `${label} ${words}`;
      row.append(button);
    }
    return row;
  }
  function choice(label, options, chosen, choose) {
    const select = element("select", {onchange: () => change(() => choose(select.value), label)},
      ...options.map(([value, words]) => element("option", {value, textContent: words, selected: value === chosen})));
    select.dataset.name = label;
    return element("label", {}, label, select);
  }
  function slider(v, all) {
    const words = () => (state.level.get(v.key) < 0 ? "all" : `${v.words(v.levels[state.level.get(v.key)])} ${v.unit}`);
    const output = element("output", {textContent: words()});
    const input = element("input", {
      type: "range", min: all ? -1 : 0, max: v.levels.length - 1, step: 1,
      oninput: () => {
        state.level.set(v.key, Number(input.value));
        output.textContent = words();
        redraw();
      },
    });
    input.value = state.level.get(v.key);
    return element("label", {}, v.label, input, output);
  }

  // Two axes never show the same variable: who is pushed off takes the other's place.
  function place(name, key) {
    const names = state.picture === "map" ? ["x", "y"] : ["x", "colour", "facet"];
    const other = names.find((n) => n !== name && state[n] === key);
    if (other) state[other] = other === "x" || other === "y" ? state[name] : other === "colour" ? "model" : "";
    if ((other === "x" || other === "y") && !named.has(state[other])) state[other] = varying.find((v) => v.key !== key).key;
    state[name] = key;
  }

  function change(act, name) {
    act();
    if (deviates() && state.model === "fem") state.model = (models[0] ?? fem).name;
    if (state.picture === "map") for (const v of few) state.level.set(v.key, Math.max(0, state.level.get(v.key)));
    offer();
    redraw();
    [...controls.querySelectorAll("[data-name]")].find((e) => e.dataset.name === name)?.focus({preventScroll: true});
  }

  function offer() {
    const map = state.picture === "map";
    const all = varying.map((v) => [v.key, v.label]);
    const fewOnes = few.map((v) => [v.key, v.label]);
    const listed = [...models, ...(fem && !deviates() ? [fem] : [])];
    const rows = [];
    if (varying.length > 1)
      rows.push(buttons("Picture", [{value: "curves", words: "curves", pressed: !map}, {value: "map", words: "map", pressed: map}], (value) => {
        state.picture = value;
        if (value === "map" && (!named.has(state.y) || state.y === state.x)) state.y = varying.find((v) => v.key !== state.x).key;
      }));
    rows.push(buttons("Quantity", report.quantities.map((q) => ({value: q.name, words: q.label, pressed: q.name === state.quantity})), (value) => (state.quantity = value)));
    if (fem && models.length)
      rows.push(buttons("Show", [["value", "values"], ["deviation", "deviation from FEM"]].map(([value, words]) => ({value, words, pressed: value === state.show})), (value) => (state.show = value)));
    if (listed.length > 1)
      rows.push(buttons(oneModel() ? "Model" : "Models", listed.map((s) => ({value: s.name, words: s.style.label, pressed: oneModel() ? s.name === state.model : state.models.has(s.name)})), (value) => {
        if (oneModel()) state.model = value;
        else if (!state.models.delete(value)) state.models.add(value);
      }));
    const axes = element("div", {className: "loads"});
    if (varying.length > 1) {
      axes.append(choice("Across", all, state.x, (key) => place("x", key)));
      if (map) axes.append(choice("Up", all, state.y, (key) => place("y", key)));
      else {
        axes.append(choice("Colour", [["model", "model"], ...all.filter(([key]) => key !== state.x)], state.colour, (key) => place("colour", key)));
        if (fewOnes.some(([key]) => key !== state.x))
          axes.append(choice("Side by side", [["", "nothing"], ...fewOnes.filter(([key]) => key !== state.x)], state.facet, (key) => place("facet", key)));
      }
      rows.push(axes);
    }
    const sliders = held().map((v) => slider(v, !map));
    if (sliders.length) rows.push(element("div", {className: "loads"}, ...sliders));
    controls.replaceChildren(...rows);
  }

  if (sources.size && state.x !== undefined) offer();
  redraw = start({sweep: draw}, []);
})();
