// The contact, which follows its sliders.

import { ask, colour, engineering, find, make, numbers, squareMicrometres } from "./asking.js";
import { axes, greyOf, heat, imageOf, line, prepared, ticks } from "./canvas.js";
import { kind, showErrors, typed } from "./form.js";

const contact = { sample: null, state: null, grey: null, wanted: null, busy: false, asked: 0 };

export function pressAnew() {
  contact.sample = null;
  press(null);
}

export function redrawContact() {
  contact.grey = null;
  drawContact();
}

// One question at a time: while it is on its way, only the last wish is kept.
export async function press(share) {
  contact.wanted = { share };
  if (contact.busy) return;
  contact.busy = true;
  while (contact.wanted) {
    const wish = contact.wanted, begun = performance.now();
    contact.wanted = null;
    try {
      const found = await ask("ask/press", { kind: kind.value, values: typed(), share: wish.share, whole: contact.sample === null });
      if (found.sample) takeSample(found.sample);
      contact.state = { ...found.contact, pressure: numbers(found.contact.pressure) };
      if (wish.share === null && !contact.wanted) find("approach").value = String(Math.round(1000 * contact.state.share));
      drawContact();
      await new Promise(requestAnimationFrame);
      told(performance.now() - begun);
      showErrors([]);
    } catch (error) {
      if (!contact.wanted) refuseContact(error);
    }
  }
  contact.busy = false;
}

function takeSample(sample) {
  contact.sample = { ...sample, heights: numbers(sample.heights) };
  contact.grey = null;
  const thinned = sample.thinning > 1 ? ` Every ${sample.thinning}th point of the grid is taken here; a run takes all.` : "";
  find("contact-note").textContent = `${sample.source[0].toUpperCase()}${sample.source.slice(1)}. Shown is one sample; the load is ${engineering(sample.load, "N")}.${thinned}`;
  find("approach").disabled = find("to-load").disabled = false;
}

function refuseContact(error) {
  contact.sample = contact.state = null;
  find("approach").disabled = find("to-load").disabled = true;
  find("contact-note").textContent = "There is no contact to press as long as the case is not right.";
  find("contact-words").textContent = "";
  find("contact-numbers").replaceChildren();
  find("largest-pressure").textContent = "";
  for (const id of ["pressure", "stiffness"]) prepared(find(id));
  showErrors(error.errors || [String(error)]);
}

function told(milliseconds) {
  const state = contact.state;
  if (!document.body.dataset.firstPicture) document.body.dataset.firstPicture = String(Math.round(performance.now()));
  document.body.dataset.slider = String(Math.round(milliseconds));
  document.body.dataset.answers = String(++contact.asked);
  const unsure = state.converged ? "" : " – not converged";
  const edge = state.at_edge > 0.01 ? " – the contact reaches the edge of contact.window" : "";
  find("contact-words").textContent = `solved and drawn in ${Math.round(milliseconds)} ms${unsure}${edge}`;
  const of = [["approach δ", engineering(state.approach, "m")], ["state r", engineering(state.state, "m")], ["force F", engineering(state.force, "N")],
    ["k_c = F/r", engineering(state.stiffness, "N/m")], ["dF/dδ", engineering(state.tangent_stiffness, "N/m")],
    [`waves of its length (v/2a)${contact.sample.passing_at}`, engineering(contact.sample.passing, "Hz")],
    ["largest pressure", engineering(state.largest_pressure, "Pa")], ["area in contact", squareMicrometres(state.area)], ["smooth bodies (Hertz)", engineering(state.smooth_force, "N")]];
  find("contact-numbers").replaceChildren(...of.map(([what, value]) => make("div", {}, make("dt", { textContent: what }), make("dd", { textContent: value }))));
  find("approach").setAttribute("aria-valuetext", `${of[0][1]}, ${of[2][1]}, k_c ${of[3][1]}`);
}

function drawContact() {
  const { sample, state } = contact;
  if (!sample || !state) return;
  const [pen, width, height] = prepared(find("pressure")), top = state.largest_pressure || 1;
  contact.grey ??= imageOf(sample.shape, greyOf(sample.heights));
  pen.imageSmoothingEnabled = false;
  pen.drawImage(contact.grey, 0, 0, width, height);
  const hot = imageOf(sample.shape, (at) => state.pressure[at] > 0 ? [...heat(state.pressure[at] / top), 255] : [0, 0, 0, 0]);
  pen.drawImage(hot, 0, 0, width, height);
  drawScaleBar(pen, width, height, sample.shape[0] * sample.spacing[0]);
  find("largest-pressure").textContent = engineering(state.largest_pressure, "Pa");
  find("pressure").setAttribute("aria-label", `Contact pressure at an approach of ${engineering(state.approach, "m")}: largest ${engineering(state.largest_pressure, "Pa")}, area ${squareMicrometres(state.area)}`);
  drawStiffness(sample, state);
}

// A fifth of the side or some more, in the lower left corner.
function drawScaleBar(pen, width, height, side) {
  const length = ticks(0, side, 5)[1], end = 12 + length / side * width;
  pen.fillStyle = colour("--paper"); pen.globalAlpha = 0.8;
  pen.fillRect(6, height - 34, end, 28);
  pen.globalAlpha = 1;
  for (const [x, rise] of [[12, 4], [end, 4]]) line(pen, [[x, height - 12 - rise], [x, height - 12 + rise]], colour("--ink"), 2);
  line(pen, [[12, height - 12], [end, height - 12]], colour("--ink"), 2);
  pen.fillStyle = colour("--ink"); pen.textAlign = "center"; pen.textBaseline = "bottom";
  pen.fillText(engineering(length, "m", 2), (12 + end) / 2, height - 16);
}

function drawStiffness(sample, state) {
  const [pen, width, height] = prepared(find("stiffness")), box = { left: 40, top: 22, width: width - 52, height: height - 62 };
  const deepest = sample.deepest - sample.touch, largest = 1.05 * Math.max(...sample.curve.map((each) => each.tangent_stiffness));
  const [toX, toY] = axes(pen, box, [0, deepest], [0, largest], ["r", "m"], ["k", "N/m"]);
  pen.setLineDash([3, 3]);
  line(pen, [[toX(sample.working - sample.touch), box.top], [toX(sample.working - sample.touch), box.top + box.height]], colour("--muted"), 1);
  pen.setLineDash([]);
  for (const [name, paint] of [["tangent_stiffness", "--tangent"], ["stiffness", "--accent"]]) {
    line(pen, sample.curve.map((each) => [toX(each.state), toY(each[name])]), colour(paint));
    pen.beginPath(); pen.fillStyle = colour(paint); pen.arc(toX(state.state), toY(Math.min(state[name], largest)), 4.5, 0, 7); pen.fill();
  }
  find("stiffness").setAttribute("aria-label", `Contact stiffness against the state: k_c ${engineering(state.stiffness, "N/m")} and dF/dδ ${engineering(state.tangent_stiffness, "N/m")} at r = ${engineering(state.state, "m")}`);
}
