// The page: a form that becomes a case, a contact that follows its slider, runs that are watched and heard.

const find = (id) => document.getElementById(id);
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const dark = matchMedia("(prefers-color-scheme: dark)");

function make(tag, properties = {}, ...inside) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...inside);
  return made;
}

// ---- asking the server -------------------------------------------------------------------------------------

class Refused extends Error {
  constructor(errors) { super(errors.join("\n")); this.errors = errors; }
}

async function ask(address, question) {
  const options = question === undefined ? {} :
    { method: "POST", body: question instanceof Blob ? question : JSON.stringify(question) };
  let answer;
  try {
    answer = await fetch(address, options);
  } catch {
    throw new Refused(["The server does not answer. Has it ended? Start it again with 'asperity serve', and open the address it prints."]);
  }
  if (answer.ok) return answer.json();
  const text = await answer.text();
  try {
    throw new Refused(JSON.parse(text).errors);
  } catch (error) {
    throw error instanceof Refused ? error : new Refused([text || answer.statusText]);
  }
}

function numbers(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// A link to a page that the server has to draw first: the first click asks for it, the second opens it.
function drawnFirst(address, words) {
  const link = make("a", { href: address, target: "_blank", rel: "noopener", textContent: `Draw ${words}` });
  link.onclick = async (event) => {
    if (link.dataset.drawn) return;
    event.preventDefault();
    link.textContent = `Drawing ${words}, some seconds …`;
    try {
      const answer = await fetch(address);
      if (!answer.ok) throw new Error(await answer.text());
      link.dataset.drawn = "yes";
      link.textContent = `Open ${words}`;
    } catch (error) {
      link.textContent = `${words} could not be drawn: ${error.message}`;
    }
  };
  return link;
}

// ---- numbers for people ------------------------------------------------------------------------------------

const PREFIXES = { "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" };

function engineering(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const exponent = value === 0 ? 0 : Math.min(9, Math.max(-12, 3 * Math.floor(Math.log10(Math.abs(value)) / 3 + 1e-9)));
  const scaled = value / 10 ** exponent;
  const places = scaled === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(scaled)) + 1e-9));
  return `${scaled.toFixed(places)} ${PREFIXES[exponent]}${unit}`.replace("-", "−");
}

const squareMicrometres = (area) => area > 1e-6 ? `${(area * 1e6).toPrecision(3)} mm²` : `${Number((area * 1e12).toPrecision(3))} µm²`;

