// Plays a recorded motion: bodies and contacts in 3-D, the selected contact's forces over time and
// its wrench against its limit. Everything else on the page is HTML already. d3 and Plot are
// scripts of the page; three.js is bundled into this file.
import {
  ArrowHelper, Box3, BufferAttribute, BufferGeometry, CircleGeometry, Color, ConeGeometry,
  CylinderGeometry, DirectionalLight, DoubleSide, FrontSide, Frustum, GridHelper, Group,
  HemisphereLight, LineBasicMaterial, LineLoop, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, Object3D, PerspectiveCamera, Quaternion, Scene, Sphere, Vector3,
  WebGLRenderer,
} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";

const page = document.documentElement;
const element = (id) => document.getElementById(id);
const colourOf = (name) => getComputedStyle(page).getPropertyValue(name).trim();

// --- the recording -----------------------------------------------------------------------------
const data = JSON.parse(element("data").textContent);
function bufferOf(text) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes.buffer;
}
const floats = (text) => new Float32Array(bufferOf(text));
const times = floats(data.time_s);
const poses = floats(data.poses);
const sectionRadii = floats(data.sections.radii);
const last = times.length - 1;

/** Of each frame, the contact of each track: an object of data.columns, or nothing. */
const history = (() => {
  const numbers = floats(data.contacts);
  const offsets = new Uint32Array(bufferOf(data.contact_offsets));
  return d3.range(times.length).map((frame) => {
    const contacts = [];
    for (let at = offsets[frame]; at < offsets[frame + 1]; at += data.columns.length) {
      const contact = Object.fromEntries(data.columns.map((name, i) => [name, numbers[at + i]]));
      contact.f = Math.hypot(contact.f1, contact.f2);
      contacts[contact.track] = contact;
    }
    return contacts;
  });
})();
const allContacts = history.flatMap((contacts) => contacts.filter(Boolean));

// A contact that has reached its limit need not slip: see the table of contacts at the end.
const STICKS = "var(--model-1)", AT_LIMIT = "var(--model-5)", SLIPS = "var(--model-2)";
const stateOf = (contact) => (contact.slips ? "slips" : contact.slides ? "at its limit" : "sticks");
const stateColour = (contact) => (contact.slips ? SLIPS : contact.slides ? AT_LIMIT : STICKS);
const useColour = (use) => d3.interpolateYlOrRd(0.12 + 0.88 * Math.min(1, Math.max(0, use || 0)));

// --- numbers as text ---------------------------------------------------------------------------
const significant = (value) => Number(value.toPrecision(3)).toString().replace("-", "−");
/** The prefix that suits the largest of some values: [factor, "m"]. */
function prefixFor(largest) {
  const prefixes = [[1e-6, "µ"], [1e-3, "m"], [1, ""], [1e3, "k"]];
  const [unit, name] = prefixes.filter(([u]) => largest >= 0.9995 * u).pop() ?? (largest > 0 ? prefixes[0] : [1, ""]);
  return [1 / unit, name];
}
const withUnit = (value, unit) => {
  const [factor, prefix] = prefixFor(Math.abs(value));
  return `${significant(value * factor)}\u00a0${prefix}${unit}`;
};
const niceLength = (length) => {
  const decade = 10 ** Math.floor(Math.log10(length));
  return decade * [1, 2, 5, 10].filter((step) => step * decade <= length * 1.0001).pop();
};
const option = (value, label, isChosen) => {
  const made = new Option(label, value);
  made.selected = isChosen;
  return made;
};

