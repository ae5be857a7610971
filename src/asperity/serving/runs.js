// The list of runs, rolling one, and several beside each other.

import { ask, find, make, showBlocks, span } from "./asking.js";
import { fill, kind, showErrors, typed } from "./form.js";
import { closeRun, showRun, shown } from "./watching.js";

// What is shown has an address: #run=ID of one run, #compare=ID,ID of several; none without.
const addressed = (what) => location.hash.startsWith(`#${what}=`) ? decodeURIComponent(location.hash.slice(what.length + 2)) : "";
const opened = () => addressed("run") || null;
const chosen = new Set();
let runs = [], listed = "", compared = "";
let rolled = sessionStorage.getItem("rolled");  // the run that this tab began last

export async function listRuns() {
  try {
    runs = await ask("ask/runs");
  } catch (error) {
    runs = runs.map((run) => run.state === "running" ? { ...run, message: error.message } : run);
  }
  const now = JSON.stringify(runs) + location.hash + [...chosen];
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
  drawRolled();
  if (focused) document.querySelector(`[data-act="${focused}"]`)?.focus();
  find("compare").hidden = runs.filter((run) => run.state === "done").length < 2;
  find("compare").disabled = chosen.size < 2 || chosen.size > 4;
  find("compare").textContent = chosen.size >= 2 ? `Compare the ${chosen.size} chosen runs` : "Choose two runs to compare";
  const open = runs.find((run) => run.id === opened());
  if (open?.state === "done" && shown.id !== open.id) showRun(open);
  if (location.hash.length < 2 && shown.id) closeRun();
  if (compared !== addressed("compare")) showComparison(addressed("compare"));
}

// What became of the run that was begun here, where Roll was pressed.
function drawRolled() {
  const run = runs.find((each) => each.id === rolled), box = find("rolled");
  box.hidden = !run;
  if (!run) return;
  const words = { running: [], done: [linkTo(run, `${run.name} is done: watch, read and hear it`)] }[run.state] ?? [`${run.name}: ${run.state}. ${run.message || ""}`];
  const under = ["running", "waiting"].includes(run.state);
  box.replaceChildren(...words, ...progressOf(run), ...(under ? [button(run, "Cancel", "stop", () => act(run, "cancel").then(listNow))] : []));
}

const linkTo = (run, words) => make("a", { href: `#run=${run.id}`, className: "name", textContent: words, onclick: () => { shown.jump = true; if (shown.id === run.id) find("run").scrollIntoView(); } });

function progressOf(run) {
  if (run.state !== "running") return [];
  const bar = make("progress", { max: Math.max(run.total, 1), value: run.done });
  bar.setAttribute("aria-label", `progress of ${run.name}`);
  return [bar, make("span", { className: "about", textContent: run.left == null ? run.message : `${run.message}, about ${span(run.left)} left` })];
}

function button(run, words, what, action) {
  const made = make("button", { type: "button", textContent: words, onclick: action });
  made.dataset.act = `${run.id} ${what}`;
  made.setAttribute("aria-label", `${words}: ${run.name}`);
  return made;
}

function rowOf(run) {
  const head = make("div", { className: "head" }), row = make("li", { className: run.id === opened() ? "open" : "" }, head);
  row.dataset.run = run.id; row.dataset.state = run.state;
  if (run.state === "done") {
    const box = make("input", { type: "checkbox", checked: chosen.has(run.id), onchange: () => { box.checked ? chosen.add(run.id) : chosen.delete(run.id); drawRuns(); } });
    box.setAttribute("aria-label", `choose ${run.name} to compare`); box.dataset.act = `${run.id} choose`;
    head.append(box, linkTo(run, run.name));
  } else {
    head.append(make("span", { className: "name", textContent: run.name }), make("span", { className: run.state, textContent: run.state }));
  }
  head.append(...progressOf(run));
  const under = ["running", "waiting"].includes(run.state);
  if (under) head.append(button(run, "Cancel", "cancel", () => act(run, "cancel").then(listNow)));
  else if (run.state !== "done") head.append(button(run, "Go on", "go-on", () => act(run, "go-on").then(listNow)));
  head.append(button(run, "Edit case", "values", () => editCase(run)));
  if (!under) head.append(button(run, "Delete", "delete", () => { if (confirm(`Delete ${run.name} with all its files?`)) act(run, "delete").then(listNow); }));
  row.append(make("p", { className: "about", textContent: [run.kind, run.changed].filter(Boolean).join(": ") }));
  if (run.message && !under) row.append(make("p", { className: "about failed", textContent: run.message }));
  return row;
}

async function listNow() {
  runs = await ask("ask/runs").catch(() => runs);
  listAnew();
}

async function editCase(run) {
  try { fill(await ask(`runs/${run.id}/values`)); find("case").scrollIntoView(); } catch (error) { showErrors(error.errors); }
}

export async function roll() {
  find("roll").disabled = true;
  try {
    const made = await ask("ask/runs", { kind: kind.value, values: typed(), name: find("run-name").value });
    showErrors([]);
    rolled = made.id;
    sessionStorage.setItem("rolled", rolled);
    location.hash = `run=${made.id}`;
    await listNow();
  } catch (error) {
    showErrors(error.errors);
  }
  find("roll").disabled = false;
}

export function compare() {
  const asked = runs.filter((run) => chosen.has(run.id)).reverse().map((run) => run.id).join(",");
  if (asked === compared) showComparison(asked);
  else location.hash = `compare=${asked}`;
}

async function showComparison(asked) {
  compared = asked;
  find("comparison").hidden = !asked;
  if (!asked) return;
  try {
    const found = await ask(`ask/compare?${asked.split(",").map((id) => `run=${encodeURIComponent(id)}`).join("&")}`);
    if (compared !== asked) return;
    find("comparison-words").replaceChildren(make("p", { textContent: found.summary }));
    showBlocks(find("comparison-blocks"), found);
  } catch (error) {
    find("comparison-words").replaceChildren(make("p", { className: "alert", textContent: error.message }));
  }
  find("comparison").scrollIntoView({ block: "start" });
}

export function listAnew() {
  listed = "";
  drawRuns();
}
