// Figures of a page: their panels, legends, buttons and keys; what one does to the others.

const GAP = 24, NARROW = 620, HIGH = [74, 104];  // pixels of the page; between them an inch of a panel's height
const off = new Set();  // laws that are not shown on this page
const figures = new Set();
let paper = false;  // the page is drawn for it

const HELP = "Arrow keys move the cursor, page keys move it farther, plus and minus zoom, with shift the arrows shift what is seen, 0 shows all.";

function show(found, root = document) {  // what `charts_json` wrote, in the figures of a page
  if (typeof DecompressionStream === "undefined") return Promise.resolve();
  const elements = Object.keys(found.charts).map((name) => [name, root.querySelector(`#${CSS.escape(name)}`)]).filter(([, element]) => element);
  for (const [, element] of elements) for (const folded of element.querySelectorAll("details.numbers")) folded.open = false;
  return unpacked(found).then((get) => {
    if (!document.getElementById("chart-keys")) make("p", { id: "chart-keys", hidden: true, textContent: HELP }, document.body);
    for (const [name, element] of elements) {
      for (const old of figures) if (old.element === element) old.remove();
      figures.add(figureOf(element, found.charts[name], get, found.colours));
    }
  });
}

function figureOf(element, chart, get, light) {
  const area = element.querySelector(".plot"), title = element.querySelector("h3")?.textContent ?? "";
  const hidden = new Set(), spans = new Map();
  let active, visible = false, colours = {};
  area.replaceChildren();
  const onPaper = (name) => (name.startsWith("--") ? light[name.slice(3)] ?? "#ffffff" : name);
  const colour = (name) => {
    if (paper || !name.startsWith("--")) return onPaper(name);
    return (colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(name).trim() || onPaper(name));
  };
  const figure = {
    element, onPaper, left: 0,
    shows: (mark) => !(mark.law && off.has(mark.law)) && !(mark.label && hidden.has(keyOf(mark))),
    all: (panel) => { panel.span.y = null; zoomTo(panel, null); },
    select, draw, forget: () => { colours = {}; },
    sooner: () => { if (!visible) { visible = true; draw(); } },
    linked, renew,
    remove: () => { figures.delete(figure); near.disconnect(); sizes.disconnect(); panels.forEach((panel) => panel.plot?.destroy()); },
  };

  const tools = make("div", { className: "tools" }, area);
  const legend = make("div", { className: "curves" }, tools);
  const buttons = make("div", { className: "buttons" }, tools);
  const panels = chart.panels.map((told, n) => {
    const box = make("div", { className: "panel" });
    const names = make("div", { className: "names" }, box);
    if (told.title) make("strong", { textContent: told.title }, names);
    make("span", { textContent: told.y.label }, names);
    const field = told.marks.find((mark) => mark.kind === "field");
    const beside = [told.x.second && `above: ${told.x.second.label}`, told.y.second && `right: ${told.y.second.label}`, field && `colours: ${field.label}`];
    make("span", { className: "beside", textContent: beside.filter(Boolean).join("; ") }, names);
    const host = make("div", { className: "host", tabIndex: 0 }, box);
    host.setAttribute("role", "application");
    host.setAttribute("aria-label", [title, told.title, `${field ? field.label : told.y.label} over ${told.x.label}`].filter(Boolean).join(": "));
    host.setAttribute("aria-describedby", "chart-keys");
    const next = chart.panels[n + 1];
    if (!(next && !next.beside && !told.beside && next.x.label === told.x.label)) make("div", { className: "along", textContent: told.x.label }, box);
    const panel = { told, figure, box, host, number: n, key: told.x.linked || `own ${n}`, span: { y: null }, at: null };
    panel.seen = (way) => (way === "x" ? spans.get(panel.key) : panel.span.y) ?? panel.full[way];
    host.addEventListener("focusin", () => { active = panel; });
    host.addEventListener("keydown", (event) => press(panel, event));
    return panel;
  });
  active = panels[0];
  const rows = [];
  for (const panel of panels) {
    if (panel.told.beside && rows.length) rows.at(-1).panels.push(panel);
    else rows.push({ panels: [panel], row: make("div", { className: "row" }, area) });
    rows.at(-1).row.append(panel.box);
  }
  const status = make("p", { className: "reading" }, area);
  status.setAttribute("role", "status");
  const outputs = legendOf();
  const whenZoomed = buttonsOf();

  const printed = (name, usual) => parseFloat(getComputedStyle(element).getPropertyValue(`--print-${name}`)) || usual;
  const sized = () => (paper ? printed("width", 680) : area.clientWidth);
  const narrow = () => sized() < NARROW;
  const inRows = ({ told: { y } }) => y.ticks?.length && !y.log;  // rows with names, which need their height
  const heightOf = (panel) => panel.told.height ?? 3.6;
  function arrange() {  // gives each panel its width and height in pixels of the page
    const width = sized(), inch = paper ? printed("inch", 58) : within(width / 9.6, ...HIGH);
    for (const { row, panels: beside } of rows) {
      const shares = beside.reduce((sum, panel) => sum + (panel.told.share ?? 1), 0), stacked = narrow() || beside.length === 1;
      row.classList.toggle("stacked", stacked);
      for (const panel of beside) {
        panel.width = stacked ? width : Math.floor(((width - GAP * (beside.length - 1)) * (panel.told.share ?? 1)) / shares);
        panel.height = Math.round((inRows(panel) ? Math.max(inch, 70) : inch) * heightOf(panel));
        panel.box.style.width = `${panel.width}px`;
        panel.host.style.minHeight = panel.plot ? "" : `${panel.height}px`;
      }
    }
  }

  function draw() {
    if (!sized()) return;
    for (const panel of panels) {
      panel.marks ??= panel.told.marks.map((mark) => whole(mark, get));
      panel.full = { x: limits(panel, "x", () => true) };
      fit(panel);
    }
    const alone = rows.filter((row) => row.panels.length === 1 || narrow()).flatMap((row) => row.panels);
    figure.left = 0;
    figure.left = Math.max(40, ...alone.map((panel) => measured(panel, panel.width ?? 600, panel.height ?? 300).left));
    arrange();
    for (const panel of panels) {
      panel.plot?.destroy();
      if (panel.told.beside || rows.some((row) => row.panels[0] === panel && row.panels.length > 1)) inOwnColumn(panel);
      else panel.plot = plotOf(panel, panel.width, panel.height, colour, paper ? PRINTED : 1);
      panel.host.style.minHeight = "";
      if (!paper) watch(panel);
    }
    swatches();
  }
  function inOwnColumn(panel) {
    const shared = figure.left;
    if (!narrow()) figure.left = 0;
    panel.plot = plotOf(panel, panel.width, panel.height, colour, paper ? PRINTED : 1);
    panel.left = figure.left;
    figure.left = shared;
  }
  function fit(panel) {  // the axis upwards suits what is seen
    const shown = panel.marks.some((mark) => mark.kind !== "note" && figure.shows(mark)) ? figure.shows : () => true;
    panel.full.y = limits(panel, "y", shown, ...ascending(panel.seen("x")));
  }
  function renew(some = panels) {  // draws again what is shown now
    for (const panel of some) {
      if (!panel.plot) continue;
      fit(panel);
      const [x, y] = ["x", "y"].map((way) => ascending(panel.seen(way)));
      panel.plot.batch(() => {
        panel.plot.setScale("x", { min: x[0], max: x[1] });
        panel.plot.setScale("y", { min: y[0], max: y[1] });
        panel.plot.redraw(true, true);
      });
      if (panel.at) queueMicrotask(() => pointTo(panel, panel.at));
    }
    whenZoomed();
  }

  // zoom: along x of all panels that share its axis
  function zoomTo(panel, ends) {
    const { x: axis } = panel.told, [low, high] = ascending(panel.full.x).map((end) => scaled(axis, end));
    if (ends) {
      const least = (high - low) / Math.max(1000, (stopsOf(panel)?.length ?? 0) / 8);
      let [from, to] = ends.map((end) => scaled(axis, end));
      const length = within(to - from, least, high - low);
      from = within((from + to - length) / 2, low, high - length);
      to = from + length;
      ends = length > (high - low) * (1 - 1e-9) ? null : [unscaled(axis, from), unscaled(axis, to)];
    }
    if (ends) spans.set(panel.key, panel.full.x[0] > panel.full.x[1] ? [ends[1], ends[0]] : ends); else spans.delete(panel.key);
    renew(panels.filter((each) => each.key === panel.key));
  }
  function zoom(factor, panel = active) {
    if (!panel.plot) return;
    const nearTo = (way, middle) => {
      const axis = panel.told[way], [low, high] = ascending(panel.seen(way)).map((end) => scaled(axis, end));
      const at = middle === undefined || middle === null ? NaN : scaled(axis, middle), about = at >= low && at <= high ? at : (low + high) / 2;
      return [about - (about - low) * factor, about + (high - about) * factor].map((end) => unscaled(axis, end));
    };
    if (isField(panel)) panel.span.y = insideOf(panel, nearTo("y", panel.at?.[1]));
    zoomTo(panel, nearTo("x", panel.at?.[0]));
  }
  const isField = (panel) => panel.marks.some((mark) => mark.kind === "field");
  function insideOf(panel, [from, to]) {
    const [low, high] = ascending(panel.full.y);
    return to - from >= high - low ? null : [Math.max(from, low), Math.min(to, high)];
  }
  function shift(share, panel = active) {
    if (!panel.plot) return;
    const axis = panel.told.x, [low, high] = ascending(panel.full.x).map((end) => scaled(axis, end));
    const [from, to] = ascending(panel.seen("x")).map((end) => scaled(axis, end)), by = within(share * (to - from), low - from, high - to);
    zoomTo(panel, [from + by, to + by].map((end) => unscaled(axis, end)));
  }
  function select(panel) {
    const { plot } = panel, { left, top, width, height } = plot.select;
    if (!width && !height) return;
    const x = ascending([plot.posToVal(left, "x"), plot.posToVal(left + width, "x")]);
    const y = ascending([plot.posToVal(top + height, "y"), plot.posToVal(top, "y")]);
    const over = plot.over;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    active = panel;
    if (height && height < over.clientHeight - 1) panel.span.y = panel.full.y[0] > panel.full.y[1] ? [y[1], y[0]] : y;
    zoomTo(panel, width && width < over.clientWidth - 1 ? x : spans.get(panel.key) ?? null);
  }

  // cursor
  function watch(panel) {
    const { plot } = panel;
    panel.dots = [];
    panel.note = make("div", { className: "at" }, plot.over);
    const move = (event) => {
      const box = plot.over.getBoundingClientRect();
      active = panel;
      read(panel, [plot.posToVal(event.clientX - box.left, "x"), plot.posToVal(event.clientY - box.top, "y")], false);
    };
    plot.over.addEventListener("mousemove", move);
    plot.over.addEventListener("mouseleave", () => { for (const each of figures) each.linked(null); });
  }
  function xName({ told: { x: axis }, seen }, x) {  // a band or a word by its name, else the number
    const [low, high] = seen("x").map((end) => scaled(axis, end)), unit = unitOf(axis.label);
    if (axis.ticks && !axis.minor) {
      const off = ([at]) => Math.abs(scaled(axis, at) - scaled(axis, x)), [, name] = axis.ticks.reduce((a, b) => (off(b) < off(a) ? b : a));
      return unit ? name.replace(/k?$/, (kilo) => ` ${kilo}${unit}`) : name;
    }
    const pixel = Math.abs(high - low) / 1000, digits = axis.log ? 4 : within(Math.ceil(Math.log10(Math.abs(x || 1) / pixel)), 2, 9);
    return `${written(x, digits)} ${unit}`.trim();
  }
  function read(panel, at, spoken) {
    panel.at = at;
    const found = readAt(panel, ...at), field = isField(panel);
    const place = field ? `${nameOf(panel.told.x.label).split(" (")[0]} ${xName(panel, at[0])}, ${nameOf(panel.told.y.label)} ${written(at[1], 3)}` : `${nameOf(panel.told.x.label)} ${xName(panel, at[0])}`.trim();
    tell(found);
    for (const each of figures) each.linked(panel, at[0]);
    point(panel, at, found);
    panel.note.textContent = field ? [place, ...found.map((each) => `${each.name} ${each.text}`)].join(": ") : place;
    if (spoken) status.textContent = `${place}: ${found.map((each) => `${each.name} ${each.text}`).join(", ") || "nothing"}`;
  }
  function pointTo(panel, at) {  // the cursor, where the scale has moved it
    const left = panel.plot.valToPos(at[0], "x"), top = at[1] === null ? -10 : panel.plot.valToPos(at[1], "y");
    const inside = left >= 0 && left <= panel.plot.over.clientWidth;
    panel.plot.setCursor(inside ? { left, top } : { left: -10, top: -10 }, false);
  }
  function point(panel, at, found) {
    pointTo(panel, at);
    const points = found.filter((each) => each.at && Number.isFinite(each.at[1]));
    while (panel.dots.length < points.length) panel.dots.push(make("div", { className: "dot" }, panel.plot.over));
    panel.dots.forEach((dot, n) => {
      dot.hidden = !points[n];
      if (points[n]) dot.style.transform = `translate(${panel.plot.valToPos(points[n].at[0], "x")}px, ${panel.plot.valToPos(points[n].at[1], "y")}px)`;
    });
  }
  function linked(source, x) {  // the cursor of another panel, or of none
    for (const panel of panels) {
      if (!panel.plot || panel === source || !panel.dots) continue;
      const together = source && panel.key === source.key && (source.figure === figure || source.key === "frequency");
      panel.note.textContent = "";
      panel.at = together ? [x, null] : null;
      const found = together ? readAt(panel, x, null) : [];
      point(panel, [together ? x : NaN, null], found);
      if (source?.figure !== figure && (together || !source) && panel.number === panels.findIndex((each) => each.key === panel.key)) tell(found);
    }
    if (!source) tell([]);
  }
  function tell(found) {
    for (const [key, output] of outputs) output.textContent = found.find((each) => each.key === key)?.text ?? "";
  }

  function press(panel, event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !panel.plot) return;
    const field = isField(panel), [low, high] = ascending(panel.seen("x"));
    const act = {
      ArrowLeft: () => (event.shiftKey ? shift(-0.2, panel) : step(panel, -1)),
      ArrowRight: () => (event.shiftKey ? shift(0.2, panel) : step(panel, 1)),
      PageDown: () => step(panel, 40), PageUp: () => step(panel, -40),
      Home: () => step(panel, -Infinity), End: () => step(panel, Infinity),
      "+": () => zoom(0.5, panel), "=": () => zoom(0.5, panel), "-": () => zoom(2, panel), 0: () => figure.all(panel),
      ...(field ? { ArrowUp: () => climb(panel, 1), ArrowDown: () => climb(panel, -1) } : {}),
    }[event.key];
    if (!act || !(high > low)) return;
    event.preventDefault();
    active = panel;
    act();
  }
  function step(panel, count) {
    const stops = stopsOf(panel), { x: axis } = panel.told, [low, high] = ascending(panel.seen("x")).map((end) => scaled(axis, end));
    const pixel = (high - low) / (panel.plot.over.clientWidth || 1);
    let x = panel.at?.[0];
    if (x === undefined || x === null || Number.isNaN(x)) x = unscaled(axis, (low + high) / 2);
    if (stops) {
      let here = Math.min(placeIn(stops, x), stops.length - 1);
      if (here > 0 && Math.abs(stops[here - 1] - x) < Math.abs(stops[here] - x)) here--;
      const inSight = placeIn(stops, unscaled(axis, high)) - placeIn(stops, unscaled(axis, low));
      const each = Math.max(1, Math.round((inSight * pixel) / (high - low)));
      x = stops[within(here + count * each, 0, stops.length - 1)];
    } else {
      const ends = ascending(panel.full.x);
      x = within(unscaled(axis, scaled(axis, x) + count * 4 * pixel), ...ends);
    }
    if (scaled(axis, x) < low || scaled(axis, x) > high) {
      const half = (high - low) / 2;
      zoomTo(panel, [scaled(axis, x) - half, scaled(axis, x) + half].map((end) => unscaled(axis, end)));
    }
    read(panel, [x, isField(panel) ? panel.at?.[1] ?? middleOf(panel) : null], true);
  }
  const middleOf = (panel) => (panel.seen("y")[0] + panel.seen("y")[1]) / 2;
  function climb(panel, count) {
    const [low, high] = ascending(panel.seen("y")), by = (4 * count * (high - low)) / (panel.plot.over.clientHeight || 1);
    const x = panel.at?.[0] ?? (panel.seen("x")[0] + panel.seen("x")[1]) / 2;
    read(panel, [x, within((panel.at?.[1] ?? middleOf(panel)) + by, low, high)], true);
  }

  // legend and buttons
  function legendOf() {
    legend.setAttribute("role", "group");
    legend.setAttribute("aria-label", `What is drawn: ${title}`);
    const entries = new Map();
    for (const panel of panels) {
      for (const mark of panel.told.marks) if (mark.label && mark.kind !== "field" && !entries.has(keyOf(mark))) entries.set(keyOf(mark), mark);
    }
    const found = new Map(), ofLaws = [...entries.values()].filter((mark) => mark.law && mark.kind === "line");
    const main = ofLaws.find((mark) => mark.width > 2) ?? ofLaws.at(-1);  // drawn last, on top
    for (const [key, mark] of [...entries].sort(([, a], [, b]) => (b === main) - (a === main))) {
      const label = make("label", {}, legend), box = make("input", { type: "checkbox", checked: true }, label);
      box.dataset.law = mark.law ?? "";
      box.addEventListener("change", () => {
        const from = mark.law ? off : hidden, name = mark.law || key;
        if (box.checked) from.delete(name); else from.add(name);
        for (const each of mark.law ? figures : [figure]) { each.toggled?.(); each.renew(); }
      });
      make("canvas", { className: "swatch" }, label).mark = mark;
      make("span", { textContent: mark.label }, label);
      found.set(key, make("span", { className: "value" }, label));
    }
    figure.toggled = () => { for (const box of legend.querySelectorAll("input")) if (box.dataset.law) box.checked = !off.has(box.dataset.law); };
    figure.toggled();
    return found;
  }
  function swatches() {
    const unit = devicePixelRatio * (paper ? PRINTED : 1);
    for (const swatch of legend.querySelectorAll(".swatch")) {
      Object.assign(swatch, { width: 30 * unit, height: 12 * unit });
      const view = { ctx: swatch.getContext("2d"), left: 0, top: 0, right: 30 * unit, bottom: 12 * unit, unit, colour, lowest: 0, highest: 30 };
      Object.assign(view, { x: (at) => at * unit, y: (at) => at * unit });
      const { mark } = swatch, box = { left: [4], right: [26], low: [1], high: [11] };
      if (mark.kind === "line") for (const x of [[1, 29], [15]]) drawMark(view, { ...mark, x, y: [6, 6], marker: x.length > 1 ? "" : mark.marker });
      if (mark.kind === "area") drawMark(view, { ...mark, kind: "boxes", ...box });
      if (mark.kind === "boxes") drawMark(view, { ...mark, ...box });
      if (mark.kind === "rules") drawMark(view, { ...mark, along: "y", at: [6], short: false });
    }
  }
  function buttonsOf() {
    const button = (text, name, act) => {
      const made = make("button", { type: "button", textContent: text }, buttons);
      if (name) { made.title = name; made.setAttribute("aria-label", name); }
      made.addEventListener("click", act);
      return made;
    };
    for (const [place, stretches] of Object.entries(chart.places)) {
      let next = 0;
      button(place, "", () => {
        const ends = stretches[next++ % stretches.length], panel = panels[0];
        figure.sooner();
        zoomTo(panel, ends);
        read(panel, [(ends[0] + ends[1]) / 2, isField(panel) ? middleOf(panel) : null], true);
      });
    }
    const shifted = [
      button("all", "show all", () => { for (const panel of panels) { panel.span.y = null; zoomTo(panel, null); } }),
      button("◂", "shift to lower values", () => shift(-0.5)),
      button("▸", "shift to higher values", () => shift(0.5)),
    ];
    button("−", "zoom out", () => zoom(2));
    button("+", "zoom in", () => zoom(0.5));
    const update = () => {
      const zoomed = spans.size > 0 || panels.some((panel) => panel.span.y);
      for (const each of shifted) each.classList.toggle("idle", !zoomed);
    };
    update();
    return update;
  }

  element.classList.add("ready");
  arrange();
  let width = area.clientWidth;
  const sizes = new ResizeObserver(() => {
    if (paper || !area.clientWidth || area.clientWidth === width) return;
    width = area.clientWidth;
    if (visible) draw(); else arrange();
  });
  sizes.observe(area);
  const near = new IntersectionObserver((seen) => {
    if (!seen.some((each) => each.isIntersecting)) return;
    near.disconnect();
    figure.sooner();
  }, { rootMargin: "600px 0px" });
  near.observe(area);
  figure.drawn = () => visible;
  return figure;
}

function redrawn(onPaper, all = false) {
  paper = onPaper;
  for (const figure of figures) {
    figure.forget();
    if (all) figure.sooner();
    if (figure.drawn()) figure.draw();
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