function span(seconds) {
  return seconds < 90 ? `${Math.round(seconds)} s` : seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

// ---- the form ----------------------------------------------------------------------------------------------

const kind = find("kind");
const form = () => document.querySelector(`.case-form[data-kind="${kind.value}"]`);

function valueOf(field) {
  const boxes = field.querySelectorAll("[type=checkbox]");
  if (boxes.length) return (field.dataset.order || "").split(",").filter((each) => [...boxes].some((box) => box.checked && box.value === each)).join(", ");
  return field.querySelector("input, select").value.trim();
}

function setValue(field, value) {
  const boxes = field.querySelectorAll("[type=checkbox]");
  if (boxes.length) {
    const chosen = value.split(",").map((each) => each.trim()).filter(Boolean);
    field.dataset.order = chosen.join(",");
    for (const box of boxes) box.checked = chosen.includes(box.value);
  } else {
    field.querySelector("input, select").value = value;
  }
}

const fields = (of = form()) => [...of.querySelectorAll(".field")];

function typed() {
  return Object.fromEntries(fields().map((field) => [field.dataset.key, valueOf(field)]).filter(([, value]) => value));
}

function firstOf(field) {
  return field.querySelector("input[data-first]")?.dataset.first ?? field.querySelector("option[data-first]")?.value ?? "";
}

function firstValues(of) {
  for (const field of fields(of)) setValue(field, firstOf(field));
}

function fill(found) {
  kind.value = found.kind;
  for (const field of fields()) {
    setValue(field, found.values[field.dataset.key] || "");
    if (valueOf(field)) field.closest("details").open = true;
  }
  changed();
}

// Keys that go with another one are shown once that one is there; the rest by what is looked for.
function arrange() {
  for (const each of document.querySelectorAll(".case-form")) each.hidden = each !== form();
  const values = typed(), word = find("find").value.trim().toLowerCase();
  for (const group of form().querySelectorAll("details")) {
    let count = 0, shown = 0;
    for (const field of group.querySelectorAll(".field")) {
      const given = Boolean(values[field.dataset.key]);
      field.classList.toggle("changed", given);
      field.hidden = !(given || active(field.dataset.goesWith, values)) || !(word === "" || field.textContent.toLowerCase().includes(word));
      count += given; shown += !field.hidden;
    }
    group.querySelector(".count").textContent = count ? `${count} set` : "";
    group.hidden = shown === 0;
    if (word) group.open = true;
  }
}

function active(companion, values) {
  const [keys, value] = companion.split("=");
  return !companion || (value ? values[keys] === value : keys.split(" or ").some((key) => values[key]));
}

function showErrors(errors) {
  const box = find("errors");
  for (const field of fields()) {
    const wrong = errors.find((each) => each.startsWith(`${field.dataset.key}: `));
    const line = field.querySelector(".wrong"), control = field.querySelector("input, select");
    line.hidden = !wrong;
    line.textContent = wrong ? wrong.slice(field.dataset.key.length + 2) : "";
    if (wrong) { field.hidden = false; field.closest("details").open = true; control.setAttribute("aria-invalid", "true"); }
    else control.removeAttribute("aria-invalid");
  }
  box.hidden = errors.length === 0;
  box.replaceChildren(make("ul", {}, ...errors.map((each) => make("li", { textContent: each }))));
}

let later;
function changed() {
  arrange();
  sessionStorage.setItem("case", JSON.stringify({ kind: kind.value, values: typed() }));
  clearTimeout(later);
  later = setTimeout(() => { contact.sample = null; press(null); }, 250);
}

// ---- surfaces ----------------------------------------------------------------------------------------------

async function listSurfaces() {
  const found = await ask("ask/surfaces");
  for (const select of document.querySelectorAll("select.files")) {
    const before = select.value;
    for (const option of select.querySelectorAll("option.upload")) option.remove();
    select.append(...found.map((each) => make("option", { value: each.id, className: "upload", textContent: each.name })));
    select.value = [...select.options].some((option) => option.value === before) ? before : "";
  }
}

// The first key that takes a file takes it; examples that its section came with make way.
function take(identifier) {
  const select = form().querySelector("select.files"), group = select.closest("details");
  for (const field of group.querySelectorAll(".field")) {
    const example = firstOf(field);
    if (example && valueOf(field) === example) setValue(field, "");
  }
  select.value = identifier;
  group.open = true;
  changed();
}

async function upload(file) {
  const told = find("upload-state"), largest = Number(document.body.dataset.largest);
  told.className = "";
  if (!file) return;
  if (file.size > largest) {
    told.className = "alert";
    told.textContent = `${file.name}: received ${(file.size / 2 ** 20).toFixed(0)} MiB; allowed: at most ${document.body.dataset.largestWords}. Crop or thin the measurement; 'asperity run' reads larger files from disk.`;
    return;
  }
  told.textContent = `Reading ${file.name} …`;
  try {
    const found = await ask(`ask/surfaces?name=${encodeURIComponent(file.name)}`, file);
    await listSurfaces();
    told.textContent = found.needs || `${found.name}: ${found.words}.`;
    take(found.id);
  } catch (error) {
    told.className = "alert";
    told.textContent = error.message;
  }
}

// ---- drawing -----------------------------------------------------------------------------------------------

const INFERNO = [[27, 12, 65], [74, 12, 107], [120, 28, 109], [165, 44, 96], [207, 68, 70], [237, 105, 37], [251, 155, 6], [247, 209, 61], [252, 255, 164]];

function heat(share) {
  const at = Math.min(Math.max(share, 0), 1) * (INFERNO.length - 1), low = Math.min(Math.floor(at), INFERNO.length - 2), rest = at - low;
  return INFERNO[low].map((part, i) => part + rest * (INFERNO[low + 1][i] - part));
}

function prepared(canvas) {
  const ratio = devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = "12px system-ui, sans-serif";
  return [pen, box.width, box.height];
}

// Image of (nx, ny) numbers, x to the right and y upwards, a colour for each.
function imageOf(shape, paint) {
  const [nx, ny] = shape, image = new ImageData(nx, ny);
  for (let i = 0; i < nx; i++) for (let j = 0; j < ny; j++) image.data.set(paint(i * ny + j), 4 * ((ny - 1 - j) * nx + i));
  const canvas = make("canvas", { width: nx, height: ny });
  canvas.getContext("2d").putImageData(image, 0, 0);
  return canvas;
}

function greyOf(heights) {
  let square = 0;
  for (const height of heights) square += height * height;
  const scale = 26 / (Math.sqrt(square / heights.length) || 1), middle = dark.matches ? 70 : 190;
  return (at) => { const grey = middle + Math.min(Math.max(heights[at] * scale, -62), 62); return [grey, grey, grey, 255]; };
}

function ticks(low, high, count = 5) {
  const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw * 0.999);
  const found = [];
  for (let at = Math.ceil(low / step - 1e-9) * step; at <= high + 1e-9 * step; at += step) found.push(Math.abs(at) < 1e-9 * step ? 0 : at);
  return found;
}

