// What a reader does in a panel: zoom, and read at a cursor, by mouse and keys.

const isField = (panel) => panel.marks.some((mark) => mark.kind === "field");
const middleOf = (panel) => (panel.seen("y")[0] + panel.seen("y")[1]) / 2;
const endsOf = (panel, way, ends = panel.seen(way)) => ascending(ends).map((end) => scaled(panel.told[way], end));
const turned = (panel, way, ends) => (ends && panel.full[way][0] > panel.full[way][1] ? [ends[1], ends[0]] : ends);

// Zoom along x, with all panels of the figure that share the axis; all is seen without `ends`.
function zoomTo(panel, ends) {
  const { figure, key } = panel, axis = panel.told.x, [low, high] = endsOf(panel, "x", panel.full.x);
  if (ends) {
    const least = (high - low) / Math.max(1000, (stopsOf(panel)?.length ?? 0) / 8);
    const [from, to] = endsOf(panel, "x", ends), length = within(to - from, least, high - low);
    const start = within((from + to - length) / 2, low, high - length);
    ends = length > (high - low) * (1 - 1e-9) ? null : [start, start + length].map((end) => unscaled(axis, end));
  }
  if (ends) figure.spans.set(key, turned(panel, "x", ends)); else figure.spans.delete(key);
  figure.renew(figure.panels.filter((each) => each.key === key));
}

function showAll(panel) {
  panel.span.y = null;
  if (panel.plot) zoomTo(panel, null);
}

function zoom(panel, factor) {
  if (!panel.plot) return;
  const about = (way, at) => {
    const axis = panel.told[way], [low, high] = endsOf(panel, way), place = Number.isFinite(at) ? scaled(axis, at) : NaN;
    const middle = place >= low && place <= high ? place : (low + high) / 2;
    return [middle - (middle - low) * factor, middle + (high - middle) * factor].map((end) => unscaled(axis, end));
  };
  const [x, y] = panel.at ?? [];
  if (isField(panel)) {
    const [from, to] = about("y", y), [low, high] = ascending(panel.full.y);
    panel.span.y = to - from >= high - low ? null : turned(panel, "y", [Math.max(from, low), Math.min(to, high)]);
  }
  zoomTo(panel, about("x", x));
}

function shift(panel, share) {
  if (!panel.plot) return;
  const [low, high] = endsOf(panel, "x", panel.full.x), [from, to] = endsOf(panel, "x");
  const by = within(share * (to - from), low - from, high - to);
  zoomTo(panel, [from + by, to + by].map((end) => unscaled(panel.told.x, end)));
}

function select(panel) {  // what was dragged over
  const { plot } = panel, { clientWidth, clientHeight } = plot.over;
  let { left, top, width, height } = plot.select;
  if (!width && !height) return;
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  if (panel.told.equal) {  // as long along x as along y
    const share = Math.max(width / clientWidth, height / clientHeight);
    left = within(left + (width - share * clientWidth) / 2, 0, (1 - share) * clientWidth);
    top = within(top + (height - share * clientHeight) / 2, 0, (1 - share) * clientHeight);
    [width, height] = [share * clientWidth, share * clientHeight];
  }
  const between = (way, from, to) => ascending([plot.posToVal(from, way), plot.posToVal(to, way)]);
  panel.figure.active = panel;
  if (height && height < clientHeight - 1) panel.span.y = turned(panel, "y", between("y", top, top + height));
  const across = width && width < clientWidth - 1;
  zoomTo(panel, across ? between("x", left, left + width) : panel.figure.spans.get(panel.key) ?? null);
}

function watch(panel) {
  const { over } = panel.plot;
  panel.dots = [];
  panel.note = make("div", { className: "at" }, over);
  over.addEventListener("mousemove", (event) => {
    const box = over.getBoundingClientRect();
    panel.figure.active = panel;
    read(panel, [panel.plot.posToVal(event.clientX - box.left, "x"), panel.plot.posToVal(event.clientY - box.top, "y")], false);
  });
  over.addEventListener("mouseleave", () => { for (const each of figures) follow(each, null); });
}

function xName({ told: { x: axis }, seen }, x) {  // a band or a word by its name, else the number
  const unit = unitOf(axis.label);
  if (axis.ticks && !axis.minor) {
    const away = ([at]) => Math.abs(scaled(axis, at) - scaled(axis, x));
    const [, name] = axis.ticks.reduce((a, b) => (away(b) < away(a) ? b : a));
    return unit ? name.replace(/k?$/, (kilo) => ` ${kilo}${unit}`) : name;
  }
  const [low, high] = seen("x"), pixel = Math.abs(high - low) / 1000;
  const digits = axis.log ? 4 : within(Math.ceil(Math.log10(Math.abs(x || 1) / pixel)), 2, 9);
  return `${written(x, digits)} ${unit}`.trim();
}