// --- the view ----------------------------------------------------------------------------------
function createView(canvas) {
  Object3D.DEFAULT_UP.set(0, 0, 1);
  const renderer = new WebGLRenderer({canvas, antialias: true});
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const scene = new Scene();
  scene.background = new Color(colourOf("--card"));

  const [low, high] = (data.extent_m ?? [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]).map((p) => new Vector3(...p));
  const centre = low.clone().add(high).multiplyScalar(0.5);
  const motionSize = Math.max(low.distanceTo(high), 1e-6);
  const camera = new PerspectiveCamera(30, 1);
  const light = new DirectionalLight(0xffffff, 1.9);
  camera.add(light, light.target);
  scene.add(camera, new HemisphereLight(0xffffff, 0x8a8f98, 1.7));

  // Bodies that touch something are told apart by colour; of many, the others are but scenery.
  const touching = new Set(data.tracks.flatMap((track) => [track.a, track.b]));
  const palette = ["#8fb8de", "#e8b27d", "#9ccfae", "#d7a3c6", "#d9cf84", "#b3a6d9", "#93d0d6", "#d99a94"];
  const isFew = data.bodies.filter((body) => body.movable).length <= palette.length;
  let coloured = 0;
  const opaque = [];
  const geometries = data.geometries.map((source) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(floats(source.positions), 3));
    geometry.setIndex(new BufferAttribute(
      source.triangles16 ? new Uint16Array(bufferOf(source.triangles16)) : new Uint32Array(bufferOf(source.triangles32)), 1));
    geometry.computeVertexNormals();
    return geometry;
  });
  // What the camera follows: the movable bodies that touch something, or all movable ones. Each is
  // a ball around its shapes.
  const balls = data.bodies.map((body) => {
    const box = new Box3();
    for (const shape of body.shapes) {
      if (shape.half_space) continue;
      const geometry = geometries[shape.geometry];
      geometry.computeBoundingBox();
      const [x, y, z, ...turn] = floats(shape.pose);
      box.union(geometry.boundingBox.clone().applyMatrix4(new Matrix4().compose(new Vector3(x, y, z), new Quaternion(...turn), new Vector3(1, 1, 1))));
    }
    return box.isEmpty() ? null : box.getBoundingSphere(new Sphere());
  });
  const movable = d3.range(data.bodies.length).filter((body) => data.bodies[body].movable && balls[body]);
  const gripped = movable.filter((body) => touching.has(body));
  const followed = gripped.length ? gripped : movable;
  const boxOf = (at) => {
    const box = new Box3();
    for (const body of followed) {
      const first = 7 * (at * data.bodies.length + body);
      const middle = balls[body].center.clone().applyQuaternion(new Quaternion().fromArray(poses, first + 3)).add(new Vector3().fromArray(poses, first));
      box.union(new Sphere(middle, balls[body].radius).getBoundingBox(new Box3()));
    }
    return box;
  };
  const sizeOf = (box) => box.getSize(new Vector3()).length();
  const followedSize = d3.max(times, (_, i) => sizeOf(boxOf(i))) ?? 0;
  // A view of the whole motion would show the objects as specks, and a nearer one would lose them.
  const leavesView = followed.length > 0 && motionSize > 1.6 * followedSize;
  const size = leavesView ? Math.max(1.15 * followedSize, 1e-6) : motionSize; // of the picture
  camera.near = size / 100;
  camera.far = 100 * motionSize;
  light.position.set(-size, size, size); // with the camera: what is looked at is lit
  light.target.position.set(0, 0, -1.8 * size);

  const spacing = niceLength(size / 8);
  const bodies = data.bodies.map((body, index) => {
    const group = new Group();
    const colour = body.movable && (isFew || touching.has(index)) ? palette[coloured++ % palette.length] : body.movable ? "#c3cad3" : "#b4bac2";
    for (const shape of body.shapes) {
      const material = new MeshLambertMaterial({color: shape.half_space ? colourOf("--floor") : colour, side: shape.half_space ? FrontSide : DoubleSide});
      const mesh = new Mesh(geometries[shape.geometry], material);
      const [x, y, z, ...turn] = floats(shape.pose);
      mesh.position.set(x, y, z);
      mesh.quaternion.set(...turn);
      if (shape.half_space) {
        // The grid covers the motion and lies on the lines of the plane's own coordinates.
        material.polygonOffset = true;
        material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
        const cells = Math.min(400, 2 * Math.ceil(1.1 * motionSize / spacing));
        const grid = new GridHelper(cells * spacing, cells, colourOf("--floor-axis"), colourOf("--floor-line"));
        grid.rotation.x = Math.PI / 2;
        const middle = centre.clone().sub(mesh.position).applyQuaternion(mesh.quaternion.clone().invert());
        grid.position.set(spacing * Math.round(middle.x / spacing), spacing * Math.round(middle.y / spacing), 0);
        mesh.add(grid);
      } else {
        opaque.push(material);
      }
      group.add(mesh);
    }
    scene.add(group);
    return group;
  });

  // World axes at a lower corner of the motion.
  const styles = getComputedStyle(document.documentElement);
  for (const [direction, name] of [[[1, 0, 0], "x"], [[0, 1, 0], "y"], [[0, 0, 1], "z"]])
    scene.add(new ArrowHelper(new Vector3(...direction), low, spacing, styles.getPropertyValue(`--axis-${name}`).trim(), 0.25 * spacing, 0.12 * spacing));
  const hasGrid = data.bodies.some((body) => body.shapes.some((shape) => shape.half_space));
  element("scale").innerHTML =
    `${hasGrid ? "grid and axes" : "axes"} ${withUnit(spacing, "m")}: <b style="color:var(--axis-x)">x</b> <b style="color:var(--axis-y)">y</b> <b style="color:var(--axis-z)">z</b>`;

  // Contacts lie between bodies: they are drawn over everything.
  const onTop = (options) => ({depthTest: false, depthWrite: false, transparent: true, ...options});
  const disc = new CircleGeometry(1, 64);
  const rim = new BufferGeometry().setFromPoints(d3.range(64).map((i) => new Vector3(Math.cos(i * Math.PI / 32), Math.sin(i * Math.PI / 32), 0)));
  const shaft = new CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0);
  const tip = new ConeGeometry(1, 1, 20).translate(0, 0.5, 0);
  const makeArrow = (colour) => {
    const arrow = new Group();
    const material = new MeshBasicMaterial(onTop({color: colour}));
    arrow.add(new Mesh(shaft, material), new Mesh(tip, material));
    arrow.children.forEach((part) => (part.renderOrder = 3));
    scene.add(arrow);
    return arrow;
  };
  const UP_OF_ARROW = new Vector3(0, 1, 0);
  const placeArrow = (arrow, origin, vector) => {
    const length = vector.length();
    arrow.visible = length > 5e-3 * size;
    if (!arrow.visible) return;
    const width = Math.min(0.0035 * size, 0.06 * length), head = 6 * width;
    arrow.position.copy(origin);
    arrow.quaternion.setFromUnitVectors(UP_OF_ARROW, vector.divideScalar(length));
    arrow.children[0].scale.set(width, length - head, width);
    arrow.children[1].scale.set(2.6 * width, head, 2.6 * width);
    arrow.children[1].position.y = length - head;
  };
  const markers = data.tracks.map(() => {
    const marker = new Group();
    const fill = new Mesh(disc, new MeshBasicMaterial(onTop({side: DoubleSide, opacity: 0.75})));
    const edge = new LineLoop(rim, new LineBasicMaterial(onTop({color: colourOf("--normal-force")})));
    fill.renderOrder = 1;
    edge.renderOrder = 2;
    marker.add(fill, edge);
    scene.add(marker);
    return {marker, fill, edge, normal: makeArrow(colourOf("--normal-force")), tangential: makeArrow("#b0306a")};
  });

  const largestAxis = d3.max(allContacts, (c) => c.a) ?? 0;
  const largestForce = d3.max(allContacts, (c) => Math.max(c.P, c.f)) ?? 0;
  const magnifications = [1, 2, 5, 10, 20];
  const first = magnifications.find((m) => m * largestAxis >= 0.03 * size) ?? (largestAxis > 0 ? 20 : 1);
  element("magnification").append(...magnifications.map((m) => option(m, m === 1 ? "true size" : `${m} × size`, m === first)));
  element("force_scale").append(...[[0, "hidden"], [0.5, "½ × length"], [1, "shown"], [2, "2 × length"], [4, "4 × length"]]
    .map(([scale, label]) => option(scale, label, scale === 1)));

  const colours = Object.fromEntries([STICKS, AT_LIMIT, SLIPS].map((name) => [name, colourOf(name.slice(4, -1))]));
  let frame = 0, selected = 0;
  let pending = 0;
  const drawNow = () => { pending = 0; renderer.render(scene, camera); };
  const draw = () => (pending ||= requestAnimationFrame(drawNow));
  function show() {
    bodies.forEach((group, body) => {
      const at = 7 * (frame * bodies.length + body);
      group.position.fromArray(poses, at);
      group.quaternion.fromArray(poses, at + 3);
    });
    const magnification = Number(element("magnification").value);
    const metresPerNewton = largestForce > 0 ? Number(element("force_scale").value) * 0.22 * size / largestForce : 0;
    markers.forEach(({marker, fill, edge, normal, tangential}, track) => {
      const contact = history[frame][track];
      marker.visible = normal.visible = tangential.visible = Boolean(contact);
      if (!contact) return;
      marker.position.set(contact.x, contact.y, contact.z);
      marker.quaternion.set(contact.qx, contact.qy, contact.qz, contact.qw);
      // A point contact has no size: a dot of the picture's, hollow.
      const isPoint = !(contact.a > 0);
      const point = 0.006 * size;
      marker.scale.set(isPoint ? point : magnification * contact.a, isPoint ? point : magnification * Math.max(contact.b, 1e-3 * contact.a), 1);
      const colour = element("colouring").value === "use" ? useColour(contact.use) : colours[stateColour(contact)];
      fill.material.color.set(colour);
      fill.material.opacity = isPoint ? 0.25 : track === selected ? 0.95 : 0.6;
      edge.material.color.set(track === selected ? colourOf("--normal-force") : colour);
      const axes = [0, 1, 2].map((i) => new Vector3().setComponent(i, 1).applyQuaternion(marker.quaternion));
      // Pushed from behind, dragged from there on: the arrows of a pinch do not run into each other.
      const push = axes[2].multiplyScalar(contact.P * metresPerNewton);
      placeArrow(normal, marker.position.clone().sub(push), push);
      placeArrow(tangential, marker.position, axes[0].multiplyScalar(contact.f1 * metresPerNewton).addScaledVector(axes[1], contact.f2 * metresPerNewton));
    });
    keepUp();
    draw();
  }

  const controls = new OrbitControls(camera, canvas);
  controls.addEventListener("change", draw);
  let follows = leavesView;
  let lookedAt = centre.clone(); // where the followed objects were when the camera was last moved
  /** Moves the camera as far as the objects have moved: direction and distance stay the reader's. */
  function keepUp() {
    if (!follows) return;
    const now = boxOf(frame).getCenter(new Vector3());
    const moved = now.clone().sub(lookedAt);
    lookedAt = now;
    camera.position.add(moved);
    controls.target.add(moved);
    controls.update();
  }
  function resetCamera() {
    const narrow = Math.min(1, camera.aspect);
    const seen = follows ? Math.max(1.15 * followedSize, 1e-6) : motionSize;
    const distance = 0.46 * seen / Math.sin((Math.PI / 360) * camera.fov) / narrow;
    lookedAt = follows ? boxOf(frame).getCenter(new Vector3()) : centre.clone();
    camera.position.copy(lookedAt).addScaledVector(new Vector3(0.85, -1.1, 0.6).normalize(), distance);
    controls.target.copy(lookedAt);
    controls.update();
  }
  let touched = false;
  controls.addEventListener("start", () => (touched = true));
  function resize() {
    const {clientWidth: width, clientHeight: height} = canvas.parentElement;
    if (!width || !height) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (!touched) resetCamera();
    draw();
  }
  new ResizeObserver(resize).observe(canvas.parentElement);
  resize();

  // A click, not the end of an orbit, selects the nearest contact.
  let down = null;
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    const box = canvas.getBoundingClientRect();
    const nearest = d3.least(history[frame].filter(Boolean).map((contact) => {
      const seen = new Vector3(contact.x, contact.y, contact.z).project(camera);
      const [x, y] = [box.x + (seen.x + 1) / 2 * box.width, box.y + (1 - seen.y) / 2 * box.height];
      return {track: contact.track, distance: Math.hypot(x - event.clientX, y - event.clientY)};
    }), (c) => c.distance);
    if (nearest?.distance < 30) select(nearest.track);
  });

  /** Whether something was drawn: the picture is not of one colour. For the page's test. */
  function isDrawn() {
    drawNow();
    const gl = renderer.getContext();
    const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return new Set(new Uint32Array(pixels.buffer)).size > 16;
  }
  /** Whether all that is followed lies in the picture. For the page's test. */
  function seesObjects() {
    camera.updateMatrixWorld();
    const seen = new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    return followed.every((body) => seen.containsPoint(bodies[body].position));
  }
  return {
    leavesView, seesObjects,
    setFollow(isOn) { follows = isOn; touched = false; resetCamera(); draw(); },
    setFrame(newFrame) { frame = newFrame; show(); },
    setSelected(track) { selected = track; show(); },
    setSeeThrough(isOn) {
      for (const material of opaque) Object.assign(material, {transparent: isOn, opacity: isOn ? 0.35 : 1, depthWrite: !isOn, needsUpdate: true});
      draw();
    },
    reset() { touched = false; resetCamera(); draw(); },
    show, isDrawn,
  };
}

