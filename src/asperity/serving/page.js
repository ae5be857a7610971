// The page: everything at its place.

import { ask, dark, find } from "./asking.js";
import { press, pressAnew, redrawContact } from "./contact.js";
import { arrange, changed, fill, firstValues, form, kind, listSurfaces, recall, remember, showErrors, slide, tick, upload } from "./form.js";
import { compare, listAnew, listRuns, roll } from "./runs.js";
import { drawWatch, hear, play, shown } from "./watching.js";

function listenToForm() {
  for (const each of document.querySelectorAll(".case-form")) {
    each.addEventListener("input", (event) => { tick(event.target); changed(); });
    each.addEventListener("submit", (event) => { event.preventDefault(); roll(); });
  }
  kind.onchange = () => changed();
  find("find").oninput = arrange;
  find("run-name").oninput = remember;
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
  find("sliders").oninput = (event) => slide(event.target);
  find("compare").onclick = compare;
  find("play").onclick = () => play(!shown.playing);
  find("law").onchange = (event) => { shown.law = event.target.value; drawWatch(); };
  find("sound").onchange = hear;
  find("position").oninput = (event) => { shown.at = Number(event.target.value); drawWatch(); };
  document.addEventListener("case-changed", pressAnew);
  addEventListener("hashchange", listAnew);
  const redraw = () => { redrawContact(); drawWatch(); };
  addEventListener("resize", redraw);
  dark.addEventListener("change", redraw);
}

listenToForm();
listenToPictures();
await listSurfaces().catch((error) => showErrors(error.errors));
recall();
pressAnew();
listRuns();
