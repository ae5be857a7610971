// One panel: how far its axes reach, its plot, and what is read at a place of it.

const FONT = "system-ui, sans-serif";
const PRINTED = 2.5;  // pixels of a picture on paper to a pixel of the page
const ruler = document.createElement("canvas").getContext("2d");

function lengthOf(text, size = 12) {
  ruler.font = `${size}px ${FONT}`;
  return ruler.measureText(text).width;
}

const make = (tag, properties, parent) => {
  const made = Object.assign(document.createElement(tag), properties);
  parent?.append(made);
  return made;
};

function whole(mark, get) {  // a mark with its numbers
  if (mark.kind === "note") return mark;
  if (mark.kind === "field") return { ...mark, values: { ...mark.values, numbers: get(mark.values.array) } };
  const found = { ...mark };
  for (const key of ["x", "y", "low", "high", "left", "right", "at"]) if (typeof mark[key] === "number") found[key] = get(mark[key]);
  found.ordered = found.x && increases(found.x);
  return found;
}

// Lowest and highest number along an axis: as it says, else of what is shown, and there from `from` to `to` along x.
function limits(panel, way, shown, from = -Infinity, to = Infinity) {
  const axis = panel.told[way];
  let { low = null, high = null } = axis;
  if (low !== null && high !== null) return [low, high];
  let least = Infinity, most = -Infinity;
  const look = (value) => {
    if (!Number.isFinite(value) || (axis.log && value <= 0)) return;
    if (value < least) least = value;
    if (value > most) most = value;
  };
  for (const mark of panel.marks.filter(shown)) {
    if (mark.kind === "field") mark[way].forEach(look);
    else if (mark.kind === "boxes") {
      mark.left.forEach((left, n) => {
        if (mark.right[n] >= from && left <= to) (way === "x" ? [left, mark.right[n]] : [mark.low[n], mark.high[n]]).forEach(look);
      });
    } else if (mark.kind === "line" || mark.kind === "area" || mark.kind === "shape") {
      const [first, end] = mark.ordered ? [placeIn(mark.x, from), Math.max(placeIn(mark.x, to), 1)] : [0, mark.x.length];
      for (const numbers of way === "x" ? [mark.x] : mark.kind === "area" ? [mark.low, mark.high] : [mark.y]) {
        for (let i = first; i < Math.min(end + 1, numbers.length); i++) look(numbers[i]);
      }
    }
  }
  if (least > most) [least, most] = [1, 10];
  if (way === "y" || least === most) {
    const room = axis.log ? (most > least ? (most / least) ** 0.04 : 1.2) : 0.04 * (most - least) || 0.5 * Math.abs(most) || 1;
    [least, most] = axis.log ? [least / room, most * room] : [least - room, most + room];
  }
  return [low ?? least, high ?? most];
}

const ascending = (ends) => (ends[0] <= ends[1] ? ends : [ends[1], ends[0]]);
const scaled = (axis, value) => (axis.log ? Math.log10(value) : value);
const unscaled = (axis, value) => (axis.log ? 10 ** value : value);

// Ticks of an axis of a panel for its length in pixels of the page, their names thinned or broken to have room.
function layout(panel, way, [low, high], length, second = false) {
  const axis = panel.told[way], across = way === "x";
  const most = length / (across ? (axis.log ? 48 : 70) : 38);
  const found = second ? secondTicks(axis.second, axis.log, low, high, most) : ticksOf(axis, low, high, most);
  const share = (at) => (scaled(axis, at) - scaled(axis, low)) / (scaled(axis, high) - scaled(axis, low));
  const places = found.at.map((at) => length * share(at));
  let { names } = found, turned = false;
  if (across && found.named && inWords(axis)) {
    const room = length / Math.max(names.length, 1) - 8;
    const rows = names.map((name) => broken(ruler, name, room));
    turned = rows.some((parts) => parts.length > 3 || parts.some((part) => lengthOf(part) > room));
    if (!turned) names = rows.map((parts) => parts.join("\n"));
  } else {
    names = uncrowded(names, places, names.map((name) => (across ? lengthOf(name) : 14)), across ? 9 : 3);
  }
  return { at: found.at, names, minor: found.minor, turned };
}

