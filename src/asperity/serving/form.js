// The form that becomes a case, the sliders of what is changed most, and the surfaces it may name.

import { ask, find, make } from "./asking.js";

export const kind = find("kind");
export const form = () => document.querySelector(`.case-form[data-kind="${kind.value}"]`);

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

// The order in which boxes are ticked is that of the list.
export function tick(box) {
  if (box.type !== "checkbox") return;
  const field = box.closest(".field"), order = (field.dataset.order || "").split(",").filter(Boolean);
  field.dataset.order = (box.checked ? [...order, box.value] : order.filter((name) => name !== box.value)).join(",");
}

const fields = (of = form()) => [...of.querySelectorAll(".field")];

export function typed(of = form()) {
  return Object.fromEntries(fields(of).map((field) => [field.dataset.key, valueOf(field)]).filter(([, value]) => value));
}

function firstOf(field) {
  return field.querySelector("input[data-first]")?.dataset.first ?? field.querySelector("option[data-first]")?.value ?? "";
}

export function firstValues(of) {
  for (const field of fields(of)) setValue(field, firstOf(field));
}

export function fill(found) {
  kind.value = found.kind;
  for (const field of fields()) {
    setValue(field, found.values[field.dataset.key] || "");
    if (valueOf(field)) field.closest("details").open = true;
  }
  changed();
}

// Keys that go with another one are shown once that one is there; the rest by what is looked for.
export function arrange() {
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

export function showErrors(errors) {
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

// Kept in the tab, and where the next tab begins: a reload, or a tab that was closed by mistake, loses nothing.
export function remember() {
  const values = Object.fromEntries([...document.querySelectorAll(".case-form")].map((each) => [each.dataset.kind, typed(each)]));
  const text = JSON.stringify({ kind: kind.value, values, name: find("run-name").value });
  for (const store of [sessionStorage, localStorage]) store.setItem("form", text);
}

export function recall() {
  const kept = JSON.parse(sessionStorage.getItem("form") ?? localStorage.getItem("form") ?? "null");
  for (const each of document.querySelectorAll(".case-form")) {
    firstValues(each);
    const values = kept?.values[each.dataset.kind];
    if (values) for (const field of fields(each)) setValue(field, values[field.dataset.key] || "");
  }
  if (kept) { kind.value = kept.kind; find("run-name").value = kept.name; }
  arrange();
  setSliders();
}

// Whoever follows the case hears of it by an event, once nothing is typed for a moment.
let later;
export function changed(slid = false) {
  arrange();
  remember();
  if (!slid) setSliders();
  clearTimeout(later);
  later = setTimeout(() => document.dispatchEvent(new Event("case-changed")), slid ? 0 : 250);
}

// ---- sliders: a number of the form, from a tenth of it to ten times as much, or 20 dB less and more ------------

const turned = new Map();  // by slider: the field that it turns, and what stood there when it was in the middle

function setSliders() {
  const values = typed(), known = fields().filter((field) => active(field.dataset.goesWith, values));
  for (const slider of document.querySelectorAll("#sliders input")) {
    const keys = slider.dataset.turns.split(" ");
    const found = keys.map((key) => known.find((field) => field.dataset.key.endsWith(key))).find((field) => field && quantityOf(field));
    turned.set(slider, found && { field: found, ...quantityOf(found) });
    slider.value = "0";
    slider.disabled = !found;
    sayTurned(slider);
  }
}

function quantityOf(field) {
  const found = /^([+-]?[\d.]+(?:e[+-]?\d+)?)\s*(\S.*)$/i.exec(valueOf(field) || field.querySelector("input")?.placeholder || "");
  return found && { number: Number(found[1]), unit: found[2] };
}

export function slide(slider) {
  const { field, number, unit } = turned.get(slider), share = Number(slider.value) / 100;
  const now = unit === "dB" ? number + Math.round(20 * share) : number * 10 ** share;
  setValue(field, `${unit === "dB" && now >= 0 ? "+" : ""}${Number(now.toPrecision(3))} ${unit}`);
  sayTurned(slider);
  changed(true);
}

function sayTurned(slider) {
  const field = turned.get(slider)?.field, words = field ? valueOf(field) || field.querySelector("input").placeholder : "no number to turn";
  slider.parentElement.querySelector("output").textContent = words;
  slider.setAttribute("aria-valuetext", words);
  slider.title = field?.dataset.key ?? "";
}

// ---- surfaces ----------------------------------------------------------------------------------------------

export async function listSurfaces() {
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

export async function upload(file) {
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
