// Where an axis has ticks, and how they are written: { at, names, minor } of what lies from `low` to `high`.

function linearTicks(low, high, most) {
  const rough = (high - low) / Math.max(most, 1), steps = [-1, 0, 1].flatMap((n) => [1, 2, 5].map((each) => each * 10 ** (Math.floor(Math.log10(rough)) + n)));
  const count = (step) => Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;
  const step = steps.find((each, n) => each >= rough * (1 - 1e-9) || count(steps[n + 1]) < 3);  // three are enough to tell a scale
  const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), first = Math.ceil(low / step - 1e-9);
  const at = Array.from({ length: count(step) }, (_, n) => (first + n) * step);
  const plain = Math.max(Math.abs(low), Math.abs(high)) < 1e6 && places < 6;
  return { at, names: at.map((v) => (plain ? v.toFixed(places).replace(/^-(0(\.0*)?)$/, "$1").replace("-", "−") : written(v, 3))), minor: [] };
}

function logTicks(low, high, most) {
  const decades = Math.log10(high / low);
  if (decades < 0.7) return linearTicks(low, high, most);
  const first = Math.floor(Math.log10(low)), all = [], minor = [];
  const plain = low >= 1e-3 && high <= 1e5, every = Math.ceil(decades / Math.max(most, 1));
  const mantissas = 3 * decades <= most && (plain || decades < 2) ? [1, 2, 5] : [1];
  for (let power = first; power <= Math.log10(high); power++) {
    for (let digit = 1; digit < 10; digit++) {
      const at = Number(`${digit}e${power}`);
      if (at < low * (1 - 1e-9) || at > high * (1 + 1e-9)) continue;
      if (mantissas.includes(digit) && power % every === 0) all.push(at); else if (decades <= 5 && every === 1) minor.push(at);
    }
  }
  const names = all.map((at) => {
    const power = Math.floor(Math.log10(at) + 1e-9), digit = Math.round(at / 10 ** power);
    return plain && (mantissas.length > 1 || decades < 2.5) ? written(at) : (digit === 1 ? "" : `${digit}·`) + `10${raised(power)}`;
  });
  return { at: all, names, minor };
}

const inWords = (axis) => axis.ticks?.some(([, name]) => /\p{L}{2}/u.test(name));

// Of an axis that names its ticks itself, those in sight; where it names too few of them, others.
function ticksOf(axis, low, high, most) {
  const seen = (at) => at >= low - 1e-9 * Math.abs(low) && at <= high + 1e-9 * Math.abs(high);
  const named = (axis.ticks ?? []).filter(([at]) => seen(at));
  if (named.length > 2 || (named.length && (inWords(axis) || named.length === axis.ticks.length))) {
    return { at: named.map(([at]) => at), names: named.map(([, name]) => name), minor: (axis.minor ?? []).filter(seen), named: true };
  }
  return (axis.log ? logTicks : linearTicks)(low, high, most);
}

// Ticks of what a second scale shows, at the places of the first.
function secondTicks(second, log, low, high, most) {
  const { scale = 1, offset = 0, inverse = false, unit = "" } = second;
  const there = (q) => (inverse ? scale / q : scale * q + offset), back = (q) => (inverse ? scale / q : (q - offset) / scale);
  const ends = [there(low), there(high)].sort((a, b) => a - b);
  const { at } = (log ? logTicks : linearTicks)(...ends, most);
  const order = at.map((value) => ({ at: back(value), name: unit ? withPrefix(value, unit) : written(value) })).sort((a, b) => a.at - b.at);
  return { at: order.map((each) => each.at), names: order.map((each) => each.name), minor: [] };
}

// Names that do not collide: all, every second, … with the roundest among them; `sizes` and `places` along the axis.
function uncrowded(names, places, sizes, gap) {
  const round = names.findIndex((name) => /^(0|1|1k|1000)$/.test(name));
  for (let every = 1; every < names.length; every++) {
    const kept = names.map((_, n) => n).filter((n) => (n - Math.max(round, 0)) % every === 0);
    const free = kept.every((n, k) => k === 0 ||
      Math.abs(places[n] - places[kept[k - 1]]) >= (sizes[n] + sizes[kept[k - 1]]) / 2 + gap);
    if (free) return names.map((name, n) => (kept.includes(n) ? name : ""));
  }
  return names.map((name, n) => (n === Math.max(round, 0) ? name : ""));
}
