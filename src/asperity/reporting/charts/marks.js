// Drawing of marks. `view` says where things are: x() and y() give pixels of the canvas, `unit` is a pixel of the page.

const POINT = 1.25;  // pixels of the page
const FAR = 1e5;  // pixels: farther away nothing need be exact

const COLOUR_TABLES = {
  cividis: "00224e00285b002e6a0533711a386f273e6e32436d3b496c434e6c4b546c535a6d5a5f6e61656f686a716f70737676767d7c788482798c8878938e789b9476a39a74aba072b4a76fbcae6cc4b468cdbb63d5c25edec958e7d150f0d846f9e03afee838",
  inferno_r: "fcffa4f3f586f2e865f5d949f9c932fbba1ffcaa0ffb9b06f98c0af67e14f1711feb6429e35933da4e3cd04545c63d4dba3655ae305ca22b6295266788226a7c1d6d6f196e62146e550f6d490b6a3b09642d0b591f0c48140b340a0722030210000004",
};
const shadesMade = {};

function shadesOf(name) {  // 256 colours, red, green and blue
  if (!shadesMade[name]) {
    const text = COLOUR_TABLES[name], steps = text.length / 6 - 1;
    const part = (n, k) => parseInt(text.slice(6 * n + 2 * k, 6 * n + 2 * k + 2), 16);
    shadesMade[name] = Array.from({ length: 256 }, (_, i) => {
      const at = (i / 255) * steps, n = Math.min(Math.floor(at), steps - 1), share = at - n;
      return [0, 1, 2].map((k) => Math.round(part(n, k) * (1 - share) + part(n + 1, k) * share));
    });
  }
  return shadesMade[name];
}

const within = (at, low, high) => Math.min(Math.max(at, low), high);
const endless = (mark) => mark.kind === "boxes" && [mark.left, mark.right, mark.low, mark.high].some((edge) => edge.some((at) => !Number.isFinite(at)));

function viewOf(plot, unit, colour) {
  const { left, top, width, height } = plot.bbox;
  const along = ({ min, max, distr, dir }, from, to) => {
    const scaled = distr === 3 ? Math.log10 : (value) => value;
    const low = scaled(min), size = (to - from) / (scaled(max) - low);
    return dir < 0 ? (value) => to - (scaled(value) - low) * size : (value) => from + (scaled(value) - low) * size;
  };
  const { x, y } = plot.scales;
  return { ctx: plot.ctx, left, top, right: left + width, bottom: top + height, unit, colour,
    x: along(x, left, left + width), y: along(y, top + height, top), lowest: x.min, highest: x.max };
}

function drawMark(view, mark) {
  const { ctx } = view;
  ctx.save();
  ctx.globalAlpha = mark.opacity ?? (mark.kind === "area" ? 0.25 : 1);
  ctx.strokeStyle = ctx.fillStyle = view.colour(mark.colour ?? (mark.kind === "rules" || mark.kind === "note" ? "--c1" : "--c0"));
  ctx.lineJoin = "round";
  ({ line: drawLine, area: drawArea, boxes: drawBoxes, rules: drawRules, field: drawField, shape: drawShape })[mark.kind]?.(view, mark);
  ctx.restore();
}

function stroked(view, width, dashes = []) {
  view.ctx.lineWidth = Math.max(width * POINT, 0.6) * view.unit;
  view.ctx.setLineDash(dashes.map((length) => length * width * POINT * view.unit));
  view.ctx.stroke();
}

function reach(view, mark) {  // numbers of a mark that are in sight, and one on either side
  if (!mark.ordered) return [0, mark.x.length];
  return [Math.max(placeIn(mark.x, view.lowest) - 1, 0), Math.min(placeIn(mark.x, view.highest) + 2, mark.x.length)];
}

function drawLine(view, mark) {
  const { ctx, unit } = view, { x, y, width = 1.3, marker } = mark, [from, to] = reach(view, mark);
  const dense = mark.ordered && to - from > 4 * ((view.right - view.left) / unit);
  if (width > 0) {
    ctx.beginPath();
    if (dense) traceExtremes(view, x, y, from, to); else trace(view, x, y, from, to);
    stroked(view, width, dense ? [] : mark.dashes);
  }
  if (marker && to - from <= 600) for (let i = from; i < to; i++) drawMarker(view, marker, view.x(x[i]), view.y(y[i]));
}