const longest = (names) => Math.max(0, ...names.flatMap((name) => name.split("\n")).map((row) => lengthOf(row)));

function plotAxis(panel, way, side, measures, colour, k, second = false) {
  const length = way === "x" ? measures.width : measures.height, field = panel.marks.some((mark) => mark.kind === "field");
  let found, of = "";
  const laid = (low, high) => {
    if (of !== `${low} ${high}`) { of = `${low} ${high}`; found = layout(panel, way, [low, high], length, second); }
    return found;
  };
  const { turned, names } = laid(...ascending(panel.seen(way)));
  const rows = Math.max(1, ...names.map((name) => name.split("\n").length));
  const kept = (plot, splits) => splits, { plain } = panel.told;
  return {
    scale: way, side, show: !plain || Boolean(panel.told[way].label), font: `${Math.round(12 * k)}px ${FONT}`, stroke: colour("--c0"), gap: 4 * k, rotate: turned ? -90 : 0,
    lineGap: 1.15,
    size: (plot, values) => k * (way === "x"
      ? (turned ? longest(values ?? names) + 12 : 10 + 14 * rows)
      : Math.max(side === 3 ? panel.left : 0, longest(values ?? names) + 13)),
    splits: (plot, n, low, high) => [...laid(low, high).at, ...laid(low, high).minor].sort((a, b) => a - b),
    values: (plot, splits) => splits.map((at) => found.names[found.at.indexOf(at)] ?? ""),
    filter: kept, space: 1,
    grid: { show: !second && !field && !plain, stroke: colour("--c2"), width: k, filter: kept },
    ticks: { stroke: colour("--c1"), width: k, size: 4 * k, filter: kept },
  };
}

// Pixels of the page around a panel, and what remains for its marks.
function measured(panel, width, height) {
  const { told } = panel, sides = (way, length, second) => layout(panel, way, ascending(panel.seen(way)), length, second);
  const below = sides("x", width - 60), rows = Math.max(1, ...below.names.map((name) => name.split("\n").length));
  const bottom = below.turned ? longest(below.names) + 12 : 10 + 14 * rows;
  const top = told.x.second ? 26 : 9;
  const left = Math.max(panel.left, longest(sides("y", height - bottom - top).names) + 13);
  const bar = panel.marks.find((mark) => mark.kind === "field");
  const right = bar ? 36 + longest(scaleTicks(bar, height).names)
    : told.y.second ? longest(sides("y", height, true).names) + 13 : told.x.second ? 26 : 16;
  let inner = { width: width - left - right, height: height - top - bottom };
  if (told.equal) {
    const [x, y] = ["x", "y"].map((way) => Math.abs(panel.full[way][1] - panel.full[way][0]));
    const size = Math.min(inner.width / x, (1.25 * inner.height) / y);
    inner = { width: size * x, height: size * y };
  }
  return { left, right, top, bottom, ...inner };
}