function read(panel, at, spoken) {  // writes what stands at a place, and says it
  const { figure, told } = panel, found = readAt(panel, ...at), field = isField(panel);
  const up = field ? `, ${nameOf(told.y.label)} ${written(at[1], 3)}` : "";
  const place = `${nameOf(told.x.label).split(" (")[0]} ${xName(panel, at[0])}${up}`.trim();
  const values = found.map((each) => `${each.name} ${each.text}`);
  panel.at = at;
  tell(figure, found);
  for (const each of figures) follow(each, panel, at[0]);
  point(panel, at, found);
  panel.note.textContent = field ? [place, ...values].join(": ") : place;
  if (spoken) figure.status.textContent = `${place}: ${values.join(", ") || "nothing"}`;
}

function tell(figure, found) {  // in the legend
  for (const [key, output] of figure.outputs) output.textContent = found.find((each) => each.key === key)?.text ?? "";
}

function point(panel, at, found) {  // cursor and dots, once the scales have moved
  queueMicrotask(() => {
    const { plot, dots } = panel, place = (value, way) => plot.valToPos(value, way);
    const left = place(at[0], "x"), top = at[1] === null ? -10 : place(at[1], "y");
    const inside = left >= 0 && left <= plot.over.clientWidth;
    plot.setCursor(inside ? { left, top } : { left: -10, top: -10 }, false);
    const points = found.filter((each) => each.at && Number.isFinite(each.at[1]));
    while (dots.length < points.length) dots.push(make("div", { className: "dot" }, plot.over));
    dots.forEach((dot, n) => {
      dot.hidden = !points[n];
      if (points[n]) dot.style.transform = `translate(${place(points[n].at[0], "x")}px, ${place(points[n].at[1], "y")}px)`;
    });
  });
}

function follow(figure, source, x) {  // the cursor of another panel, or of none
  for (const panel of figure.panels) {
    if (panel === source || !panel.dots) continue;
    const together = source?.key === panel.key && (source.figure === figure || panel.key === "frequency");
    const found = together ? readAt(panel, x, null) : [];
    panel.note.textContent = "";
    panel.at = together ? [x, null] : null;
    point(panel, [together ? x : NaN, null], found);
    const first = figure.panels.find((each) => each.key === panel.key) === panel;
    if (together && first && source.figure !== figure) tell(figure, found);
  }
  if (!source) tell(figure, []);
}

function press(panel, event) {
  if (event.ctrlKey || event.metaKey || event.altKey || !panel.plot) return;
  const act = {
    ArrowLeft: () => (event.shiftKey ? shift(panel, -0.2) : step(panel, -1)),
    ArrowRight: () => (event.shiftKey ? shift(panel, 0.2) : step(panel, 1)),
    PageDown: () => step(panel, 40), PageUp: () => step(panel, -40),
    Home: () => step(panel, -Infinity), End: () => step(panel, Infinity),
    "+": () => zoom(panel, 0.5), "=": () => zoom(panel, 0.5), "-": () => zoom(panel, 2), 0: () => showAll(panel),
    ...(isField(panel) ? { ArrowUp: () => climb(panel, 1), ArrowDown: () => climb(panel, -1) } : {}),
  }[event.key];
  if (!act) return;
  event.preventDefault();
  panel.figure.active = panel;
  act();
}

function step(panel, count) {  // to another point, or by pixels where there are none
  const axis = panel.told.x, [low, high] = endsOf(panel, "x"), pixel = (high - low) / (panel.plot.over.clientWidth || 1);
  const now = panel.at?.[0] ?? unscaled(axis, (low + high) / 2), stops = stopsOf(panel);
  let x = within(unscaled(axis, scaled(axis, now) + 4 * count * pixel), ...ascending(panel.full.x));
  if (stops) {
    let here = Math.min(placeIn(stops, now), stops.length - 1);
    if (here > 0 && Math.abs(stops[here - 1] - now) < Math.abs(stops[here] - now)) here--;
    const inSight = placeIn(stops, unscaled(axis, high)) - placeIn(stops, unscaled(axis, low));
    const each = Math.max(1, Math.round((inSight * pixel) / (high - low)));
    x = stops[within(here + count * each, 0, stops.length - 1)];
  }
  const at = scaled(axis, x), half = (high - low) / 2;
  if (at < low || at > high) zoomTo(panel, [at - half, at + half].map((end) => unscaled(axis, end)));
  read(panel, [x, isField(panel) ? panel.at?.[1] ?? middleOf(panel) : null], true);
}

function climb(panel, count) {
  const [low, high] = ascending(panel.seen("y")), by = (4 * count * (high - low)) / (panel.plot.over.clientHeight || 1);
  const x = panel.at?.[0] ?? (panel.seen("x")[0] + panel.seen("x")[1]) / 2;
  read(panel, [x, within((panel.at?.[1] ?? middleOf(panel)) + by, low, high)], true);
}