// --- charts of the selected contact ------------------------------------------------------------
const QUANTITIES = {
  normal: {name: "Normal force P", unit: "N", value: (c) => c.P, note: "shaded: at its limit, darker where it slips"},
  tangential: {name: "Tangential force", unit: "N", value: (c) => c.f, limit: (c) => c.mu * c.P, note: "dashed: μP"},
  torque: {name: "Torque about the normal", unit: "N·m", value: (c) => c.tau, limit: (c) => c.mu * c.P * c.e_n, note: "dashed: μP eₙ"},
  use: {name: "Utilisation", unit: "", value: (c) => c.use, limit: () => 1, note: "dashed: the limit"},
};
const span = last > 0 && times[last] > times[0] ? [times[0], times[last]] : [times[0] - 0.5, times[0] + 0.5];
const seriesOf = (track, value) => history.map((contacts, i) => ({x: times[i], y: contacts[track] ? value(contacts[track]) : NaN}));
/** Stretches of time in which `is` holds of the contact: [from, to]. */
function spansOf(track, is) {
  const spans = [];
  const step = (span[1] - span[0]) / Math.max(1, last);
  history.forEach((contacts, i) => {
    const holds = (contact) => Boolean(contact && is(contact));
    if (!holds(contacts[track])) return;
    if (i > 0 && holds(history[i - 1][track])) spans[spans.length - 1].to = times[i];
    else spans.push({from: i > 0 ? times[i - 1] : times[0], to: Math.max(times[i], times[i] === times[0] ? times[0] + step : 0)});
  });
  return spans;
}