function plotOf(panel, outer, height, colour, k) {
  const { told } = panel, size = measured(panel, outer, height), padding = size.right * k;
  const scale = (way) => ({
    time: false, auto: false, distr: told[way].log ? 3 : 1, dir: panel.full[way][0] > panel.full[way][1] ? -1 : 1,
    range: () => ascending(panel.seen(way)),
  });
  const axes = [plotAxis(panel, "x", 2, size, colour, k), plotAxis(panel, "y", 3, size, colour, k)];
  if (told.x.second) axes.push(plotAxis(panel, "x", 0, size, colour, k, true));
  if (told.y.second) axes.push(plotAxis(panel, "y", 1, size, colour, k, true));
  const drawn = (front) => (plot) => {
    const light = panel.marks.some((mark) => mark.colours === "inferno_r");  // its ground is light on a dark page, too
    const view = viewOf(plot, uPlot.pxRatio * k, light ? panel.figure.onPaper : colour), { ctx } = view;
    ctx.save();
    ctx.beginPath();
    ctx.rect(view.left, view.top, view.right - view.left, view.bottom - view.top);
    ctx.clip();
    const shown = panel.marks.filter(panel.figure.shows);
    for (const mark of shown) if (mark.kind !== "note" && endless(mark) !== front) drawMark(view, mark);
    if (front) drawNotes(view, shown.filter((mark) => mark.kind === "note"), shown.filter((mark) => mark.kind === "line" && mark.width !== 0));
    ctx.restore();
    if (front) for (const mark of shown) if (mark.kind === "field") drawScale({ ...view, colour }, mark);
    const { style } = ctx.canvas.parentElement;  // on paper drawn larger, and seen in its size: sharp
    for (const side of ["width", "height"]) style[side] = `${plot[side] / k}px`;
  };
  return new uPlot({
    width: Math.round((size.width + size.left + size.right) * k), height: Math.round((size.height + size.top + size.bottom) * k),
    padding: [told.x.second ? 4 * k : size.top * k, told.y.second ? 4 * k : padding, 0, told.plain && !told.y.label ? size.left * k : 0],
    legend: { show: false },
    cursor: { drag: { x: true, y: true, uni: 40, dist: 4, setScale: false }, points: { show: false }, focus: { prox: -1 },
      bind: { dblclick: () => () => showAll(panel) } },
    scales: { x: scale("x"), y: scale("y") }, axes, series: [{}, { show: false }],
    hooks: { drawClear: [drawn(false)], draw: [drawn(true)], setSelect: [() => select(panel)] },
  }, [ascending(panel.seen("x")), [null, null]], panel.host);
}

function scaleTicks({ low, high }, height) {
  const { at, names } = linearTicks(low, high, height / 40), places = at.map((value) => (height * (value - low)) / (high - low || 1));
  return { at, names: uncrowded(names, places, names.map(() => 14), 1) };
}

function drawScale(view, mark) {  // of the colours of a field, beside it
  const { ctx, unit } = view, left = view.right + 10 * unit, width = 12 * unit, height = view.bottom - view.top;
  const shades = shadesOf(mark.colours ?? "cividis"), numbers = mark.values.numbers;
  ctx.save();
  shades.forEach((shade, n) => {
    ctx.fillStyle = `rgb(${shade})`;
    ctx.fillRect(left, view.bottom - ((n + 1) / 256) * height, width, height / 256 + 1);
  });
  const beyond = (at, tip, shade) => {  // a point where numbers go farther than the colours
    ctx.fillStyle = `rgb(${shade})`;
    ctx.beginPath();
    for (const [x, y] of [[left, at], [left + width, at], [left + width / 2, at + tip]]) ctx.lineTo(x, y);
    ctx.fill();
  };
  if (numbers.some((number) => number > mark.high)) beyond(view.top, -7 * unit, shades[255]);
  if (numbers.some((number) => number < mark.low)) beyond(view.bottom, 7 * unit, shades[0]);
  const { at, names } = scaleTicks(mark, height / unit);
  ctx.font = `${Math.round(12 * unit)}px ${FONT}`;
  ctx.textBaseline = "middle";
  ctx.textAlign = "left";
  ctx.fillStyle = ctx.strokeStyle = view.colour("--c0");
  ctx.lineWidth = unit;
  at.forEach((value, n) => {
    const y = view.bottom - ((value - mark.low) / (mark.high - mark.low || 1)) * height;
    ctx.fillRect(left + width, y - unit / 2, 4 * unit, unit);
    ctx.fillText(names[n], left + width + 7 * unit, y);
  });
  ctx.restore();
}

