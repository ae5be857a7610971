// Figures of a page, and when they are drawn.

const GAP = 24, NARROW = 620, HIGH = [74, 104];  // pixels of the page; between them an inch of a panel's height
const off = new Set();  // laws that are not shown on this page
const figures = new Set();
let paper = false;  // the page is drawn for it

const HELP = "Arrow keys move the cursor, page keys move it farther, plus and minus zoom, with shift the arrows shift what is seen, 0 shows all.";

async function show(found, root = document) {  // what `charts_json` wrote, in the figures of a page
  if (typeof DecompressionStream === "undefined") return;
  const named = Object.keys(found.charts).map((name) => [name, root.querySelector(`#${CSS.escape(name)}`)]);
  const elements = named.filter(([, element]) => element);
  for (const [, element] of elements) for (const folded of element.querySelectorAll("details.numbers")) folded.open = false;
  const get = await unpacked(found);
  if (!figures.size) for (const law of found.unticked ?? []) off.add(law);  // what a reader ticked stays ticked
  if (!document.getElementById("chart-keys")) make("p", { id: "chart-keys", hidden: true, textContent: HELP }, document.body);
  for (const [name, element] of elements) {
    for (const old of figures) if (old.element === element) old.remove();
    figures.add(new Figure(element, found.charts[name], get, found.colours));
  }
}

class Figure {
  constructor(element, chart, get, light) {
    Object.assign(this, { element, get, light, area: element.querySelector(".plot"), visible: false, colours: {} });
    this.title = element.querySelector("h2, h3")?.textContent ?? "";
    this.hidden = new Set();  // marks that are no law's
    this.spans = new Map();  // what is seen along x, where it is not all
    this.area.replaceChildren();
    const tools = make("div", { className: "tools" }, this.area);
    this.legend = make("div", { className: "curves" }, tools);
    this.buttons = make("div", { className: "buttons" }, tools);
    this.panels = chart.panels.map((told, n) => this.panelOf(told, n, chart.panels[n + 1]));
    [this.active] = this.panels;
    this.rows = [];
    for (const panel of this.panels) {
      if (!panel.told.beside || !this.rows.length) this.rows.push({ panels: [], row: make("div", { className: "row" }, this.area) });
      this.rows.at(-1).panels.push(panel);
      this.rows.at(-1).row.append(panel.box);
    }
    this.status = make("p", { className: "reading" }, this.area);
    this.status.setAttribute("role", "status");
    this.outputs = legendOf(this);
    this.showButtons = buttonsOf(this);
    this.showButtons();
    element.classList.add("ready");
    this.arrange();
    this.observe();
  }

  panelOf(told, number, next) {
    const box = make("div", { className: "panel" }), names = make("div", { className: "names" }, box);
    const field = told.marks.find((mark) => mark.kind === "field");
    const beside = { above: told.x.second?.label, right: told.y.second?.label, colours: field?.label };
    const others = Object.entries(beside).filter(([, label]) => label).map(([where, label]) => `${where}: ${label}`);
    if (told.title) make("strong", { textContent: told.title }, names);
    make("span", { textContent: told.y.label }, names);
    make("span", { className: "beside", textContent: others.join("; ") }, names);
    const host = make("div", { className: "host", tabIndex: 0 }, box);
    const what = [this.title, told.title, [field?.label ?? told.y.label, told.x.label].filter(Boolean).join(" over ")];
    for (const [name, value] of [["role", "application"], ["aria-label", what.filter(Boolean).join(": ")], ["aria-describedby", "chart-keys"]]) {
      host.setAttribute(name, value);
    }
    const goesOn = next && !next.beside && !told.beside && next.x.label === told.x.label;
    if (!goesOn) make("div", { className: "along", textContent: told.x.label }, box);
    const panel = { told, box, host, figure: this, key: told.x.linked || `own ${number}`, span: { y: null }, at: null };
    panel.seen = (way) => (way === "x" ? this.spans.get(panel.key) : panel.span.y) ?? panel.full[way];
    host.addEventListener("focusin", () => { this.active = panel; });
    host.addEventListener("keydown", (event) => press(panel, event));
    return panel;
  }

  observe() {
    let width = this.area.clientWidth;
    this.sizes = new ResizeObserver(() => {
      if (paper || !this.area.clientWidth || this.area.clientWidth === width) return;
      width = this.area.clientWidth;
      if (this.visible) this.draw(); else this.arrange();
    });
    this.near = new IntersectionObserver((seen) => {
      if (seen.some((each) => each.isIntersecting)) this.appear();
    }, { rootMargin: "600px 0px" });
    this.sizes.observe(this.area);
    this.near.observe(this.area);
  }

