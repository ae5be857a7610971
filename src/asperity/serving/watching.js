// One run: watched, read, heard.

import { ask, colour, dark, engineering, find, make, numbers, showBlocks } from "./asking.js";
import { axes, greyOf, imageOf, line, prepared } from "./canvas.js";

export const shown = { id: null, view: null, at: 0, playing: false, law: null };

export async function showRun(run) {
  Object.assign(shown, { id: run.id, view: null, at: 0, playing: false });
  find("run").hidden = false;
  find("run-title").textContent = run.name;
  find("verdict").textContent = "Reading the run …";
  for (const id of ["warnings", "watch", "listen", "figures"]) find(id).hidden = true;
  play(false);
  const place = `runs/${run.id}/`, link = (name, words, properties) => make("a", { href: place + name, textContent: words, ...properties });
  find("run-links").replaceChildren(link("report.html", "Report", { target: "_blank", rel: "noopener" }), link("run.nc", "Download run.nc", { download: "" }), link("case.toml", "Download the case", { download: "" }));
  try {
    const view = await ask(`${place}view`);
    if (shown.id !== run.id) return;
    shown.view = view;
    find("verdict").textContent = view.verdict;
    showWarnings(view.warnings);
    find("watch").hidden = !view.force;
    if (view.force) takeForce(view);
    find("listen").hidden = view.sounds.length === 0;
    find("sound").replaceChildren(...view.sounds.map((name) => make("option", { value: name, textContent: name.replace(/\.wav$/, "").replaceAll("_", " ") })));
    hear();
    find("figures").hidden = false;
    showBlocks(find("figures"), view);
    drawWatch();
    if (shown.jump) find("run").scrollIntoView();
    shown.jump = false;
  } catch (error) {
    find("verdict").textContent = error.message;
  }
}

export function closeRun() {  // as Back does
  play(false);
  Object.assign(shown, { id: null, view: null });
  find("run").hidden = true;
}

function showWarnings(warnings) {
  const box = find("warnings");
  box.hidden = warnings.length === 0;
  box.querySelector("summary").textContent = `${warnings.length} warning${warnings.length > 1 ? "s" : ""} on the physics`;
  box.querySelector("ul").replaceChildren(...warnings.map((each) => make("li", { textContent: `${each.grade}: ${each.message}` })));
}

function takeForce(view) {
  const force = view.force;
  force.distance = numbers(force.distance);
  for (const law of Object.keys(force.pieces)) force.pieces[law] = numbers(force.pieces[law]);
  if (view.texture) view.texture.heights = numbers(view.texture.heights);
  view.image = null;
  const names = Object.keys(force.pieces);
  shown.law = names[0];
  find("law").replaceChildren(...names.map((name) => make("option", { value: name, textContent: name })));
  const natural = force.watched / 15;  // the piece in a quarter of a minute
  const paces = [0.2, 1, 5].map((each) => natural * each);
  find("pace").replaceChildren(...paces.map((pace, i) => make("option", { value: String(pace), selected: i === 1, textContent: `${Math.max(1, Math.round(1 / pace)).toLocaleString("en")} times` })));
  find("position").value = "0";
}

// A short sound is over before it was heard: it goes on from its beginning.
const SHORT = 4;  // s

export function hear() {
  const name = find("sound").value, player = find("player");
  player.onloadedmetadata = () => { player.loop = player.duration < SHORT; };
  player.src = name ? `runs/${shown.id}/sounds/${encodeURIComponent(name)}` : "";
}

const paintOf = (name) => { const law = shown.view.laws.find((each) => each.name === name); return law ? (dark.matches ? law.dark : law.colour) : colour("--accent"); };

export function drawWatch() {
  const view = shown.view;
  if (!view?.force || find("run").hidden) return;
  const distance = view.force.distance, last = distance.length - 1, index = Math.round(shown.at * last), x = distance[index];
  const force = view.force.pieces[shown.law][index], length = drawTexture(view, x, force);
  drawForce(view, x, length);
  const time = view.force.watched * shown.at;
  find("now").textContent = `${engineering(time, "s")} · ${engineering(x, "m")} · ${engineering(force, "N")}`;
  find("texture").setAttribute("aria-label", `Texture with the contact patch at ${engineering(x, "m")}, force ${engineering(force, "N")}`);
  find("position").setAttribute("aria-valuetext", find("now").textContent);
}

// Semi-axes of the nominal patch under a force grow with its cube root (Hertz).
const growth = (force, patch) => Math.cbrt(Math.max(force, 0) / patch.load);