// What the marks of a panel say at a place: { key, text, at: the number, of what }.
function readAt(panel, x, y) {
  const found = [], add = (mark, text, at) => found.push({ key: keyOf(mark), name: mark.label, text, at });
  const unit = unitOf(panel.told.y.label), say = (number) => written(number) + (unit ? ` ${unit}` : "");
  for (const mark of panel.marks.filter(panel.figure.shows)) {
    if (mark.kind === "field") {
      const cell = cellAt(mark, x, y);
      if (cell >= 0) found.push({ name: nameOf(mark.label), text: `${written(mark.values.numbers[cell], 3)} ${unitOf(mark.label)}`.trim() });
    }
    if (!mark.label) continue;
    if (mark.kind === "line") {
      const i = nearest(mark, x, panel);
      if (i >= 0) add(mark, say(mark.y[i]), [mark.x[i], mark.y[i]]);
    } else if (mark.kind === "area") {
      const i = nearest(mark, x, panel);
      if (i >= 0) add(mark, `${written(mark.low[i])} … ${say(mark.high[i])}`);
    } else if (mark.kind === "boxes") {
      const along = Boolean(inWords(panel.told.y));  // bars that lie
      const [first, last, low, high] = along ? [mark.low, mark.high, mark.left, mark.right] : [mark.left, mark.right, mark.low, mark.high];
      const at = along ? y : x, n = first.findIndex((edge, i) => Math.min(edge, last[i]) <= at && at <= Math.max(edge, last[i]));
      if (n < 0 || at === null) continue;
      if (!Number.isFinite(low[n]) || !Number.isFinite(high[n]) || inWords(panel.told.y) && !along) add(mark, "here");
      else add(mark, along ? `${written(high[n] === 0 ? low[n] : high[n])} ${unitOf(panel.told.x.label)}` : say(high[n] === 0 ? low[n] : high[n]));
    }
  }
  return found;
}

const keyOf = (mark) => `${mark.law ?? ""}|${mark.label ?? ""}`;

function nearest(mark, x, panel) {  // point of a line; -1 where it does not reach
  const { x: numbers, ordered } = mark, count = numbers.length, [low, high] = ascending(panel.seen("x")), { x: axis } = panel.told;
  const off = (i) => Math.abs(scaled(axis, numbers[i]) - scaled(axis, x));
  let best = 0;
  if (ordered) {
    best = Math.min(placeIn(numbers, x), count - 1);
    if (best > 0 && off(best - 1) < off(best)) best--;
  } else {
    for (let i = 1; i < count; i++) if (!(off(best) <= off(i))) best = i;
  }
  const near = 0.03 * (scaled(axis, high) - scaled(axis, low));
  const inside = ordered && x >= numbers[0] && x <= numbers[count - 1];
  return count && (inside || off(best) <= near) ? best : -1;
}

function cellAt({ x: [left, right], y: [low, high], values: { shape: [across, up] } }, x, y) {
  const i = Math.floor((across * (x - left)) / (right - left)), j = Math.floor((up * (y - low)) / (high - low));
  return i >= 0 && i < across && j >= 0 && j < up ? i * up + j : -1;
}

// Where a key moves the cursor: points of a line, middles of bars, cells of a field; null where nothing tells.
function stopsOf(panel) {
  const shown = panel.marks.filter(panel.figure.shows);
  const lines = shown.filter((mark) => mark.kind === "line" && mark.ordered && mark.x.length > 1);
  const line = lines.filter((mark) => mark.label).sort((a, b) => (b.width ?? 1.3) - (a.width ?? 1.3))[0] ?? lines[0];
  if (line) return line.x;
  const boxes = shown.filter((mark) => mark.kind === "boxes" && !endless(mark));
  const middles = new Set(boxes.flatMap((mark) => mark.left.length ? Array.from(mark.left, (left, n) => (left + mark.right[n]) / 2) : []));
  return middles.size ? Float64Array.from(middles).sort() : null;
}
