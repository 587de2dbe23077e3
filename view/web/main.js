// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Shows the animation that `ruga view` wrote into this page (view/page.c says how).
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, HemisphereLight, LineBasicMaterial,
  LineSegments, Mesh, MeshStandardMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer, WireframeGeometry,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { drawPlots } from "./plots.js";

const byId = (id) => document.getElementById(id);
const meta = JSON.parse(byId("meta").textContent);

// ---- data ---------------------------------------------------------------------------------------------------

async function inflate(id) {
  const text = atob(byId(id).textContent.trim());
  const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  byId(id).remove();
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Frames of 16-bit places in the box, each as its difference from the one before, low bytes before high bytes.
function placesOf(bytes) {
  const count = 3 * meta.vertices, frames = [];
  let before = new Uint16Array(count);
  for (let t = 0; t < meta.frames; t++) {
    const at = 2 * count * t, now = new Uint16Array(count);
    for (let i = 0; i < count; i++) now[i] = before[i] + bytes[at + i] + 256 * bytes[at + count + i];
    frames.push(now);
    before = now;
  }
  return frames;
}

function setPositions(geometry, places) {
  const out = geometry.attributes.position.array, [low, step] = [meta.low, meta.step];
  for (let i = 0; i < out.length; i++) out[i] = low[i % 3] + step * places[i];
  geometry.attributes.position.needsUpdate = true;
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
}

// ---- the scene ----------------------------------------------------------------------------------------------

const clay = new Color(0.46, 0.315, 0.235);
const table = meta.colors.map((c) => new Color(c));

class Skin {
  constructor(index) {
    this.geometry = new BufferGeometry();
    this.geometry.setIndex(new BufferAttribute(index, 1));
    this.geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * meta.vertices), 3));
    this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * meta.vertices), 3));
    this.material = new MeshStandardMaterial({ vertexColors: true, roughness: 0.62, side: DoubleSide, polygonOffset: true,
      polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.mesh = new Mesh(this.geometry, this.material);
    this.lines = new LineSegments(new WireframeGeometry(this.geometry), new LineBasicMaterial({ color: 0x22262b, transparent: true, opacity: 0.35 }));
    this.lines.visible = false;
    this.scene = new Scene();
    this.scene.background = new Color(0xe4e2de);
    this.scene.add(this.mesh, this.lines, new HemisphereLight(0xeef2f8, 0x8a7f74, 1.7), new AmbientLight(0xffffff, 0.15));
    this.key = new DirectionalLight(0xfff4e6);
    this.scene.add(this.key, this.key.target);
  }

  show(places, values) {
    this.key.intensity = values ? 2.6 : 4.2;
    setPositions(this.geometry, places);
    const color = this.geometry.attributes.color;
    for (let v = 0; v < meta.vertices; v++) {
      const c = values ? table[values[v]] : clay;
      color.array[3 * v] = c.r;
      color.array[3 * v + 1] = c.g;
      color.array[3 * v + 2] = c.b;
    }
    color.needsUpdate = true;
    if (this.lines.visible) {
      this.lines.geometry.dispose();
      this.lines.geometry = new WireframeGeometry(this.geometry);
    }
  }
}

function lightFrom(skin, camera, target) {
  // From the left and low, as in `ruga render`.
  const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
  const forward = camera.getWorldDirection(new Vector3());
  skin.key.position.copy(target).addScaledVector(right, -0.85).addScaledVector(camera.up, 0.45).addScaledVector(forward, 0.2);
  skin.key.target.position.copy(target);
}

// ---- the page -----------------------------------------------------------------------------------------------

function fillPanel() {
  document.title = `${meta.name} - Ruga`;
  byId("title").textContent = meta.name;
  byId("scene").textContent = meta.scene;
  byId("scrub").max = meta.frames - 1;
  const add = (name, value) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name;
    dd.textContent = value;
    byId("facts").append(dt, dd);
    return dd;
  };
  for (const [name, value] of meta.facts) add(name, value);
  return { time: add("time", ""), outcome: add("outcome", "") };
}

function drawLegend() {
  const canvas = byId("legend").querySelector("canvas"), context = canvas.getContext("2d");
  table.forEach((c, i) => {
    context.fillStyle = `#${c.getHexString()}`;
    context.fillRect(i * 256 / table.length, 0, 256 / table.length + 1, 1);
  });
  const ends = byId("legend").querySelectorAll("span");
  ends[0].textContent = (-meta.displacement).toPrecision(3);
  ends[2].textContent = `+${meta.displacement.toPrecision(3)}`;
}

