// What the server gives: JSON, and messages of packing.py as typed arrays.

async function ask(path, query) {
  const address = `${path}?${new URLSearchParams(query)}`;
  let answer;
  try {
    answer = await fetch(address);
  } catch {
    throw new Error("wingcrack view does not answer: it may have been ended.");
  }
  if (!answer.ok) {
    const said = await answer.json().catch(() => ({ why: answer.statusText }));
    throw new Error(said.why);
  }
  return answer;
}

export async function getJson(path, query = {}) {
  return (await ask(path, query)).json();
}

export async function getArrays(path, query = {}) {
  const message = await (await ask(path, query)).arrayBuffer();
  const length = new DataView(message).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(message, 4, length)));
  const kinds = { Float32Array, Float64Array, Uint32Array, Uint8Array };
  for (const [name, [kind, offset, size]] of Object.entries(head.arrays)) {
    head[name] = new kinds[kind](message, 4 + length + offset, size);
  }
  return head;
}

// A number as people write it: four digits, powers of ten where it is far from one.
export function spell(value) {
  if (!Number.isFinite(value)) return "none";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(2);
  return String(Number(value.toPrecision(4)));
}

// Round values between two others, about as many as wanted.
export function ticksBetween(low, high, wanted) {
  const rough = (high - low) / wanted;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) ticks.push(k * step);
  return ticks;
}

// Lengths and pressures of fractures in a unit that reads well.
export function spellWithUnit(value, unit) {
  if (unit === "Pa") return `${spell(value / 1e6)} MPa`;
  const size = Math.abs(value);
  const [name, factor] = size >= 1 ? ["m", 1] : size >= 1e-3 ? ["mm", 1e3] : ["µm", 1e6];
  return `${spell(value * factor)} ${name}`;
}