// Below the lowest chart stands the name of the axis, below the others only its numbers.
const marginBelow = (isLowest) => (isLowest ? 38 : 22);

function timeChart(width, track, key, isLowest) {
  const {value, limit, unit} = QUANTITIES[key];
  const raw = seriesOf(track, value);
  const limits = limit ? seriesOf(track, limit) : [];
  const finite = [...raw, ...limits].map((p) => p.y).filter(Number.isFinite);
  const [factor, prefix] = unit ? prefixFor(d3.max(finite, Math.abs) ?? 0) : [1, ""];
  const scaled = (points) => points.map(({x, y}) => ({x, y: y * factor}));
  const points = scaled(raw), limitPoints = scaled(limits);
  const isLone = (p, i) => Number.isFinite(p.y) && !Number.isFinite(points[i - 1]?.y) && !Number.isFinite(points[i + 1]?.y);
  const largest = factor * (d3.max(finite) ?? 0), smallest = factor * (d3.min(finite) ?? 0);
  const domain = d3.scaleLinear().domain([Math.min(0, smallest), largest > 0 ? 1.01 * largest : smallest < 0 ? 0 : 1]).nice(3).domain();
  const isNegative = key === "torque" && smallest < 0;
  return Plot.plot({
    width, height: (isLowest ? 100 : 92) + marginBelow(isLowest), marginLeft: 46, marginRight: 12, marginTop: 8, marginBottom: marginBelow(isLowest),
    grid: true, style: {fontSize: "12px", background: "transparent"},
    x: {domain: span, label: isLowest ? "time, s →" : null, labelAnchor: "right", ticks: width < 420 ? 5 : 8},
    y: {domain: isNegative ? d3.scaleLinear().domain([Math.min(smallest, -factor * (d3.max(limits, (p) => p.y || 0) ?? 0)), domain[1]]).nice(3).domain() : domain, label: null, ticks: 3},
    marks: [
      Plot.rectX(spansOf(track, (c) => c.slides), {x1: "from", x2: "to", fill: AT_LIMIT, fillOpacity: 0.13}),
      Plot.rectX(spansOf(track, (c) => c.slips), {x1: "from", x2: "to", fill: SLIPS, fillOpacity: 0.22}),
      Plot.ruleY([0], {strokeOpacity: 0.4}),
      ...(limit ? [Plot.line(limitPoints, {x: "x", y: "y", stroke: "currentColor", strokeOpacity: 0.6, strokeDasharray: "4 3", curve: "linear"})] : []),
      ...(isNegative ? [Plot.line(limitPoints, {x: "x", y: (p) => -p.y, stroke: "currentColor", strokeOpacity: 0.6, strokeDasharray: "4 3", curve: "linear"})] : []),
      Plot.line(points, {x: "x", y: "y", stroke: STICKS, strokeWidth: 1.8, curve: "linear"}),
      Plot.dot(points.filter(isLone), {x: "x", y: "y", r: 2.5, fill: STICKS}),
    ],
    ariaLabel: `${QUANTITIES[key].name}${unit ? `, ${prefix}${unit}` : ""}`,
  });
}

