// What stands above a figure: which marks are shown, with what is read of them, and buttons.

function legendOf(figure) {  // where the readings of entries are written, by their keys
  const marks = figure.panels.flatMap((panel) => panel.told.marks).filter((mark) => mark.label && mark.kind !== "field");
  const entries = new Map(), found = new Map();
  for (const mark of marks) if (!entries.has(keyOf(mark))) entries.set(keyOf(mark), mark);
  const ofLaws = marks.filter((mark) => mark.law && mark.kind === "line");
  const main = ofLaws.find((mark) => mark.width > 2) ?? ofLaws.at(-1);  // drawn last, on top
  const isMain = ([key]) => Number(main !== undefined && key === keyOf(main));
  figure.legend.setAttribute("role", "group");
  figure.legend.setAttribute("aria-label", `What is drawn: ${figure.title}`);
  for (const [key, mark] of [...entries].sort((a, b) => isMain(b) - isMain(a))) {
    const label = make("label", {}, figure.legend), box = make("input", { type: "checkbox" }, label);
    make("canvas", { className: "swatch" }, label).mark = mark;
    make("span", { textContent: mark.label }, label);
    found.set(key, make("span", { className: "value" }, label));
    box.mark = mark;
    box.addEventListener("change", () => {  // a law in all figures of the page
      const from = mark.law ? off : figure.hidden, name = mark.law || key;
      if (box.checked) from.delete(name); else from.add(name);
      for (const each of mark.law ? figures : [figure]) { tickBoxes(each); each.renew(); }
    });
  }
  tickBoxes(figure);
  return found;
}

function tickBoxes(figure) {
  for (const box of figure.legend.querySelectorAll("input")) box.checked = figure.shows(box.mark);
}

function drawSwatches(figure) {
  const unit = devicePixelRatio * (paper ? PRINTED : 1), box = { left: [4], right: [26], low: [1], high: [11] };
  const along = (at) => at * unit;
  for (const swatch of figure.legend.querySelectorAll(".swatch")) {
    Object.assign(swatch, { width: 30 * unit, height: 12 * unit });
    const view = { ctx: swatch.getContext("2d"), left: 0, top: 0, right: 30 * unit, bottom: 12 * unit, unit,
      colour: figure.colour, x: along, y: along, lowest: 0, highest: 30 };
    const { mark } = swatch, as = (changed) => drawMark(view, { ...mark, ...changed });
    if (mark.kind === "line") {
      as({ x: [1, 29], y: [6, 6], marker: "" });
      as({ x: [15], y: [6] });
    } else if (mark.kind === "rules") as({ along: "y", at: [6], short: false });
    else as({ kind: "boxes", ...box });
  }
}

function buttonsOf(figure) {  // a function that shows those that suit what is seen
  const button = (text, name, act) => {
    const made = make("button", { type: "button", textContent: text }, figure.buttons);
    if (name) { made.title = name; made.setAttribute("aria-label", name); }
    made.addEventListener("click", act);
    return made;
  };
  const ofZoom = [
    button("all", "show all", () => figure.panels.forEach(showAll)),
    button("◂", "shift to lower values", () => shift(figure.active, -0.5)),
    button("▸", "shift to higher values", () => shift(figure.active, 0.5)),
  ];
  button("−", "zoom out", () => zoom(figure.active, 2));
  button("+", "zoom in", () => zoom(figure.active, 0.5));
  return () => {
    const zoomed = figure.spans.size > 0 || figure.panels.some((panel) => panel.span.y);
    for (const each of ofZoom) each.classList.toggle("idle", !zoomed);
  };
}