function start(index, skins, wrinkled, embedded, values) {
  const renderer = new WebGLRenderer({ antialias: true });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  byId("stage").prepend(renderer.domElement);
  const camera = new PerspectiveCamera(25, 1, 0.01, 10), controls = new OrbitControls(camera, renderer.domElement);
  const target = new Vector3(...meta.middle), radius = meta.radius;
  const facts = fillPanel(), plots = drawPlots(byId("plots"), meta.panels, meta.time);
  let frame = -1, playing = null, dirty = true;

  function home() {
    camera.up.set(...meta.up);
    const [x, y, z] = [0, 1, 2].map((k) => meta.toward[k]);
    const distance = 0.86 * radius / Math.sin(12.5 * Math.PI / 180) * Math.max(1, 1 / camera.aspect);
    camera.near = radius / 50;
    camera.far = distance + 20 * radius;
    camera.position.copy(target).addScaledVector(new Vector3(x, y, z), distance);
    camera.updateProjectionMatrix();
    controls.target.copy(target);
    controls.update();
    dirty = true;
  }

  function show(k) {
    frame = k;
    const shown = byId("color").value === "displacement" && values ? values.subarray(k * meta.vertices, (k + 1) * meta.vertices) : null;
    skins[0].show(wrinkled[k], shown);
    if (embedded && byId("both").checked) skins[1].show(embedded[k], null);
    byId("scrub").value = k;
    byId("frame").textContent = `frame ${k} of ${meta.frames - 1}, ${meta.time[k].toPrecision(3)} s`;
    facts.time.textContent = `${meta.time[k].toPrecision(4)} s`;
    facts.outcome.textContent = meta.outcome[k];
    plots.mark(k);
    dirty = true;
  }

  function resize() {
    const { clientWidth: w, clientHeight: h } = byId("stage");
    renderer.setSize(w, h, false);
    camera.aspect = w / h / (byId("both").checked ? 2 : 1);
    camera.updateProjectionMatrix();
    plots.draw();
    dirty = true;
  }

  function draw() {
    const { clientWidth: w, clientHeight: h } = byId("stage"), both = byId("both").checked;
    renderer.setScissorTest(true);
    (both ? skins : skins.slice(0, 1)).forEach((skin, i) => {
      const left = both ? i * w / 2 : 0, width = both ? w / 2 : w;
      lightFrom(skin, camera, controls.target);
      renderer.setViewport(left, 0, width, h);
      renderer.setScissor(left, 0, width, h);
      renderer.render(skin.scene, camera);
    });
  }

  function play(on) {
    playing = on ? { since: performance.now(), from: frame >= meta.frames - 1 ? 0 : frame } : null;
    byId("play").textContent = on ? "pause" : "play";
  }

  // Frames as they follow in the scene's time, at most 30 and at least 5 in a second.
  const spacing = meta.frames > 1 ? (meta.time.at(-1) - meta.time[0]) / (meta.frames - 1) : 1;
  const rate = Math.min(30, Math.max(5, 1 / spacing));
  function tick(now) {
    if (playing) { // `now` is when the browser began this picture, which may be before the click
      const k = playing.from + Math.floor(Math.max(0, now - playing.since) / 1000 * rate);
      if (k >= meta.frames + rate / 2) play(true), playing.from = 0;
      else if (Math.min(k, meta.frames - 1) !== frame) show(Math.min(k, meta.frames - 1));
    }
    controls.update();
    if (dirty) {
      draw();
      dirty = false;
    }
    requestAnimationFrame(tick);
  }

  controls.enableDamping = true;
  controls.addEventListener("change", () => { dirty = true; });
  addEventListener("resize", resize);
  byId("play").onclick = () => play(!playing);
  byId("scrub").oninput = () => { play(false); show(Number(byId("scrub").value)); };
  byId("home").onclick = home;
  byId("wire").onchange = () => { skins.forEach((s) => { s.lines.visible = byId("wire").checked; }); show(frame); };
  byId("color").onchange = () => { byId("legend").hidden = byId("color").value !== "displacement"; show(frame); };
  byId("both").onchange = () => {
    byId("right").style.display = byId("both").checked ? "block" : "none";
    byId("right").style.left = "calc(50% + 12px)";
    resize();
    home();
    show(frame);
  };
  addEventListener("keydown", (e) => {
    if (e.target.tagName === "SELECT") return;
    if (e.key === " ") { e.preventDefault(); play(!playing); }
    if (e.key === "ArrowRight" || e.key === "ArrowLeft") {
      e.preventDefault();
      play(false);
      show(Math.min(meta.frames - 1, Math.max(0, frame + (e.key === "ArrowRight" ? 1 : -1))));
    }
  });
  if (!embedded) {
    byId("both").disabled = byId("color").disabled = true;
    byId("left").textContent = "skin";
  }
  byId("left").style.left = "12px";
  drawLegend();
  resize();
  home();
  show(meta.frames - 1);
  requestAnimationFrame(tick);
  document.body.dataset.ready = "yes";
}

async function main() {
  const index = new Uint32Array((await inflate("triangles")).buffer);
  const wrinkled = placesOf(await inflate("wrinkled"));
  const embedded = meta.embedded ? placesOf(await inflate("embedded")) : null;
  const values = meta.embedded ? await inflate("displacement") : null;
  start(index, [new Skin(index), new Skin(index)], wrinkled, embedded, values);
}

main().catch((error) => {
  byId("trouble").hidden = false;
  byId("trouble").textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