// Axes in a box: returns functions from values to pixels.
function axes(pen, box, x, y, xWords, yWords) {
  const toX = (value) => box.left + (value - x[0]) / (x[1] - x[0]) * box.width;
  const toY = (value) => box.top + box.height - (value - y[0]) / (y[1] - y[0]) * box.height;
  pen.strokeStyle = colour("--grid"); pen.fillStyle = colour("--muted"); pen.lineWidth = 1;
  const exponent = 3 * Math.floor(Math.log10(Math.max(Math.abs(y[0]), Math.abs(y[1])) || 1) / 3), size = 10 ** exponent;
  pen.textAlign = "right"; pen.textBaseline = "middle";
  for (const at of ticks(y[0], y[1])) {
    pen.beginPath(); pen.moveTo(box.left, toY(at)); pen.lineTo(box.left + box.width, toY(at)); pen.stroke();
    pen.fillText(String(Number((at / size).toPrecision(4))).replace("-", "−"), box.left - 5, toY(at));
  }
  pen.textAlign = "center"; pen.textBaseline = "top";
  if (xWords) {
    const scale = 10 ** (3 * Math.floor(Math.log10(Math.max(Math.abs(x[0]), Math.abs(x[1])) || 1) / 3)), prefix = PREFIXES[Math.round(Math.log10(scale))] ?? "";
    for (const at of ticks(x[0], x[1])) pen.fillText(String(Number((at / scale).toPrecision(4))).replace("-", "−"), toX(at), box.top + box.height + 5);
    pen.textAlign = "right"; pen.fillText(`${xWords[0]} / ${prefix}${xWords[1]}`, box.left + box.width, box.top + box.height + 19);
  }
  pen.textAlign = "left"; pen.textBaseline = "bottom";
  pen.fillText(`${yWords[0]} / ${PREFIXES[exponent] ?? ""}${yWords[1]}`, box.left, box.top - 3);
  return [toX, toY];
}

function line(pen, points, stroke, width = 1.6) {
  pen.beginPath(); pen.strokeStyle = stroke; pen.lineWidth = width; pen.lineJoin = "round";
  points.forEach(([x, y], i) => i ? pen.lineTo(x, y) : pen.moveTo(x, y));
  pen.stroke();
}

// ---- the contact, which follows its slider -------------------------------------------------------------------

const contact = { sample: null, state: null, grey: null, wanted: null, busy: false, asked: 0 };

