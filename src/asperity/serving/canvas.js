// Drawing on a canvas what moves: pictures of fields, axes, lines.

import { PREFIXES, colour, dark, make } from "./asking.js";

const INFERNO = [[27, 12, 65], [74, 12, 107], [120, 28, 109], [165, 44, 96], [207, 68, 70], [237, 105, 37], [251, 155, 6], [247, 209, 61], [252, 255, 164]];

export function heat(share) {
  const at = Math.min(Math.max(share, 0), 1) * (INFERNO.length - 1), low = Math.min(Math.floor(at), INFERNO.length - 2), rest = at - low;
  return INFERNO[low].map((part, i) => part + rest * (INFERNO[low + 1][i] - part));
}

export function prepared(canvas) {
  const ratio = devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  canvas.width = Math.max(1, Math.round(box.width * ratio));
  canvas.height = Math.max(1, Math.round(box.height * ratio));
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  pen.font = "12px system-ui, sans-serif";
  return [pen, box.width, box.height];
}

// Image of (nx, ny) numbers, x to the right and y upwards, a colour for each.
export function imageOf(shape, paint) {
  const [nx, ny] = shape, image = new ImageData(nx, ny);
  for (let i = 0; i < nx; i++) for (let j = 0; j < ny; j++) image.data.set(paint(i * ny + j), 4 * ((ny - 1 - j) * nx + i));
  const canvas = make("canvas", { width: nx, height: ny });
  canvas.getContext("2d").putImageData(image, 0, 0);
  return canvas;
}

export function greyOf(heights) {
  let square = 0;
  for (const height of heights) square += height * height;
  const scale = 26 / (Math.sqrt(square / heights.length) || 1), middle = dark.matches ? 70 : 190;
  return (at) => { const grey = middle + Math.min(Math.max(heights[at] * scale, -62), 62); return [grey, grey, grey, 255]; };
}

export function ticks(low, high, count = 5) {
  const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw * 0.999);
  const found = [];
  for (let at = Math.ceil(low / step - 1e-9) * step; at <= high + 1e-9 * step; at += step) found.push(Math.abs(at) < 1e-9 * step ? 0 : at);
  return found;
}

// Axes in a box: returns functions from values to pixels.
export function axes(pen, box, x, y, xWords, yWords) {
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

export function line(pen, points, stroke, width = 1.6) {
  pen.beginPath(); pen.strokeStyle = stroke; pen.lineWidth = width; pen.lineJoin = "round";
  points.forEach(([x, y], i) => i ? pen.lineTo(x, y) : pen.moveTo(x, y));
  pen.stroke();
}
