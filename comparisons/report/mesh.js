// Shows a surface in 3-D. A click on it gives the line of a case for that point; the points that the
// program found are there to choose, each with the region of its fit and the fitted quadric. The
// table of the page is HTML already. three.js is bundled into this file.
import {
  ArrowHelper, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, HemisphereLight,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D,
  PerspectiveCamera, Raycaster, Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";

const page = document.documentElement;
const element = (id) => document.getElementById(id);
const colourOf = (name) => getComputedStyle(page).getPropertyValue(name).trim();
const data = JSON.parse(element("data").textContent);

function bufferOf(text) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes.buffer;
}
const shown = (value, digits) => {
  const rounded = Number(value.toFixed(digits));
  return String(Object.is(rounded, -0) ? 0 : rounded);
};
const listed = (vector, factor, digits) => [vector.x, vector.y, vector.z].map((v) => shown(v * factor, digits)).join(", ");
const vectorOf = (numbers) => new Vector3(...numbers);
const withMinus = (text) => text.replace("-", "−");

// --- the scene: millimetres, so that a finger has numbers of ordinary size ------------------------
const canvas = document.querySelector(".view canvas");
function createRenderer() {
  try {
    return new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
  } catch {
    return null;
  }
}

function start(renderer) {
  page.dataset.drawn = "true"; // shows the viewer, which then has a size
  Object3D.DEFAULT_UP.set(0, 0, 1);
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const scene = new Scene();
  scene.background = new Color(colourOf("--card"));

  const positions = new Float32Array(bufferOf(data.surface.positions)).map((x) => 1e3 * x);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(
    data.surface.triangles16 ? new Uint16Array(bufferOf(data.surface.triangles16)) : new Uint32Array(bufferOf(data.surface.triangles32)), 1));
  geometry.computeVertexNormals();
  geometry.computeBoundingBox();
  const {min: low, max: high} = geometry.boundingBox;
  const centre = low.clone().add(high).multiplyScalar(0.5);
  const size = Math.max(low.distanceTo(high), 1e-6);

  // The region is a ball around the point: coloured in the shader, exactly, however long the
  // triangles are. What faces away is the other side of a thin body.
  const region = {regionCentre: {value: new Vector3()}, regionNormal: {value: new Vector3(0, 0, 1)}, regionRadius: {value: 0}, regionColour: {value: new Color(colourOf("--region"))}};
  const material = new MeshLambertMaterial({color: colourOf("--surface"), side: DoubleSide});
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, region);
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 placeInMm; varying vec3 faceNormal;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nplaceInMm = position; faceNormal = normal;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying vec3 placeInMm; varying vec3 faceNormal; uniform vec3 regionCentre, regionNormal, regionColour; uniform float regionRadius;")
      .replace("#include <color_fragment>", "#include <color_fragment>\nif (distance(placeInMm, regionCentre) < regionRadius && dot(normalize(faceNormal), regionNormal) > 0.26) diffuseColor.rgb = regionColour;");
  };
  const surface = new Mesh(geometry, material);
  scene.add(surface);

  const camera = new PerspectiveCamera(30, 1, size / 100, size * 100);
  const light = new DirectionalLight(0xffffff, 1.9);
  light.position.set(-size, size, size); // with the camera: what is looked at is lit
  camera.add(light);
  scene.add(camera, new HemisphereLight(0xffffff, 0x8a8f98, 1.7));

  const length = 10 ** Math.floor(Math.log10(size / 3));
  for (const [direction, name] of [[[1, 0, 0], "x"], [[0, 1, 0], "y"], [[0, 0, 1], "z"]])
    scene.add(new ArrowHelper(new Vector3(...direction), low, length, colourOf(`--axis-${name}`), 0.25 * length, 0.12 * length));
  element("scale").innerHTML =
    `axes ${shown(length, 6)}\u00a0mm: <b style="color:var(--axis-x)">x</b> <b style="color:var(--axis-y)">y</b> <b style="color:var(--axis-z)">z</b>`;

  const onTop = {depthTest: false, transparent: true};
  const dot = new Mesh(new SphereGeometry(0.008 * size, 16, 12), new MeshBasicMaterial({color: colourOf("--quadric"), ...onTop}));
  const arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.2 * size, colourOf("--quadric"), 0.05 * size, 0.025 * size);
  const quadric = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: colourOf("--quadric")}));
  dot.renderOrder = 2;
  scene.add(dot, arrow, quadric);

  /** Circles and spokes on the fitted quadric, a little above the facets. */
  function drawQuadric(fit, radius) {
    quadric.visible = Boolean(fit);
    if (!fit) return;
    const origin = vectorOf(fit.origin_m).multiplyScalar(1e3), normal = vectorOf(fit.normal), x = vectorOf(fit.x_axis);
    const y = normal.clone().cross(x);
    const [a, b, c] = [fit.A_per_m, fit.B_per_m, fit.C_per_m].map((k) => k * 1e-3);
    const at = (r, angle) => {
      const u = r * Math.cos(angle), v = r * Math.sin(angle);
      return origin.clone().addScaledVector(x, u).addScaledVector(y, v).addScaledVector(normal, 2e-3 * size - (a * u * u + b * v * v + c * u * v));
    };
    const points = [], turns = 48, rings = 4;
    for (let ring = 1; ring <= rings; ++ring)
      for (let i = 0; i < turns; ++i)
        points.push(at(radius * ring / rings, 2 * Math.PI * i / turns), at(radius * ring / rings, 2 * Math.PI * (i + 1) / turns));
    for (let spoke = 0; spoke < 8; ++spoke)
      for (let i = 0; i < 8; ++i)
        points.push(at(radius * i / 8, Math.PI * spoke / 4), at(radius * (i + 1) / 8, Math.PI * spoke / 4));
    quadric.geometry.dispose();
    quadric.geometry = new BufferGeometry().setFromPoints(points);
  }

  let pending = 0;
  const drawNow = () => { pending = 0; renderer.render(scene, camera); };
  const draw = () => (pending ||= requestAnimationFrame(drawNow));

  // --- the chosen point ---------------------------------------------------------------------------
  const slider = element("radius");
  const radiusOf = (place) => 1e-2 * size * 10 ** (1.6 * place / 100); // 1 % to 40 % of the size
  const placeOf = (radius) => 100 * Math.log10(radius / (1e-2 * size)) / 1.6;
  let chosen = null, buttons = [];
  /** `fit` is of the program; a clicked point has none. */
  function choose(point) {
    chosen = point;
    if (point.fit) slider.value = placeOf(1e3 * point.fit.region_radius_m);
    buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(data.points[i] === point.source)));
    show(point.fit ? 1e3 * point.fit.region_radius_m : radiusOf(slider.value));
  }
  function show(radius) {
    const {place, normal, name, fit} = chosen;
    dot.position.copy(place);
    arrow.position.copy(place);
    arrow.setDirection(normal);
    region.regionCentre.value.copy(place);
    region.regionNormal.value.copy(normal);
    region.regionRadius.value = radius;
    const isOwn = fit && Math.abs(radius - 1e3 * fit.region_radius_m) < 1e-6 * radius;
    drawQuadric(isOwn ? fit : null, radius);
    element("name").textContent = withMinus(name);
    element("radius_mm").textContent = `${radius.toPrecision(3)}\u00a0mm`;
    const radii = fit?.radii_m.map((r) => (r === null ? "flat" : `${withMinus((1e3 * r).toPrecision(3))}\u00a0mm`)).join(" and ");
    element("facts").textContent = isOwn
      ? `Radii ${radii}, residual ${(1e3 * fit.residual_rms_m).toPrecision(2)}\u00a0mm${chosen.source.doubt ? `; ${chosen.source.doubt}` : ""}.`
      : chosen.source?.doubt ?? "";
    element("lines").textContent = chosen.source?.toml ??
      `finger = { ${data.mesh_entries}, point_mm = [${listed(place, 1, 4)}], normal = [${listed(normal, 1, 5)}] }`;
    const factor = 1e-3 / data.metres_per_unit;
    const digits = Math.max(0, Math.ceil(4 - Math.log10(factor) - 1e-9));
    const quoted = /^[\w./-]+$/.test(data.mesh) ? data.mesh : `'${data.mesh.replaceAll("'", "'\\''")}'`;
    element("command").textContent =
      `softfinger fit ${[quoted, data.mesh_options].filter((word) => word !== "").join(" ")} --point ${listed(place, factor, digits).replaceAll(" ", "")} --normal ${listed(normal, 1, 5).replaceAll(" ", "")} --radius-mm ${radius.toPrecision(3)}`;
    page.dataset.line = element("lines").textContent;
    draw();
  }
  slider.addEventListener("input", () => show(radiusOf(slider.value)));

  buttons = data.points.map((source) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = withMinus(source.name);
    const choice = {source, name: source.name, fit: source.fit, place: vectorOf(source.point_m).multiplyScalar(1e3), normal: vectorOf(source.normal)};
    button.addEventListener("click", () => { choose(choice); lookFrom(choice.normal); });
    button.choice = choice;
    element("points").append(button);
    return button;
  });

  // --- the view -----------------------------------------------------------------------------------
  const controls = new OrbitControls(camera, canvas);
  controls.addEventListener("change", draw);
  function lookFrom(direction) {
    const narrow = Math.min(1, camera.aspect);
    const distance = 0.5 * size / Math.sin((Math.PI / 360) * camera.fov) / narrow;
    // Never straight along the up axis, where an orbit has no direction.
    const from = direction.clone().normalize().addScaledVector(new Vector3(0.35, 0.2, 0.3), 1).normalize();
    camera.position.copy(centre).addScaledVector(from, distance);
    controls.target.copy(centre);
    controls.update();
    draw();
  }
  let touched = false;
  const reset = () => lookFrom(chosen?.normal ?? new Vector3(0.6, -1, 0.5));
  controls.addEventListener("start", () => (touched = true));
  function resize() {
    const {clientWidth: width, clientHeight: height} = canvas.parentElement;
    if (!width || !height) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (!touched) reset();
    draw();
  }
  new ResizeObserver(resize).observe(canvas.parentElement);

  // A click, not the end of an orbit, chooses the point under it.
  const rays = new Raycaster();
  let down = null;
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
    const box = canvas.getBoundingClientRect();
    rays.setFromCamera(new Vector2(2 * (event.clientX - box.x) / box.width - 1, 1 - 2 * (event.clientY - box.y) / box.height), camera);
    camera.updateMatrixWorld();
    const hit = rays.intersectObject(surface)[0];
    if (!hit) return;
    choose({name: "Clicked point", place: hit.point.clone(), normal: hit.face.normal.clone()});
    page.dataset.clicked = "true";
  });

  element("copy").addEventListener("click", async () => {
    const selection = getSelection();
    selection.selectAllChildren(element("lines"));
    try { await navigator.clipboard.writeText(element("lines").textContent); } catch { /* it stays selected */ }
  });
  element("picture").addEventListener("click", () => {
    drawNow();
    const link = document.createElement("a");
    link.download = `${data.mesh.replace(/^.*\//, "").replace(/\.[^.]*$/, "")}.png`;
    link.href = canvas.toDataURL("image/png");
    link.click();
  });
  element("reset").addEventListener("click", () => { touched = false; reset(); });

  slider.value = placeOf(0.1 * size);
  if (buttons.length) choose(buttons[0].choice);
  resize();
  drawNow();
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  page.dataset.canvasDrawn = String(new Set(new Uint32Array(pixels.buffer)).size > 16);
}

const renderer = createRenderer();
page.dataset.webgl = String(Boolean(renderer));
if (renderer) start(renderer);
page.dataset.chartsDrawn = page.dataset.chartsExpected = "0";
const measure = () => (page.dataset.overflow = String(page.scrollWidth > page.clientWidth));
new ResizeObserver(measure).observe(document.body);
measure();