function wrenchChart(width, track) {
  const place = (c) => ({x: c.mu * c.P > 0 ? c.f / (c.mu * c.P) : NaN, y: c.e_n > 0 && c.mu * c.P > 0 ? Math.abs(c.tau) / (c.mu * c.P * c.e_n) : 0});
  const trail = history.map((contacts) => (contacts[track] ? place(contacts[track]) : {x: NaN, y: NaN}));
  // An overloaded contact may leave the picture by a little, not shrink it to nothing.
  const top = 1.1 * Math.min(1.6, Math.max(1, d3.max(trail, (p) => Math.max(p.x, p.y) || 0) ?? 1, ...history.map((contacts) => contacts[track]?.exact_ratio ?? 1)));
  const side = Math.min(width, 390) - 58;
  const quarter = d3.range(0, 46).map((i) => ({x: Math.cos(i * Math.PI / 90), y: Math.sin(i * Math.PI / 90)}));
  const plot = Plot.plot({
    width: side + 58, height: side + 62, marginLeft: 46, marginRight: 12, marginTop: 24, marginBottom: 38,
    grid: true, style: {fontSize: "12px", background: "transparent"},
    x: {domain: [0, top], label: "tangential force / μP →", labelAnchor: "right", ticks: 5},
    y: {domain: [0, top], label: "↑ |torque| / μP eₙ", ticks: 5},
    marks: [
      Plot.ruleY([0], {strokeOpacity: 0.4}), Plot.ruleX([0], {strokeOpacity: 0.4}),
      Plot.line(quarter, {x: "x", y: "y", stroke: "currentColor", strokeOpacity: 0.6, strokeDasharray: "4 3", curve: "linear"}),
      Plot.line(trail, {x: "x", y: "y", stroke: STICKS, strokeOpacity: 0.4, strokeWidth: 1.5, curve: "linear", clip: true}),
    ],
  });
  const [x, y] = [plot.scale("x").apply, plot.scale("y").apply];
  const svg = d3.select(plot);
  const section = svg.append("path").attr("fill", "none").attr("stroke", "currentColor").attr("stroke-width", 2);
  const dot = svg.append("circle").attr("r", 6).attr("stroke", "var(--page)").attr("stroke-width", 2);
  const update = (frame) => {
    const contact = history[frame][track];
    const now = contact && place(contact);
    const isShown = Boolean(now) && Number.isFinite(now.x);
    dot.attr("display", isShown ? null : "none");
    if (isShown) dot.attr("cx", x(Math.min(now.x, top))).attr("cy", y(Math.min(now.y, top))).attr("fill", stateColour(contact));
    const has = contact && contact.section >= 0;
    section.attr("display", has ? null : "none");
    if (!has) return;
    const n = data.sections.points;
    section.attr("d", d3.line().curve(d3.curveCatmullRom)(d3.range(n).map((i) => {
      const radius = sectionRadii[contact.section * n + i], angle = (i / (n - 1)) * (Math.PI / 2);
      return [x(radius * Math.cos(angle)), y(radius * Math.sin(angle) * contact.exact_ratio)];
    })));
  };
  return {plot, update};
}

