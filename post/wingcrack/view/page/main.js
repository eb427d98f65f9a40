// The page: what is chosen, what is fetched for it, and a run that goes on.
import { getArrays, getJson, spell, spellWithUnit, ticksBetween } from "./data.js";
import { FieldMap, eventColour } from "./map.js";
import { Chart } from "./chart.js";

const SOON = 2000, LATER = 10000; // [ms] between looks at a run that goes on, that has ended
const FRAME = 125; // [ms] a state is shown while playing
const MESHES = 3; // kept

const part = (id) => document.getElementById(id);
const map = new FieldMap(part("map"), (words) => (part("here").textContent = words || "\u00a0"), showScale);
const chart = new Chart(part("chart"), (place) => choose(nearestTo(place)));
const meshes = new Map();
let run = null;
let scale = null; // of a field:
let scaleFor = "";
let playing = false;
let asked = 0; // number of the newest wish: answers to older ones come too late

// What the run is

async function look() {
  try {
    const found = await getJson("overview");
    const news = JSON.stringify(found) !== JSON.stringify(run);
    const followed = run === null || Number(part("slider").value) === run.moments.length - 1;
    if (news) await take(found, followed);
    if (part("note").dataset.of === "run") say("");
  } catch (reason) {
    say(reason.message, "run");
  }
  setTimeout(look, run?.status === "running" ? SOON : LATER);
}

async function take(found, followed) {
  const first = run === null;
  run = found;
  document.title = run.name;
  part("title").textContent = run.title ? `${run.name}: ${run.title}` : run.name;
  part("status").className = run.status;
  const count = run.warnings === 1 ? "1 warning" : `${run.warnings} warnings`;
  part("status").textContent = [
    run.status === "running" ? "running: new states appear by themselves" : run.status,
    run.reason && run.reason !== run.status ? run.reason : "",
    run.warnings ? `${count} in run.json` : "",
  ].filter(Boolean).join("; ");
  fill(part("field"), run.fields, run.field);
  fill(part("column"), run.columns, run.column);
  const kinds = [...new Set(run.events.map(([kind]) => kind))];
  fill(part("events"), ["all", ...kinds, "none"].map((kind) => [kind, kind]), "all");
  part("events").parentElement.hidden = !kinds.length;
  const slider = part("slider");
  slider.max = run.moments.length - 1;
  if (followed && !playing) slider.value = slider.max;
  part("legend").replaceChildren(...legend());
  scaleFor = "";
  await Promise.all([showState(), showHistory()]);
  if (first) map.seeBody();
}

function fill(list, entries, chosen) {
  const kept = entries.some(([name]) => name === list.value) ? list.value : chosen;
  list.replaceChildren(...entries.map(([name, words]) => new Option(words, name)));
  list.value = kept;
}

function legend() {
  const by = part("by").value, high = scale?.jumps[by];
  const shown = high === undefined ? run.states : [[`${by} up to ${spellWithUnit(high, "m")}`, ""]];
  const entries = shown.map(([words, colour]) => {
    const line = document.createElement("i");
    line.style.background = colour || gradient(scale.jump_colours);
    return [line, words];
  });
  if (run.wells.length) {
    const sign = document.createElement("i");
    sign.className = "well";
    entries.push([sign, "well"]);
  }
  for (const kind of new Set(events().map(([kind]) => kind))) {
    const sign = document.createElement("i");
    sign.className = "event";
    sign.style.borderColor = eventColour(kind);
    entries.push([sign, kind]);
  }
  return entries.map(([sign, words]) => {
    const entry = document.createElement("span");
    entry.append(sign, words);
    return entry;
  });
}

// A state

function events() { // those of the kinds wanted that have happened by the state shown
  const wanted = part("events").value, until = run.moments[Number(part("slider").value)];
  return run.events.filter(([kind, , , time]) => time <= until * (1 + 1e-12) && [kind, "all"].includes(wanted));
}