function drawTexture(view, x, force) {
  const [pen, width, height] = prepared(find("texture")), { texture, patch } = view, areal = texture && texture.shape[1] > 1;
  const scale = areal ? height / (texture.shape[1] * texture.dy) : width / (40 * patch.along), length = width / scale;
  const toX = (at) => (at - x) * scale + width / 2, grown = growth(force, patch);
  if (areal) {
    view.image = view.dark === dark.matches && view.image || imageOf(texture.shape, greyOf(texture.heights));
    view.dark = dark.matches;
    pen.drawImage(view.image, toX(0), 0, texture.shape[0] * texture.dx * scale, height);
    find("texture-words").textContent = "texture of the path from above, light is high, without waves much longer than the strip is wide; the ellipse is the nominal patch under the force of the law, dashed under the static load";
  } else if (texture) {
    drawProfile(pen, texture, x, length, toX, height);
    find("texture-words").textContent = "heights along the path; the bar is the nominal patch under the force of the law";
  }
  for (const [size, dash, stroke] of [[1, [4, 3], colour("--muted")], [grown, [], paintOf(shown.law)]]) {
    pen.beginPath(); pen.setLineDash(dash); pen.lineWidth = 2; pen.strokeStyle = stroke;
    pen.ellipse(width / 2, areal ? height / 2 : height - 12, size * patch.along * scale, areal ? size * patch.across * scale : 5, 0, 0, 7);
    if (!dash.length && grown > 0) { pen.globalAlpha = 0.35; pen.fillStyle = stroke; pen.fill(); pen.globalAlpha = 1; }
    pen.stroke();
  }
  pen.setLineDash([]);
  return length;
}

function drawProfile(pen, texture, x, length, toX, height) {
  const first = Math.max(0, Math.floor((x - length / 2) / texture.dx)), end = Math.min(texture.shape[0], Math.ceil((x + length / 2) / texture.dx) + 1);
  let largest = 1e-12;
  for (const each of texture.heights) largest = Math.max(largest, Math.abs(each));
  const points = [];
  for (let i = first; i < end; i++) points.push([toX(i * texture.dx), (height - 24) / 2 * (1 - 0.95 * texture.heights[i] / largest)]);
  line(pen, points, colour("--ink"), 1.2);
}

// From zero, unless the force stays far from it.
function rangeOf(low, high) {
  const margin = 0.15 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low > 3 * (high - low) || low < 0 ? low - margin : 0, high + margin];
}

// Number of values, which increase, below a limit.
function indexOf(values, limit) {
  let low = 0, high = values.length;
  while (low < high) { const middle = (low + high) >> 1; if (values[middle] < limit) low = middle + 1; else high = middle; }
  return low;
}

function drawForce(view, x, length) {
  const [pen, width, height] = prepared(find("force")), box = { left: 0, top: 20, width, height: height - 26 };
  const { force, patch } = view, [low, high] = force.range[shown.law], y = rangeOf(low, high);
  const [toX, toY] = axes(pen, { ...box, left: 44, width: width - 44 }, [x - length / 2, x + length / 2], y, null, [`contact force, ${shown.law}`, "N"]);
  const at = (value) => (value - x) / length * width + width / 2;
  const first = indexOf(force.distance, x - 0.51 * length), end = indexOf(force.distance, x + 0.51 * length);
  pen.save(); pen.beginPath(); pen.rect(44, 0, width - 44, height); pen.clip();
  pen.setLineDash([3, 3]); line(pen, [[44, toY(patch.load)], [width, toY(patch.load)]], colour("--muted"), 1); pen.setLineDash([]);
  for (const name of [...Object.keys(force.pieces).filter((each) => each !== shown.law), shown.law]) {
    const main = name === shown.law, points = [];
    for (let i = first; i < end; i++) points.push([at(force.distance[i]), toY(force.pieces[name][i])]);
    pen.globalAlpha = main ? 1 : 0.3;
    line(pen, points, paintOf(name), main ? 2 : 1);
  }
  pen.globalAlpha = 1;
  line(pen, [[width / 2, 0], [width / 2, height]], colour("--muted"), 1);
  pen.restore();
  find("force-words").textContent = `the force over the same stretch; faint: the other laws; dashed: the static load of ${engineering(patch.load, "N")}`;
}

let before = 0;
function step(now) {
  if (!shown.playing) return;
  shown.at += (now - before) / 1000 * Number(find("pace").value) / shown.view.force.watched;
  before = now;
  if (shown.at >= 1) { shown.at = 1; play(false); }
  find("position").value = String(shown.at);
  drawWatch();
  if (shown.playing) requestAnimationFrame(step);
}

export function play(on) {
  shown.playing = on;
  find("play").textContent = on ? "Pause" : "Play";
  if (on) { if (shown.at >= 1) shown.at = 0; before = performance.now(); requestAnimationFrame(step); }
}