// --- the page ----------------------------------------------------------------------------------
let frame = 0, selected = 0, playing = false, updates = [];
let view = null;
const figures = Object.fromEntries([...document.querySelectorAll(".player figure")].map((figure) => [figure.dataset.chart, figure]));

const contactButtons = data.tracks.map((track, index) => {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "contact";
  button.innerHTML = "<i></i><span></span><small></small>";
  button.children[1].textContent = track.name;
  button.title = track.name;
  button.addEventListener("click", () => select(index));
  return button;
});

function describe(contact) {
  if (!contact) return "does not touch now";
  const size = contact.a > 0 ? `ellipse ${significant(1e3 * contact.a)} × ${significant(1e3 * contact.b)} mm` : "point contact";
  const arm = contact.e_n > 0 ? `eₙ ${significant(1e3 * contact.e_n)} mm` : "carries no torque";
  return `${stateOf(contact)} · ${size} · ${arm} · μ ${significant(contact.mu)}`;
}

function drawCharts() {
  updates = [];
  const width = figures.wrench.clientWidth;
  if (!width || !data.tracks.length) return;
  // A contact without e_n carries no torque: it has no wrench to draw, but a force and its limit.
  const met = history.map((contacts) => contacts[selected]).filter(Boolean);
  const carriesTorque = met.some((contact) => contact.e_n > 0);
  figures.torque.hidden = !carriesTorque;
  page.dataset.chartsExpected = carriesTorque ? "5" : "3";
  const plot = figures.wrench.querySelector(".plot");
  if (carriesTorque) {
    const wrench = wrenchChart(width, selected);
    plot.replaceChildren(wrench.plot);
    updates.push(wrench.update);
  } else {
    plot.replaceChildren();
  }
  element("wrench_note").textContent = !carriesTorque
    ? "A point contact carries no torque about the normal: its limit is that of the tangential force alone, μP, below."
    : met.some((contact) => contact.section >= 0)
      ? "Dashed: the friction ellipsoid; solid: the exact limit surface of this ellipse, for this direction of the force, both whatever the law of the contact is; thin: the path up to now."
      : "Dashed: the friction ellipsoid; thin: the path up to now. There is no ellipse, so that no exact limit surface is known.";
  for (const [key, {name, unit, note, value}] of Object.entries(QUANTITIES)) {
    if (key === "torque" && !carriesTorque) continue;
    const plot = timeChart(width, selected, key, key === "use");
    const [unitText] = plot.getAttribute("aria-label").split(", ").slice(1);
    const caption = figures[key].querySelector("figcaption");
    caption.innerHTML = `<b></b><span></span><output></output>`;
    caption.children[0].textContent = name;
    caption.children[1].textContent = `${unitText ?? ""} (${note})`;
    figures[key].querySelector(".plot").replaceChildren(plot);
    const scale = plot.scale("x");
    const cursor = d3.select(plot).append("line").attr("y1", 8).attr("y2", Number(plot.getAttribute("height")) - marginBelow(key === "use")).attr("stroke", "currentColor").attr("stroke-width", 1.2);
    updates.push((now) => {
      cursor.attr("x1", scale.apply(times[now])).attr("x2", scale.apply(times[now]));
      const contact = history[now][selected];
      caption.children[2].textContent = contact ? (unit ? withUnit(value(contact), unit) : significant(value(contact))) : "–";
    });
    const seek = (event) => {
      if (event.buttons !== 1) return;
      setFrame(nearestFrame(scale.invert(event.clientX - plot.getBoundingClientRect().x)));
    };
    plot.addEventListener("pointerdown", seek);
    plot.addEventListener("pointermove", seek);
  }
  updates.forEach((update) => update(frame));
  page.dataset.chartsDrawn = String(updates.length);
}