async function showState() {
  const mine = ++asked;
  const place = Number(part("slider").value);
  const field = part("field").value;
  part("moment").textContent = spellMoment(place);
  chart.mark(abscissa(place));
  try {
    const stamp = run.stamps[place];
    const state = await getArrays("state", { place, field, stamp });
    const mesh = await meshOf(state.mesh, place, stamp);
    if (scaleFor !== field) {
      const found = await getJson("scale", { field });
      if (mine !== asked) return;
      [scale, scaleFor] = [found, field];
    }
    if (mine !== asked) return;
    for (const option of part("by").options) {
      option.hidden = option.value !== "state" && !(option.value in scale.jumps);
    }
    const by = part("by").value;
    map.show({ mesh, state, scale, run, by, events: events(), close: part("range").value === "view" });
    part("legend").replaceChildren(...legend());
    document.body.dataset.place = place; // what the map shows by now
    document.body.dataset.field = field;
    if (part("note").dataset.of === "state") say("");
  } catch (reason) {
    if (mine === asked) say(reason.message, "state");
  }
}

async function meshOf(name, place, stamp) {
  if (!meshes.has(name)) {
    if (meshes.size >= MESHES) meshes.delete(meshes.keys().next().value);
    meshes.set(name, await getArrays("mesh", { place, stamp }));
  }
  return meshes.get(name);
}

function gradient(list) {
  const stops = [];
  for (let k = 0; k < list.length; k += 3 * 15) stops.push(`rgb(${list.slice(k, k + 3)})`);
  return `linear-gradient(to right, ${stops})`;
}

function showScale(scale) {
  part("colours").style.background = gradient(scale.colours);
  part("label").textContent = scale.label;
  const room = part("ticks").clientWidth / 90;
  part("ticks").replaceChildren(...ticksBetween(scale.low, scale.high, Math.max(2, room)).map((value) => {
    const tick = document.createElement("span");
    tick.textContent = spell(value);
    tick.style.left = `${(100 * (value - scale.low)) / (scale.high - scale.low)}%`;
    return tick;
  }));
}

function choose(place) {
  part("slider").value = place;
  return showState();
}

function spellMoment(place) {
  const { name, unit, size } = run.moment;
  const value = `${name} ${spell(run.moments[place] / size)}${unit === "-" ? "" : ` ${unit}`}`;
  return `${value}, ${place + 1} of ${run.moments.length}`;
}

// History

async function showHistory() {
  try {
    const found = await getArrays("history", { column: part("column").value });
    const { name, unit, size } = run.moment;
    const steps = name !== "time"; // a load may rise and fall
    chart.show({
      places: steps ? found.moments.map((_, k) => k + 1) : found.moments.map((value) => value / size),
      values: found.values,
      label: found.label,
      below: steps ? "step [-]" : `${name} [${unit}]`,
    });
    chart.mark(abscissa(Number(part("slider").value)));
  } catch (reason) {
    say(reason.message, "state");
  }
}

function abscissa(place) {
  if (run.moment.name === "time") return run.moments[place] / run.moment.size;
  return run.rows[place] === null ? place + 1 : run.rows[place] + 1;
}

function nearestTo(value) {
  let found = 0;
  for (let k = 0; k < run.moments.length; k++) {
    if (Math.abs(abscissa(k) - value) < Math.abs(abscissa(found) - value)) found = k;
  }
  return found;
}

// Hands

async function play() {
  playing = !playing;
  part("play").textContent = playing ? "❚❚" : "▶";
  part("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  const slider = part("slider");
  if (playing && Number(slider.value) >= Number(slider.max)) slider.value = -1;
  while (playing) {
    const pause = new Promise((go) => setTimeout(go, FRAME));
    if (Number(slider.value) >= Number(slider.max)) break;
    await Promise.all([choose(Number(slider.value) + 1), pause]);
  }
  if (playing) await play();
}

function say(words, of = "") {
  part("note").textContent = words;
  part("note").hidden = !words;
  part("note").dataset.of = of;
}

part("slider").addEventListener("input", showState);
part("field").addEventListener("change", showState);
part("range").addEventListener("change", showState);
part("by").addEventListener("change", showState);
part("events").addEventListener("change", showState);
part("column").addEventListener("change", showHistory);
part("play").addEventListener("click", play);
part("closer").addEventListener("click", () => map.zoom(1.5));
part("farther").addEventListener("click", () => map.zoom(1 / 1.5));
part("whole").addEventListener("click", () => map.seeBody());
part("near").addEventListener("click", () => map.seeFractures());
look();
