// Numbers of a page: unpacked once, and written for people.

async function unpacked(found) {
  const bytes = Uint8Array.from(atob(found.data), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const plain = new Uint8Array(await new Response(stream).arrayBuffer());
  let end = 0;
  const starts = found.arrays.map((array) => {
    const start = end;
    end += array.count * ("start" in array ? 0 : "low" in array ? 2 : 4);
    return start;
  });
  const made = [];
  return (n) => (made[n] ??= inFull(found.arrays[n], plain.subarray(starts[n])));
}

function inFull(array, bytes) {
  const { count } = array;
  if ("start" in array) return Float64Array.from({ length: count }, (_, i) => array.start + array.step * i);
  if (!("low" in array)) {  // single precision, byte after byte
    const single = new Uint8Array(4 * count);
    for (let i = 0; i < 4 * count; i++) single[i] = bytes[(i & 3) * count + (i >> 2)];
    return new Float32Array(single.buffer);
  }
  const numbers = new Float64Array(count);
  for (let i = 0, change = 0, level = 0; i < count; i++) {  // second differences of levels; 0 is missing
    change = (change + bytes[i] + (bytes[count + i] << 8)) & 0xffff;
    level = (level + change) & 0xffff;
    numbers[i] = level ? array.low + array.size * (level - 1) : NaN;
  }
  return numbers;
}

const raised = (power) => String(power).replace(/[-\d]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);

function written(number, digits = 4) {
  if (!Number.isFinite(number)) return "–";
  const size = Math.abs(number);
  if (size === 0 || (size >= 1e-4 && size < 1e6)) {
    return String(Number(number.toPrecision(Math.max(digits, Math.floor(Math.log10(size || 1)) + 1)))).replace("-", "−");
  }
  const [digit, power] = number.toExponential(digits - 1).split("e");
  return `${String(Number(digit)).replace("-", "−")}·10${raised(Number(power))}`;
}

const PREFIXES = { "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G" };

function withPrefix(number, unit) {
  if (!unit || !number) return written(number) + (unit ? ` ${unit}` : "");
  const power = Math.min(Math.max(3 * Math.floor(Math.log10(Math.abs(number)) / 3 + 1e-9), -12), 9);
  return `${written(number / 10 ** power)} ${PREFIXES[power]}${unit}`;
}

// "contact force / N" is a force in N, "level / dB re 1 N" one in dB
const nameOf = (label) => label.split(" / ")[0];
const unitOf = (label) => (label.split(" / ")[1] ?? "").split(" re ")[0].replace(/ \(.*/, "").replace(/^\((.*)\)$/, "$1");

// First place of increasing numbers from which on they are at least so large.
function placeIn(numbers, least) {
  let low = 0, high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] < least) low = middle + 1; else high = middle;
  }
  return low;
}

function increases(numbers) {
  for (let i = 1; i < numbers.length; i++) if (!(numbers[i] >= numbers[i - 1])) return false;
  return true;
}