// One question at a time: while it is on its way, only the last wish is kept.
async function press(share) {
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
  find("pressure-words").textContent = "";
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
  const side = sample.shape[0] * sample.spacing[0];
  find("pressure-words").textContent = `pressure up to ${engineering(state.largest_pressure, "Pa")} on ${engineering(side, "m")} × ${engineering(sample.shape[1] * sample.spacing[1], "m")}; heights in grey`;
  find("pressure").setAttribute("aria-label", `Contact pressure at an approach of ${engineering(state.approach, "m")}: largest ${engineering(state.largest_pressure, "Pa")}, area ${squareMicrometres(state.area)}`);
  drawStiffness(sample, state);
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

// ---- runs --------------------------------------------------------------------------------------------------

const opened = () => decodeURIComponent(location.hash.replace(/^#run=/, "")) || null;
const chosen = new Set();
let runs = [], listed = "";

async function listRuns() {
  try {
    runs = await ask("ask/runs");
  } catch (error) {
    runs = runs.map((run) => run.state === "running" ? { ...run, message: error.message } : run);
  }
  const now = JSON.stringify(runs) + opened() + [...chosen];
  if (now !== listed) { listed = now; drawRuns(); }
  document.body.dataset.runs = String(runs.length);
  const active = runs.some((run) => ["running", "waiting"].includes(run.state));
  setTimeout(listRuns, active ? 300 : 1500);
}

async function act(run, what) {
  try { await ask(`runs/${run.id}/${what}`, {}); } catch (error) { showErrors(error.errors); }
}

function drawRuns() {
  find("no-runs").hidden = runs.length > 0;
  for (const id of chosen) if (!runs.some((run) => run.id === id)) chosen.delete(id);
  const focused = document.activeElement?.dataset?.act;
  find("run-list").replaceChildren(...runs.map(rowOf));
  if (focused) document.querySelector(`[data-act="${focused}"]`)?.focus();
  find("compare").hidden = runs.filter((run) => run.state === "done").length < 2;
  find("compare").disabled = chosen.size < 2 || chosen.size > 4;
  find("compare").textContent = chosen.size >= 2 ? `Compare the ${chosen.size} chosen runs` : "Choose two runs to compare";
  const open = runs.find((run) => run.id === opened());
  if (open?.state === "done" && shown.id !== open.id) showRun(open);
}

function rowOf(run) {
  const button = (words, what, action) => { const made = make("button", { type: "button", textContent: words, onclick: action }); made.dataset.act = `${run.id} ${what}`; made.setAttribute("aria-label", `${words}: ${run.name}`); return made; };
  const head = make("div", { className: "head" }), row = make("li", { className: run.id === opened() ? "open" : "" }, head);
  row.dataset.run = run.id; row.dataset.state = run.state;
  if (run.state === "done") {
    const box = make("input", { type: "checkbox", checked: chosen.has(run.id), onchange: () => { box.checked ? chosen.add(run.id) : chosen.delete(run.id); drawRuns(); } });
    box.setAttribute("aria-label", `choose ${run.name} to compare`); box.dataset.act = `${run.id} choose`;
    head.append(box, make("a", { href: `#run=${run.id}`, className: "name", textContent: run.name, onclick: () => { shown.jump = true; if (shown.id === run.id) find("run").scrollIntoView(); } }));
  } else {
    head.append(make("span", { className: "name", textContent: run.name }), make("span", { className: run.state, textContent: run.state }));
  }
  if (run.state === "running") {
    const bar = make("progress", { max: Math.max(run.total, 1), value: run.done });
    bar.setAttribute("aria-label", `progress of ${run.name}`);
    head.append(bar, make("span", { className: "about", textContent: run.left == null ? run.message : `${run.message}, about ${span(run.left)} left` }));
  }
  const under = ["running", "waiting"].includes(run.state);
  if (under) head.append(button("Cancel", "cancel", () => act(run, "cancel").then(listNow)));
  else if (run.state !== "done") head.append(button("Go on", "go-on", () => act(run, "go-on").then(listNow)));
  head.append(button("Edit case", "values", () => editCase(run)));
  if (!under) head.append(button("Delete", "delete", () => { if (confirm(`Delete ${run.name} with all its files?`)) act(run, "delete").then(listNow); }));
  row.append(make("p", { className: "about", textContent: [run.kind, run.changed].filter(Boolean).join(": ") }));
  if (run.message && !under) row.append(make("p", { className: "about failed", textContent: run.message }));
  return row;
}

async function listNow() {
  runs = await ask("ask/runs").catch(() => runs);
  listed = ""; drawRuns();
}

async function editCase(run) {
  try { fill(await ask(`runs/${run.id}/values`)); find("case").scrollIntoView(); } catch (error) { showErrors(error.errors); }
}

async function roll() {
  find("roll").disabled = true;
  try {
    const made = await ask("ask/runs", { kind: kind.value, values: typed(), name: find("run-name").value });
    showErrors([]);
    location.hash = `run=${made.id}`;
    await listNow();
  } catch (error) {
    showErrors(error.errors);
  }
  find("roll").disabled = false;
}

function table(found, words, title = "") {
  const head = make("tr", {}, ...found.head.map((each) => make("th", { textContent: each, scope: "col" })));
  const body = found.rows.map((row) => make("tr", {}, ...row.map((cell) => make("td", { textContent: cell ?? "–" }))));
  return make("table", { className: words ? "words" : "" }, ...(title ? [make("caption", { textContent: title })] : []), make("thead", {}, head), make("tbody", {}, ...body));
}

async function compare() {
  const box = find("comparison-tables");
  const asked = runs.filter((run) => chosen.has(run.id)).reverse().map((run) => `run=${run.id}`).join("&");
  find("comparison").hidden = false;
  try {
    const found = await ask(`ask/compare?${asked}`);
    const page = drawnFirst(`${found.page}?${asked}`, "the whole comparison, with figures of all laws");
    const tables = [[found.cases, true, "What differs in the cases"], [found.numbers, false, `In numbers, ${found.law}`],
      [found.levels, false, `Contact force levels, ${found.law}, dB re 1 N; in brackets: bands in which two records of this length differ by 2 dB through chance alone`]];
    box.replaceChildren(make("p", { textContent: found.summary }), make("p", {}, page),
      ...tables.filter(([each]) => each.rows.length).map(([each, words, title]) => scrolled(table(each, words, title), title)));
  } catch (error) {
    box.replaceChildren(make("p", { className: "alert", textContent: error.message }));
  }
  find("comparison").scrollIntoView({ block: "start" });
}

function scrolled(inside, label) {
  const around = make("div", { className: "scroll", tabIndex: 0 }, inside);
  around.setAttribute("role", "region");
  around.setAttribute("aria-label", label);
  return around;
}

// ---- one run: watched, read, heard ---------------------------------------------------------------------------

const shown = { id: null, view: null, at: 0, playing: false, law: null };

async function showRun(run) {
  Object.assign(shown, { id: run.id, view: null, at: 0, playing: false });
  find("run").hidden = false;
  find("run-title").textContent = run.name;
  find("verdict").textContent = "Reading the run …";
  for (const id of ["warnings", "watch", "listen", "levels"]) find(id).hidden = true;
  play(false);
  const place = `runs/${run.id}/`, link = (name, words, properties) => make("a", { href: place + name, textContent: words, ...properties });
  find("run-links").replaceChildren(drawnFirst(`${place}report.html`, "the report"), link("run.nc", "Download run.nc", { download: "" }), link("case.toml", "Download the case", { download: "" }));
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
    find("levels").hidden = !view.levels;
    if (view.levels) find("levels").querySelector("div").replaceChildren(table(levelsOf(view.levels), false));
    drawWatch();
    if (shown.jump) find("run").scrollIntoView();
    shown.jump = false;
  } catch (error) {
    find("verdict").textContent = error.message;
  }
}

function levelsOf(levels) {
  const laws = Object.keys(levels.by_law);
  return { head: ["Hz", ...laws], rows: levels.bands.map((band, i) => [band, ...laws.map((law) => levels.by_law[law][i]?.toFixed(1).replace("-", "−"))]) };
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
  for (const part of ["pieces", "low", "high"]) for (const law of Object.keys(force[part])) force[part][law] = numbers(force[part][law]);
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

function hear() {
  const name = find("sound").value;
  find("player").src = name ? `runs/${shown.id}/sounds/${encodeURIComponent(name)}` : "";
}

const paintOf = (name) => { const law = shown.view.laws.find((each) => each.name === name); return law ? (dark.matches ? law.dark : law.colour) : colour("--accent"); };

function drawWatch() {
  const view = shown.view;
  if (!view?.force || find("run").hidden) return;
  const distance = view.force.distance, last = distance.length - 1, index = Math.round(shown.at * last), x = distance[index];
  const force = view.force.pieces[shown.law][index], length = drawTexture(view, x, force);
  drawForce(view, x, length);
  drawRecord(view);
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

function drawRecord(view) {
  const [pen, width, height] = prepared(find("record")), { force } = view, low = force.low[shown.law], high = force.high[shown.law];
  const [least, most] = rangeOf(...force.range[shown.law]), toY = (value) => height - (value - least) / (most - least) * height;
  pen.fillStyle = colour("--mark");
  pen.fillRect(0, 0, Math.max(3, width * force.watched / force.duration), height);
  const points = [];
  low.forEach((value, i) => { const x = (i + 0.5) / low.length * width; points.push([x, toY(value)], [x, toY(high[i])]); });
  line(pen, points, paintOf(shown.law), 1);
  const x = width * force.watched / force.duration * shown.at;
  line(pen, [[x, 0], [x, height]], colour("--ink"), 1.5);
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

function play(on) {
  shown.playing = on;
  find("play").textContent = on ? "Pause" : "Play";
  if (on) { if (shown.at >= 1) shown.at = 0; before = performance.now(); requestAnimationFrame(step); }
}

// ---- everything at its place -----------------------------------------------------------------------------------

function listenToForm() {
  for (const each of document.querySelectorAll(".case-form")) {
    each.addEventListener("input", (event) => {
      if (event.target.type === "checkbox") {
        const field = event.target.closest(".field"), order = (field.dataset.order || "").split(",").filter(Boolean);
        field.dataset.order = (event.target.checked ? [...order, event.target.value] : order.filter((name) => name !== event.target.value)).join(",");
      }
      changed();
    });
    each.addEventListener("submit", (event) => { event.preventDefault(); roll(); });
  }
  kind.onchange = changed;
  find("find").oninput = arrange;
  find("reset").onclick = () => { firstValues(form()); changed(); };
  find("roll").onclick = roll;
  find("clear-surfaces").onclick = () => { if (confirm("Delete the surfaces that no run uses?")) ask("ask/surfaces/clear", {}).then(listSurfaces); };
  find("surface-file").onchange = (event) => upload(event.target.files[0]).finally(() => { event.target.value = ""; });
  find("case-file").onchange = async (event) => {
    try { fill(await ask("ask/fill", { text: await event.target.files[0].text() })); showErrors([]); } catch (error) { showErrors(error.errors || [String(error)]); }
    event.target.value = "";
  };
  const drop = find("drop");
  drop.ondragover = (event) => { event.preventDefault(); drop.classList.add("over"); };
  drop.ondragleave = () => drop.classList.remove("over");
  drop.ondrop = (event) => { event.preventDefault(); drop.classList.remove("over"); upload(event.dataTransfer.files[0]); };
}

function listenToPictures() {
  find("approach").oninput = (event) => press(Number(event.target.value) / 1000);
  find("to-load").onclick = () => press(null);
  find("compare").onclick = compare;
  find("play").onclick = () => play(!shown.playing);
  find("law").onchange = (event) => { shown.law = event.target.value; drawWatch(); };
  find("sound").onchange = hear;
  find("position").oninput = (event) => { shown.at = Number(event.target.value); drawWatch(); };
  find("record").onclick = (event) => {
    const { force } = shown.view, share = event.offsetX / event.target.clientWidth * force.duration / force.watched;
    shown.at = Math.min(share, 1); find("position").value = String(shown.at); drawWatch();
  };
  addEventListener("hashchange", () => { listed = ""; drawRuns(); });
  const redraw = () => { contact.grey = null; drawContact(); drawWatch(); };
  addEventListener("resize", redraw);
  dark.addEventListener("change", redraw);
}

for (const each of document.querySelectorAll(".case-form")) firstValues(each);
listenToForm();
listenToPictures();
await listSurfaces().catch((error) => showErrors(error.errors));
const kept = JSON.parse(sessionStorage.getItem("case") || "null");
if (kept) fill(kept); else { arrange(); press(null); }
listRuns();