function trace(view, x, y, from, to) {
  for (let i = from, pen = false; i < to; i++) {
    const across = view.x(x[i]), up = view.y(y[i]);
    if (!Number.isFinite(across) || !Number.isFinite(up)) { pen = false; continue; }
    const point = [within(across, -FAR, FAR), within(up, -FAR, FAR)];
    if (pen) view.ctx.lineTo(...point); else view.ctx.moveTo(...point);
    pen = true;
  }
}

function traceExtremes(view, x, y, from, to) {  // lowest and highest number in each column of pixels
  let column = null, low, high, pen = false;
  const end = () => {
    if (column === null || low > high) return;
    const first = within(view.y(low), -FAR, FAR), last = within(view.y(high), -FAR, FAR);
    if (pen) view.ctx.lineTo(column, first); else view.ctx.moveTo(column, first);
    view.ctx.lineTo(column, last);
    pen = true;
  };
  for (let i = from; i < to; i++) {
    const here = Math.round(view.x(x[i]));
    if (here !== column) { end(); column = here; low = Infinity; high = -Infinity; }
    if (y[i] < low) low = y[i];
    if (y[i] > high) high = y[i];
    if (Number.isNaN(y[i])) { end(); low = Infinity; high = -Infinity; pen = false; }
  }
  end();
}

const SIDES = { "^": [3, -90], v: [3, 90], "<": [3, 180], ">": [3, 0], s: [4, 45], D: [4, 0], d: [4, 0], p: [5, -90], h: [6, -90], 8: [8, 22.5], H: [6, 0] };

function drawMarker({ ctx, unit }, marker, x, y) {
  if (!Number.isFinite(x) || !Number.isFinite(y)) return;
  const size = 3.1 * unit;
  ctx.beginPath();
  if (SIDES[marker]) {
    const [sides, turn] = SIDES[marker], thin = marker === "d" ? 0.6 : 1;
    for (let n = 0; n < sides; n++) {
      const angle = (turn + (360 * n) / sides) * (Math.PI / 180);
      ctx.lineTo(x + thin * 1.2 * size * Math.cos(angle), y + 1.2 * size * Math.sin(angle));
    }
    ctx.fill();
  } else if ("xX+P*|_".includes(marker)) {
    const turned = { x: [45, 135], X: [45, 135], "+": [0, 90], P: [0, 90], "*": [90, 30, 150], "|": [90], _: [0] }[marker];
    for (const degrees of turned) {
      const across = size * Math.cos(degrees * Math.PI / 180), up = size * Math.sin(degrees * Math.PI / 180);
      ctx.moveTo(x - across, y - up);
      ctx.lineTo(x + across, y + up);
    }
    ctx.setLineDash([]);
    ctx.lineWidth = ("XP".includes(marker) ? 2.6 : 1.4) * unit;
    ctx.stroke();
  } else {
    ctx.arc(x, y, (marker === "." ? 0.55 : 1) * size, 0, 2 * Math.PI);
    ctx.fill();
  }
}

function drawArea(view, mark) {
  const { ctx } = view, [from, to] = reach(view, mark);
  const whole = (i) => Number.isFinite(mark.low[i]) && Number.isFinite(mark.high[i]) && Number.isFinite(view.x(mark.x[i]));
  for (let i = from; i < to; i++) {
    if (!whole(i)) continue;
    const start = i;
    while (i + 1 < to && whole(i + 1)) i++;
    ctx.beginPath();
    for (let n = start; n <= i; n++) ctx.lineTo(view.x(mark.x[n]), within(view.y(mark.high[n]), -FAR, FAR));
    for (let n = i; n >= start; n--) ctx.lineTo(view.x(mark.x[n]), within(view.y(mark.low[n]), -FAR, FAR));
    ctx.closePath();
    ctx.fill();
    if (mark.opacity === 1) stroked(view, 0.4);  // seen at all where it is flat
  }
}