  remove() {
    figures.delete(this);
    this.near.disconnect();
    this.sizes.disconnect();
    for (const panel of this.panels) panel.plot?.destroy();
  }

  appear() {
    this.near.disconnect();
    if (this.visible) return;
    this.visible = true;
    this.draw();
  }

  onPaper = (name) => (name.startsWith("--") ? this.light[name.slice(3)] ?? "#ffffff" : name);

  colour = (name) => {
    if (paper || !name.startsWith("--")) return this.onPaper(name);
    return (this.colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(name).trim() || this.onPaper(name));
  };

  shows = (mark) => !(mark.law && off.has(mark.law)) && !(mark.label && this.hidden.has(keyOf(mark)));

  printed(name, usual) {
    return parseFloat(getComputedStyle(this.element).getPropertyValue(`--print-${name}`)) || usual;
  }

  get width() {
    return paper ? this.printed("width", 680) : this.area.clientWidth;
  }

  arrange() {  // gives each panel its width and height in pixels of the page
    const { width } = this, inch = paper ? this.printed("inch", 58) : within(width / 9.6, ...HIGH);
    const inRows = ({ told: { y } }) => y.ticks?.length && !y.log;  // with names, which need their height
    for (const { row, panels } of this.rows) {
      const shares = panels.map((panel) => panel.told.share ?? 1), all = shares.reduce((sum, share) => sum + share);
      const stacked = panels.length === 1 || width < NARROW;
      row.classList.toggle("stacked", stacked);
      panels.forEach((panel, n) => {
        panel.alone = stacked;
        panel.width = stacked ? width : Math.floor(((width - GAP * (panels.length - 1)) * shares[n]) / all);
        panel.height = Math.round((inRows(panel) ? Math.max(inch, 70) : inch) * (panel.told.height ?? 3.6));
        panel.box.style.width = `${panel.width}px`;
        panel.host.style.minHeight = panel.plot ? "" : `${panel.height}px`;
      });
    }
  }

  draw() {
    if (!this.width) return;
    this.arrange();
    for (const panel of this.panels) {
      panel.marks ??= panel.told.marks.map((mark) => whole(mark, this.get));
      panel.full = { x: limits(panel, "x", () => true) };
      this.fit(panel);
    }
    for (const panel of this.panels) panel.left = 0;
    const needed = this.panels.filter((panel) => panel.alone).map((panel) => measured(panel, panel.width, panel.height).left);
    const shared = Math.max(40, ...needed);  // beneath each other, they begin at the same place
    for (const panel of this.panels) {
      panel.left = panel.alone ? shared : 0;
      panel.plot?.destroy();
      panel.plot = plotOf(panel, panel.width, panel.height, this.colour, paper ? PRINTED : 1);
      panel.host.style.minHeight = "";
      watch(panel);
    }
    drawSwatches(this);
  }

  fit(panel) {  // the axis upwards suits what is seen
    const some = panel.marks.some((mark) => mark.kind !== "note" && this.shows(mark));
    panel.full.y = limits(panel, "y", some ? this.shows : () => true, ...ascending(panel.seen("x")));
  }

  renew(panels = this.panels) {  // draws again what is shown now
    for (const panel of panels.filter((each) => each.plot)) {
      this.fit(panel);
      panel.plot.batch(() => {
        for (const way of ["x", "y"]) {
          const [min, max] = ascending(panel.seen(way));
          panel.plot.setScale(way, { min, max });
        }
        panel.plot.redraw(true, true);
      });
      if (panel.at) point(panel, panel.at, readAt(panel, ...panel.at));
    }
    this.showButtons();
  }
}

function redrawn(onPaper, all = false) {
  paper = onPaper;
  for (const figure of figures) {
    figure.colours = {};
    if (figure.visible) figure.draw(); else if (all) figure.appear();
  }
}

addEventListener("beforeprint", () => {  // paper shows what is folded, but for numbers that are drawn
  for (const folded of document.querySelectorAll("details:not(.ready .numbers)")) folded.open = true;
  redrawn(true, true);
});
addEventListener("afterprint", () => redrawn(false));
matchMedia("print").addEventListener("change", (event) => { if (event.matches !== paper) redrawn(event.matches, true); });
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redrawn(paper));

window.asperityCharts = { show };
const source = document.getElementById("charts");
if (source) show(JSON.parse(source.textContent));
