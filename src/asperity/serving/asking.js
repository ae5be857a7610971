// What all parts of the page use: elements, questions to the server, numbers for people.

export const find = (id) => document.getElementById(id);
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
export const dark = matchMedia("(prefers-color-scheme: dark)");

export function make(tag, properties = {}, ...inside) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...inside);
  return made;
}

class Refused extends Error {
  constructor(errors) { super(errors.join("\n")); this.errors = errors; }
}

export async function ask(address, question) {
  const options = question === undefined ? {} :
    { method: "POST", body: question instanceof Blob ? question : JSON.stringify(question) };
  let answer;
  try {
    answer = await fetch(address, options);
  } catch {
    throw new Refused(["The server does not answer. Has it ended? Start it again with 'asperity serve', and open the address it prints."]);
  }
  if (answer.ok) return answer.json();
  const text = await answer.text();
  try {
    throw new Refused(JSON.parse(text).errors);
  } catch (error) {
    throw error instanceof Refused ? error : new Refused([text || answer.statusText]);
  }
}

export function numbers(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

export const PREFIXES = { "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" };

export function engineering(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  const exponent = value === 0 ? 0 : Math.min(9, Math.max(-12, 3 * Math.floor(Math.log10(Math.abs(value)) / 3 + 1e-9)));
  const scaled = value / 10 ** exponent;
  const places = scaled === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(scaled)) + 1e-9));
  return `${scaled.toFixed(places)} ${PREFIXES[exponent]}${unit}`.replace("-", "−");
}

export const squareMicrometres = (area) => area > 1e-8 ? `${(area * 1e6).toPrecision(3)} mm²` : `${Number((area * 1e12).toPrecision(3))} µm²`;

export function span(seconds) {
  return seconds < 90 ? `${Math.round(seconds)} s` : seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}

// Figures and tables as the report has them: the server writes them as it does there, and the same script draws.
export function showBlocks(box, found) {
  box.innerHTML = found.blocks;
  window.asperityCharts.show(JSON.parse(found.charts), box);
}