function drawBoxes(view, mark) {
  const { ctx, unit } = view, hatch = mark.hatch && hatching(view, mark);
  for (let n = 0; n < mark.left.length; n++) {
    const [left, right] = [view.x(mark.left[n]), view.x(mark.right[n])].map((at) => within(at, view.left - unit, view.right + unit)).sort((a, b) => a - b);
    const [top, bottom] = [view.y(mark.low[n]), view.y(mark.high[n])].map((at) => within(at, view.top - unit, view.bottom + unit)).sort((a, b) => a - b);
    if (!(right >= view.left && left <= view.right && bottom >= top)) continue;
    const box = [left, top, Math.max(right - left, unit), Math.max(bottom - top, mark.low[n] === mark.high[n] ? 0 : unit)];
    ctx.fillRect(...box);
    if (hatch) {
      ctx.save();
      ctx.fillStyle = hatch;
      ctx.fillRect(...box);
      ctx.restore();
    }
    if (mark.edge) {
      ctx.strokeStyle = view.colour(mark.edge);
      ctx.lineWidth = unit;
      ctx.strokeRect(...box);
    }
  }
}

function hatching({ ctx, unit, colour }, mark) {  // in the colour of the paper over a full colour, else in its own
  const size = Math.round(8 * unit), tile = Object.assign(document.createElement("canvas"), { width: size, height: size });
  const pen = tile.getContext("2d");
  pen.strokeStyle = pen.fillStyle = (mark.opacity ?? 1) > 0.5 ? colour("--paper") : colour(mark.colour);
  pen.lineWidth = unit;
  const strokes = { "/": [[0, size, size, 0]], "\\": [[0, 0, size, size]], x: [[0, size, size, 0], [0, 0, size, size]], "-": [[0, size / 2, size, size / 2]] };
  for (const [a, b, c, d] of strokes[mark.hatch] ?? []) {
    for (const shift of a === c || b === d ? [0] : [-size, 0, size]) {  // so that corners meet
      pen.beginPath();
      pen.moveTo(a + shift, b);
      pen.lineTo(c + shift, d);
      pen.stroke();
    }
  }
  if (mark.hatch === ".") pen.fillRect(size / 2 - unit, size / 2 - unit, 2 * unit, 2 * unit);
  return ctx.createPattern(tile, "repeat");
}

function drawRules(view, mark) {
  const { ctx } = view, end = mark.short ? 0.04 : 1;
  ctx.beginPath();
  for (const at of mark.at) {
    if (mark.along === "y") {
      ctx.moveTo(view.left, view.y(at));
      ctx.lineTo(view.left + end * (view.right - view.left), view.y(at));
    } else {
      ctx.moveTo(view.x(at), view.bottom);
      ctx.lineTo(view.x(at), view.bottom - end * (view.bottom - view.top));
    }
  }
  stroked(view, mark.width ?? 0.9, mark.dashes ?? [1, 1.5]);
}

function drawField(view, mark) {
  mark.picture ??= pictureOf(mark);
  const { ctx } = view, [left, right] = mark.x.map(view.x), [bottom, top] = mark.y.map(view.y);
  ctx.imageSmoothingEnabled = false;
  ctx.translate(left, top);
  ctx.scale((right - left) / mark.picture.width, (bottom - top) / mark.picture.height);
  ctx.drawImage(mark.picture, 0, 0);
}

function pictureOf({ values: { numbers, shape: [across, up] }, low, high, colours = "cividis" }) {
  const picture = Object.assign(document.createElement("canvas"), { width: across, height: up });
  const pen = picture.getContext("2d"), image = pen.createImageData(across, up), shades = shadesOf(colours);
  for (let i = 0; i < across; i++) {
    for (let j = 0; j < up; j++) {
      const value = numbers[i * up + j], at = 4 * ((up - 1 - j) * across + i);
      if (!Number.isFinite(value)) continue;
      image.data.set(shades[within(Math.round((255 * (value - low)) / (high - low || 1)), 0, 255)], at);
      image.data[at + 3] = 255;
    }
  }
  pen.putImageData(image, 0, 0);
  return picture;
}

function drawShape(view, mark) {
  const { ctx } = view;
  ctx.beginPath();
  trace(view, mark.x, mark.y, 0, mark.x.length);
  ctx.closePath();
  if (mark.fill) {
    ctx.fillStyle = view.colour(mark.fill);
    ctx.fill();
  }
  if (mark.colour !== "") stroked(view, mark.width ?? 0.8, mark.dashes);
}