/** For the page's test. */
const sayWhatIsSeen = () => {
  if (view) Object.assign(page.dataset, {follows: String(element("follow").checked), objectsInView: String(view.seesObjects())});
};

const nearestFrame = (time) => d3.bisectCenter(times, time);

function setFrame(newFrame) {
  frame = newFrame;
  element("time").value = frame;
  const digits = Math.max(0, Math.min(6, 1 - Math.floor(Math.log10((span[1] - span[0]) / Math.max(1, last)))));
  element("clock").textContent = `${times[frame].toFixed(digits)} s of ${times[last].toFixed(digits)} s`;
  view?.setFrame(frame);
  updates.forEach((update) => update(frame));
  const byUse = element("colouring").value === "use";
  contactButtons.forEach((button, track) => {
    const contact = history[frame][track];
    button.classList.toggle("absent", !contact);
    button.children[0].style.background = !contact ? "transparent" : byUse ? useColour(contact.use) : stateColour(contact);
    button.children[2].textContent = contact ? `${withUnit(contact.P, "N")} · ${significant(contact.use)}` : "–";
  });
  if (data.tracks.length) element("state").textContent = describe(history[frame][selected]);
  page.dataset.frame = String(frame);
  sayWhatIsSeen();
}

function select(track) {
  selected = track;
  element("selected").textContent = data.tracks[track].name;
  contactButtons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === track)));
  page.dataset.selected = String(track);
  drawCharts();
  view?.setSelected(track);
  element("state").textContent = describe(history[frame][selected]);
}