// Lowest and highest place of lines between two places along x; between points they are straight.
function reachOver(view, lines, left, right) {
  return lines.flatMap((mark) => {
    const [from, to] = reach(view, mark), found = [Infinity, -Infinity];
    for (let i = from; i + 1 < to; i++) {
      const [a, b] = [view.x(mark.x[i]), view.x(mark.x[i + 1])], [p, q] = [view.y(mark.y[i]), view.y(mark.y[i + 1])];
      if (!Number.isFinite(p + q) || Math.max(a, b) < left || Math.min(a, b) > right) continue;
      for (const at of [within(left, Math.min(a, b), Math.max(a, b)), within(right, Math.min(a, b), Math.max(a, b))]) {
        const y = a === b ? p : p + ((q - p) * (at - a)) / (b - a);
        found[0] = Math.min(found[0], y);
        found[1] = Math.max(found[1], y);
      }
    }
    return found[0] <= found[1] ? [found] : [];
  });
}

// Notes stand a little beside their places, inside the panel, clear of those written before them and, with room, of lines.
function drawNotes(view, notes, lines) {
  const { ctx, unit } = view, line = 14 * unit, taken = [];
  ctx.save();
  ctx.font = `${11.5 * unit}px system-ui, sans-serif`;
  ctx.textBaseline = "middle";
  ctx.textAlign = "center";
  ctx.lineJoin = "round";
  for (const note of notes) {
    const x = note.x_share ? view.left + note.x * (view.right - view.left) : view.x(note.x);
    const y = note.y_share ? view.bottom - note.y * (view.bottom - view.top) : view.y(note.y);
    if (!(x >= view.left - 1 && x <= view.right + 1 && y >= view.top - 1 && y <= view.bottom + 1)) continue;
    const rows = broken(ctx, note.text.trim(), (note.upright ? view.bottom - view.top : view.right - view.left) - 2 * line);
    const length = Math.max(...rows.map((row) => ctx.measureText(row).width)), thick = rows.length * line;
    const [width, height] = note.upright ? [thick, length] : [length, thick];
    const beside = { left: 5 * unit, right: -5 * unit - width, center: -width / 2 }[note.align ?? "left"];
    const above = note.y_share ? (note.y > 0.5 ? 3 * unit : -height - 3 * unit) : -height / 2;
    let left = x + beside;
    if (left + width > view.right && x - 5 * unit - width > view.left) left = x - 5 * unit - width;  // there is more room
    left = within(left, view.left + 2 * unit, Math.max(view.right - width - 2 * unit, view.left + 2 * unit));
    const usual = within(y + above, view.top + 2 * unit, Math.max(view.bottom - height - 2 * unit, view.top + 2 * unit));
    const meets = (top) => taken.some((box) => left < box.right && left + width > box.left && top < box.bottom && top + height > box.top);
    const most = Math.ceil((view.bottom - view.top) / line);  // rows of words that the panel holds
    const tries = Array.from({ length: 2 * most + 1 }, (_, n) => usual + (n % 2 ? 1 : -1) * Math.ceil(n / 2) * line);
    const free = tries.filter((each) => each >= view.top && each + height <= view.bottom && !meets(each));
    const crossed = note.y_share ? reachOver(view, lines, left, left + width) : [];
    const top = free.find((each) => crossed.every(([high, low]) => low < each || high > each + height)) ?? free[0];
    if (top === undefined) continue;  // no room: what it says stands in the caption, too
    taken.push({ left, right: left + width, top, bottom: top + height });
    ctx.save();
    ctx.translate(left + width / 2, top + height / 2);
    if (note.upright) ctx.rotate(-Math.PI / 2);
    ctx.strokeStyle = view.colour("--paper");
    ctx.lineWidth = 3 * unit;
    ctx.fillStyle = view.colour(note.colour ?? "--c1");
    rows.forEach((row, n) => {
      const down = (n - (rows.length - 1) / 2) * line;
      ctx.strokeText(row, 0, down);
      ctx.fillText(row, 0, down);
    });
    ctx.restore();
  }
  ctx.restore();
}

function broken(ctx, text, room) {  // into rows that have room
  return text.split("\n").flatMap((part) => part.split(" ").reduce((rows, word) => {
    const longer = rows.length ? `${rows.at(-1)} ${word}` : word;
    return !rows.length || ctx.measureText(longer).width > room ? [...rows, word] : [...rows.slice(0, -1), longer];
  }, []));
}