function play() {
  if (playing) {
    playing = false;
    element("play").textContent = "Play";
    return;
  }
  if (frame === last) setFrame(0);
  playing = true;
  element("play").textContent = "Pause";
  let before = null, time = times[frame];
  requestAnimationFrame(function tick(now) {
    if (!playing) return;
    // A tab that was hidden goes on where it was.
    time += Math.min(0.1, (now - (before ?? now)) / 1e3) * Number(element("speed").value);
    before = now;
    // Moved by hand meanwhile: from there.
    if (Math.abs(nearestFrame(time) - frame) > 1 && element("time").matches(":active")) time = times[frame];
    const next = Math.max(0, d3.bisectRight(times, time) - 1);
    if (next !== frame) setFrame(next);
    if (frame === last) play();
    else requestAnimationFrame(tick);
  });
}

function start() {
  page.dataset.frames = String(times.length); // also shows the player, see motion.css
  page.dataset.contacts = String(data.tracks.length);
  page.dataset.chartsExpected = data.tracks.length ? "5" : "0";
  page.dataset.chartsDrawn = "0";
  document.querySelector(".player").classList.toggle("without_contacts", !data.tracks.length);
  element("time").max = last;
  element("time").disabled = element("play").disabled = last < 1;

  // About as long as it took, unless that is over in a moment or takes a minute.
  const duration = span[1] - span[0];
  const speeds = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  const wanted = duration < 3 ? duration / 6 : duration > 30 ? duration / 30 : 1;
  const chosen = d3.least(speeds, (speed) => Math.abs(Math.log(speed / wanted)));
  element("speed").append(...speeds.map((speed) => option(speed, `${speed} ×`, speed === chosen)));

  try {
    view = createView(element("view"));
  } catch (error) {
    // No WebGL: charts and tables say the rest.
    console.warn(error.message);
    element("view").hidden = true;
    element("scale").textContent = "The 3-D view needs WebGL, which this browser does not offer.";
  }
  page.dataset.webgl = String(Boolean(view));

  const legend = () => {
    element("colours").innerHTML = element("colouring").value === "use"
      ? `0 <i class="ramp" style="background:linear-gradient(to right, ${d3.range(0, 1.01, 0.1).map(useColour).join(",")})"></i> 1`
      : `<i style="background:${STICKS}"></i> sticks <i style="background:${AT_LIMIT}"></i> at its limit <i style="background:${SLIPS}"></i> slips`;
  };
  legend();
  element("contacts").append(...contactButtons);
  element("play").addEventListener("click", play);
  element("time").addEventListener("input", () => setFrame(Number(element("time").value)));
  element("colouring").addEventListener("change", () => { legend(); setFrame(frame); });
  for (const id of ["magnification", "force_scale"]) element(id).addEventListener("change", () => view?.show());
  element("see_through").addEventListener("change", (event) => view?.setSeeThrough(event.target.checked));
  element("reset").addEventListener("click", () => view?.reset());
  element("follow").checked = Boolean(view?.leavesView);
  element("follow").disabled = !view;
  element("follow").addEventListener("change", (event) => { view?.setFollow(event.target.checked); sayWhatIsSeen(); });

  // The contact with the largest force of all says most.
  const strongest = d3.greatest(allContacts, (contact) => contact.P);
  if (strongest) select(strongest.track);
  // motion.html#t=0.35 opens at a time; otherwise it opens where that contact has begun.
  const touching = strongest ? history.findIndex((contacts) => contacts[strongest.track]) : 0;
  const asked = /^#t=([\d.]+)$/.exec(location.hash)?.[1];
  setFrame(asked === undefined ? touching : nearestFrame(Number(asked)));
  if (view) page.dataset.canvasDrawn = String(view.isDrawn());

  let width = figures.wrench.clientWidth;
  new ResizeObserver(() => requestAnimationFrame(() => {
    if (figures.wrench.clientWidth !== width) {
      width = figures.wrench.clientWidth;
      drawCharts();
    }
    page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
  })).observe(document.body);
  page.dataset.overflow = String(page.scrollWidth > page.clientWidth);
  page.dataset.readyMs = String(Math.round(performance.now()));
}

if (times.length) start();
