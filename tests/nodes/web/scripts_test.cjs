// Parts of the live page that need no browser: node tests/nodes/web/scripts_test.cjs
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const test = require("node:test");
const vm = require("node:vm");

const load = (name) => {
  const file = path.join(__dirname, "../../../web", name);
  vm.runInThisContext(fs.readFileSync(file, "utf8"), { filename: file });
};
globalThis.location = { search: "", protocol: "http:", host: "localhost:8080" };
for (const name of ["shared.js", "model.js", "connection.js"]) load(name);
const { Model, Columns, Connection, LinePath, View, verdicts, ellipseOf, compareKnown, setStatusTable, words, hasHeading } = sonopose;

const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test("columns keep the newest rows, and find those of a time", () => {
  const columns = new Columns(["t", "x"], 3);
  assert.equal(columns.last(), null);
  for (let i = 0; i < 5; i += 1) columns.push([i, 10 * i]);
  assert.equal(columns.size, 3);
  assert.equal(columns.pushed, 5);
  assert.deepEqual(columns.row(0), { t: 2, x: 20 });
  assert.deepEqual(columns.last(), { t: 4, x: 40 });
  assert.deepEqual(columns.last(3.5), { t: 3, x: 30 });
  assert.equal(columns.last(1), null);
  columns.push([5, null]);
  assert.ok(Number.isNaN(columns.last().x));
});

test("latency segments are read by name", () => {
  const model = new Model();
  // The order of the JSON, whose keys are sorted.
  const latency_segments = {};
  ["bridge_to_fusion", "fusion_to_here", "in_fusion", "sensor_to_bridge"].forEach((name, i) => {
    latency_segments[name] = { p50_s: i };
  });
  model.onStatus({ time_ns: 5e9, beacons: [{ address: 7, latency_segments, bridge: { battery_v: 3.9 } }] });
  const row = model.beacon(7).status.last();
  assert.equal(row.t, 5);
  assert.equal(row.battery, 3.9);
  assert.equal(row.bridge_to_fusion, 0);
  assert.equal(row.fusion_to_here, 1);
  assert.equal(row.in_fusion, 2);
  assert.equal(row.sensor_to_bridge, 3);
});

test("what a new connection repeats is shown once", () => {
  const model = new Model();
  const frame = (t) => ({ beacons: [{ a: 7, pose: [t, 1, 2, 3], truth: [t, 1, 2, 3, 0] }] });
  model.onFrame(frame(1));
  model.onFrame(frame(1));
  model.onFrame(frame(2));
  assert.equal(model.beacon(7).poses.size, 2);
  assert.equal(model.beacon(7).truth.size, 2);
});

test("beacons that went while there was no connection are forgotten", () => {
  const model = new Model();
  for (const address of [7, 8, 9]) model.beacon(address);
  assert.deepEqual(model.keepOnly([8, 9]), [7]);
  assert.deepEqual([...model.beacons.keys()], [8, 9]);
  assert.equal(model.selected, 8);
});

test("a fix has the verdict of the server, by number", () => {
  assert.deepEqual(verdicts.map(({ name }) => name), ["used", "down-weighted", "rejected"]);
  const model = new Model();
  model.onFrame({ beacons: [{ a: 7, fixes: [[1, 0.9, 1, 2, 3, null, null, null, null, 0.4, 1, 2]] }] });
  const fix = model.beacon(7).fixes.last();
  assert.equal(verdicts[fix.verdict].name, "rejected");
  assert.ok(Number.isNaN(fix.ix));
});

test("an ellipse has the axes and the direction of its covariance", () => {
  const along = ellipseOf(4, 0, 1);
  near(along.long, 2);
  near(along.short, 1);
  near(along.angle, 0);
  const diagonal = ellipseOf(2.5, 1.5, 2.5); // the same, turned by 45 degrees
  near(diagonal.long, 2);
  near(diagonal.short, 1);
  near(diagonal.angle, Math.PI / 4);
  near(ellipseOf(1, 1, 1).short, 0);
});

test("a place stays where it is when the view is zoomed there", () => {
  const view = new View([1, 1000]);
  [view.width, view.height] = [800, 600];
  const before = view.toWorld(100, 50);
  view.zoom(3, [100, 50]);
  const after = view.toWorld(100, 50);
  near(before[0], after[0]);
  near(before[1], after[1]);
  near(view.toScreen(...after)[1], 50);
});

test("a line is interrupted where nothing is known, and reaches the last point", () => {
  const drawn = [];
  const context = {
    beginPath: () => {}, stroke: () => {},
    moveTo: (x) => drawn.push(["move", x]), lineTo: (x) => drawn.push(["line", x]),
  };
  const view = new View([1, 1]);
  view.scale = 1;
  view.width = 0;
  const path = new LinePath(context, view, 3);
  [0, 1, 2, 3, 4, NaN, 6, 7, 8, 9, 10].forEach((x, i) => path.add(i, x, 0));
  path.stroke();
  assert.deepEqual(drawn, [["move", 0], ["line", 3], ["line", 4], ["move", 6], ["line", 9], ["line", 10]]);
});

test("what is not known comes last in both directions", () => {
  const sorted = (isDescending) => [3, NaN, 1, 2, NaN].sort((a, b) => compareKnown(a, b, isDescending));
  assert.deepEqual(sorted(false), [1, 2, 3, NaN, NaN]);
  assert.deepEqual(sorted(true), [3, 2, 1, NaN, NaN]);
});

test("the status of a pose has the words and the severity of the server", () => {
  setStatusTable([{ bit: 4, word: "stale", severity: 75 }, { bit: 8, word: "converging", severity: 35 }]);
  assert.deepEqual(words(12), { text: "stale, converging", severity: 75 });
  assert.deepEqual(words(0), { text: "ok", severity: 0 });
});

test("a heading is shown if the pose knows it", () => {
  assert.ok(hasHeading({ yaw: 1, yaw_std: 0.1, status: 8 }));
  assert.ok(hasHeading({ yaw: 1, yaw_std: NaN, status: NaN })); // not recorded
  assert.ok(!hasHeading({ yaw: 1, yaw_std: 0.01, status: 16 }));
  assert.ok(!hasHeading({ yaw: 1, yaw_std: 0.6, status: 0 }));
  assert.ok(!hasHeading({ yaw: NaN, yaw_std: 0.1, status: 0 }));
});

test("the map draws three standard deviations as an ellipse and the heading as an arrow, with y up", () => {
  load("map.js");
  const calls = [];
  const recorder = { get: (target, name) => target[name] ?? ((...values) => calls.push([name, ...values])) };
  const map = Object.assign(Object.create(sonopose.MapView.prototype), { context: new Proxy({}, recorder), scale: 100 });
  const called = (name) => calls.filter(([each]) => each === name).map(([, ...values]) => values);
  map.drawEllipse({ cxx: 0.04, cxy: 0, cyy: 0.01 }, 50, 60); // 0.2 m along x, 0.1 m along y
  map.drawEllipse({ cxx: 0.025, cxy: 0.015, cyy: 0.025 }, 50, 60); // the same along the diagonal
  const [along, diagonal] = called("ellipse");
  [50, 60, 60, 30, 0].forEach((value, i) => near(along[i], value));
  [50, 60, 60, 30, -Math.PI / 4].forEach((value, i) => near(diagonal[i], value));
  setStatusTable([]);
  map.drawHeading({ yaw: Math.PI / 2, status: 0 }, 50, 60, 10);
  assert.deepEqual(called("translate"), [[50, 60]]);
  near(called("rotate")[0][0], -Math.PI / 2);
  const [tip, ...others] = [...called("moveTo"), ...called("lineTo")].map(([x]) => x);
  assert.ok(others.every((x) => x < tip), "the tip is in front");
  map.drawHeading({ yaw: Math.PI / 2, status: 16 }, 50, 60, 10); // unknown
  assert.equal(called("rotate").length, 1);
  assert.equal(called("arc").length, 1);
});

test("a live connection that falls silent is opened again", () => {
  let now = 0;
  let watch = null;
  const sockets = [];
  const states = [];
  Object.defineProperty(globalThis, "performance", { value: { now: () => now }, configurable: true });
  globalThis.setInterval = (call) => { watch = call; };
  globalThis.setTimeout = (call) => call();
  globalThis.fetch = async () => ({ status: 426 });
  globalThis.WebSocket = class {
    static OPEN = 1;
    constructor() {
      this.readyState = 1;
      sockets.push(this);
    }
    close() {
      this.readyState = 3;
    }
  };
  const connection = new Connection({ onMessage: () => {}, onState: (text, isConnected) => states.push([text, isConnected]) });
  sockets[0].onopen();
  now = 60_000;
  watch();
  assert.equal(sockets.length, 1); // a recording sends nothing
  connection.isLive = true;
  sockets[0].onmessage({ data: "{}" });
  now += 4_900;
  watch();
  assert.equal(sockets.length, 1);
  now += 200;
  watch();
  assert.equal(sockets.length, 2);
  assert.ok(states.some(([text, isConnected]) => text.includes("lost") && !isConnected));
});

test("a WebSocket that does not open is explained, one that is lost is not said to be refused", async () => {
  const texts = async (hasOpened) => {
    const states = [];
    const sockets = [];
    let opened = 0;
    globalThis.setTimeout = () => { opened += 1; };
    globalThis.fetch = async () => ({ status: 426, text: async () => "" });
    globalThis.WebSocket = class {
      static OPEN = 1;
      constructor() { sockets.push(this); this.readyState = 3; }
    };
    new Connection({ onMessage: () => {}, onState: (text) => states.push(text) });
    if (hasOpened) sockets[0].onopen();
    sockets[0].onclose();
    await new Promise((resolve) => { setImmediate(resolve); });
    assert.equal(opened, 1);
    return states;
  };
  assert.match((await texts(false)).at(-1), /refused; see the log/);
  assert.match((await texts(true)).at(-1), /^connection lost/);
});

test("plots follow until somebody chooses a range, and hide what a beacon does not have", () => {
  globalThis.document = {
    createElement: () => ({ append: () => {}, addEventListener: () => {}, setAttribute: () => {}, clientWidth: 500 }),
  };
  const made = [];
  globalThis.Dygraph = class {
    constructor(graph, rows, options) {
      this.options = options;
      this.width = 500;
      made.push(this);
    }
    updateOptions({ dateWindow }) {
      if (dateWindow) this.options.dateWindow = dateWindow;
      this.options.drawCallback(this, false);
    }
    resize() {
      this.width = 500;
      this.options.drawCallback(this, false);
    }
    xAxisRange() {
      return this.options.dateWindow;
    }
    size() {
      return { width: this.width };
    }
  };
  Dygraph.defaultInteractionModel = {};
  load("plots.js");
  const model = new Model();
  for (let t = 1000; t < 1200; t += 1) model.onFrame({ beacons: [{ a: 7, pose: [t, 1, 2, 3, 0, 0, 0, 1, 0, 0] }] });
  const plots = new sonopose.Plots({ append: () => {}, hidden: false }, model);
  plots.draw();
  assert.equal(plots.title.textContent, "Beacon 7");
  assert.equal(made.length, 2); // height and speed
  assert.deepEqual(made[0].xAxisRange(), [1139e3, 1199e3]);
  model.onFrame({ beacons: [{ a: 7, pose: [1200, 1, 2, 3] }] });
  made[0].width = 0; // like after a resize in a hidden tab
  plots.draw();
  assert.equal(plots.zoomed, null);
  assert.equal(made[0].width, 500);
  assert.deepEqual(made[1].xAxisRange(), [1140e3, 1200e3]);
  model.isNew = false;
  made[0].updateOptions({ dateWindow: [1050e3, 1060e3] }); // a pan
  assert.ok(model.isNew);
  plots.draw();
  assert.deepEqual(made[1].xAxisRange(), [1050e3, 1060e3]);
  plots.follow(Infinity);
  plots.draw();
  assert.deepEqual(made[1].xAxisRange(), [1000e3, 1200e3]);
  model.beacon(8);
  model.select(8);
  plots.draw();
  assert.ok(plots.graphs.every(({ box }) => box.hidden));
  made[0].resize(); // the plot is hidden
  assert.equal(plots.zoomed, null);
});

test("the delay of the fixes is drawn without an estimate of it, and with one", () => {
  globalThis.document = {
    createElement: () => ({ append: () => {}, addEventListener: () => {}, setAttribute: () => {}, clientWidth: 500 }),
  };
  const model = new Model();
  const fix = (t, delay) => [t, t - delay, 1, 2, 3, 0, 0, 0, 0, 1, 1, 0];
  model.onFrame({ beacons: [{ a: 7, pose: [1010, 1, 2, 3], fixes: [fix(1001, 0.08), fix(1002, 0.09), fix(1003, 1003)] }] });
  const plots = new sonopose.Plots({ append: () => {}, hidden: false }, model);
  const { definition } = plots.graphs.find((plot) => plot.definition.name === "Delay of the fixes");
  const rowsOf = () => plots.rowsOfAll(definition, model.beacon(7), [1000e3, 1010e3]);
  const delays = () => rowsOf().rows.map(([time, ...values]) => [time.getTime() / 1000, ...values.map((ms) => ms && Math.round(ms))]);
  assert.ok(rowsOf().hasValues);
  assert.deepEqual(delays(), [[1001, 80, null], [1002, 90, null], [1003, null, null]]); // the last fix has no delay
  const latency_segments = Object.fromEntries(
    ["sensor_to_bridge", "bridge_to_fusion", "in_fusion", "fusion_to_here"].map((name) => [name, {}]));
  model.onStatus({ time_ns: 1001.5e9, beacons: [{ address: 7, latency_segments, estimate: { delay_s: { value: 0.085 } } }] });
  assert.deepEqual(delays().slice(0, 3), [[1001, 80, null], [1001.5, null, 85], [1002, 90, null]]);
});

test("a change without a selected beacon is refused, and nothing is sent", () => {
  const part = () => ({ children: [], addEventListener: () => {}, setAttribute: () => {}, prepend: () => {} });
  globalThis.document = {
    createElement: () => ({ ...part(), append(...children) { this.children.push(...children); this.lastChild = children.at(-1); } }),
  };
  load("settings.js");
  const sent = [];
  const of = { ...part(), value: "all", options: [], append: () => {} };
  const parts = { list: part(), search: part(), of, reset: part(), note: part(), requests: part() };
  const settings = new sonopose.Settings(parts, [], (request) => sent.push(request));
  const lines = [];
  parts.requests.prepend = (line) => lines.push(line);
  settings.send({ op: "reset" }, "reset");
  assert.deepEqual(sent, [{ op: "reset", id: 1, address: "all" }]);
  of.value = "";
  settings.send({ op: "reset" }, "reset");
  assert.equal(sent.length, 1);
  assert.equal(lines[1].className, "refused");
  assert.match(lines[1].lastChild.textContent, /select a beacon/);
});

// A list whose items can be inserted and removed, like those of a document.
const listPart = () => ({
  children: [], className: "", hidden: false,
  append(...children) { this.children.push(...children); },
  insertBefore(child, before) {
    child.remove = () => this.children.splice(this.children.indexOf(child), 1);
    this.children.splice(before ? this.children.indexOf(before) : this.children.length, 0, child);
  },
  replaceChildren(...children) { this.children = children; },
});
const choicePart = (value) => ({
  value, options: [{ value }],
  addEventListener(_, listener) { this.choose = (chosen) => { this.value = chosen; listener(); }; },
  append(option) { this.options.push(option); },
});

const makeEvents = () => {
  globalThis.document = { createElement: () => listPart() };
  load("events.js");
  const parts = { list: listPart(), warnings: listPart(), level: choicePart("info"), program: choicePart("") };
  const textsOf = () => parts.list.children.filter(({ hidden }) => !hidden).map(({ children }) => children[2].textContent);
  const labelsOf = () => parts.list.children.map(({ children }) => children[1].textContent);
  return { parts, events: new sonopose.Events(parts), textsOf, labelsOf };
};
const line = (t, text, program, pid, level = "info") => ({ t, level, text, program, host: "robot", pid });

test("events and lines of logs are shown by time, with their program, bounded, and as text", () => {
  const { parts, events, textsOf, labelsOf } = makeEvents();
  events.add(line(20, "b", "sonopose-bridge", 1));
  events.add(line(30, "<b>c</b>", "sonopose-fusion", 2, "warning"));
  events.add(line(10, "a", "sonopose-fusion", 2));
  events.add({ t: 25, level: "warning", text: "no pose" });
  assert.deepEqual(textsOf(), ["<b>c</b>", "no pose", "b", "a"]);
  assert.deepEqual(labelsOf(), ["fusion", "", "bridge", "fusion"]);
  events.add(line(40, "d", "sonopose-fusion", 3, "error"));
  assert.deepEqual(labelsOf(), ["fusion robot:3", "fusion robot:2", "", "bridge", "fusion robot:2"]);
  assert.deepEqual(parts.program.options.map(({ value }) => value), ["", "bridge", "fusion"]);
  parts.program.choose("fusion");
  assert.deepEqual(textsOf(), ["d", "<b>c</b>", "a"]);
  parts.level.choose("warning");
  assert.deepEqual(textsOf(), ["d", "<b>c</b>"]);
  events.add(line(50, "e", "sonopose-fusion", 3));
  assert.deepEqual(textsOf(), ["d", "<b>c</b>"]); // the filter applies to new lines
  parts.program.choose("");
  parts.level.choose("info");
  for (let i = 0; i < 1000; i += 1) events.add(line(100 + i, `line ${i}`, `program ${i}`, i));
  assert.equal(parts.list.children.length, 500);
  assert.equal(textsOf()[0], "line 999");
  assert.equal(parts.program.options.length, 32);
  events.clear();
  assert.equal(parts.list.children.length, 0);
  assert.equal(events.lines.length, 0);
});

test("of the lines those that arrived first are left out, whatever the clocks of their machines are", () => {
  const { parts, events, textsOf } = makeEvents();
  for (let i = 0; i < 500; i += 1) events.add(line(1000 + i, `line ${i}`, "sonopose-fusion", 1));
  events.add(line(10, "behind", "sonopose-bridge", 2));
  events.add(line(9000, "ahead", "sonopose-bridge", 3));
  assert.equal(textsOf().length, 500);
  assert.equal(textsOf()[0], "ahead");
  assert.equal(textsOf().at(-1), "behind");
  assert.ok(!textsOf().includes("line 1") && textsOf().includes("line 2"));
  for (let i = 0; i < 499; i += 1) events.add(line(2000 + i, `later ${i}`, "sonopose-fusion", 1));
  assert.deepEqual(textsOf().slice(0, 2), ["ahead", "later 498"]);
  events.add(line(3000, "last", "sonopose-fusion", 1));
  assert.equal(textsOf()[0], "last");
  assert.deepEqual(events.lines.map(({ item }) => item), parts.list.children);
});

test("a label is written again only if its program has one process more or less to distinguish", () => {
  const { events, labelsOf } = makeEvents();
  let writes = 0;
  globalThis.document.createElement = (tag) => {
    let text = "";
    return tag !== "b" ? listPart() : Object.defineProperty(listPart(), "textContent", {
      get: () => text,
      set: (value) => { text = value; writes += 1; },
    });
  };
  for (let i = 0; i < 499; i += 1) events.add(line(i, `${i}`, "sonopose-fusion", 1));
  assert.ok(writes <= 2 * 499, `${writes} writes for 499 lines`);
  events.add(line(499, "499", "sonopose-fusion", 2));
  assert.deepEqual(new Set(labelsOf()), new Set(["fusion robot:1", "fusion robot:2"]));
  for (let i = 500; i < 999; i += 1) events.add(line(i, `${i}`, "sonopose-fusion", 2));
  assert.deepEqual(new Set(labelsOf()), new Set(["fusion"])); // the other process's lines are gone
  assert.ok(writes <= 3 * 999, `${writes} writes for 999 lines`);
});

test("lines that were lost are a line of their own, before the next one of their process", () => {
  const { parts, events, textsOf, labelsOf } = makeEvents();
  events.add(line(10, "a", "sonopose-fusion", 1));
  events.add(line(20, "b", "sonopose-fusion", 2));
  events.add({ ...line(30, "c", "sonopose-fusion", 2), missing: 3 });
  events.add({ ...line(40, "d", "sonopose-fusion", 1, "error"), missing: 1 });
  assert.deepEqual(textsOf(), ["d", "1 line is missing", "c", "3 lines are missing", "b", "a"]);
  assert.equal(labelsOf()[3], "fusion robot:2");
  assert.deepEqual(parts.list.children.map(({ className }) => className),
    ["error", "warning", "info", "warning", "info", "info"]);
  parts.level.choose("warning");
  assert.deepEqual(textsOf(), ["d", "1 line is missing", "3 lines are missing"]);
});

test("the same line of a second process, such as a standby, is shown once, with both processes", () => {
  const { events, textsOf, labelsOf } = makeEvents();
  events.add(line(10, "beacon 7: heading is known", "sonopose-fusion", 1));
  events.add(line(10.2, "beacon 7: heading is known", "sonopose-fusion", 2));
  assert.deepEqual(textsOf(), ["beacon 7: heading is known"]);
  assert.deepEqual(labelsOf(), ["fusion robot:1, robot:2"]);
  events.add(line(10.4, "beacon 7: heading is known", "sonopose-fusion", 1)); // it says so again
  events.add(line(12, "beacon 7: heading is known", "sonopose-fusion", 2));
  events.add(line(12, "beacon 7: heading is known", "sonopose-bridge", 3));
  assert.equal(textsOf().length, 4);
});

test("lines after the time that is shown of a recording are hidden, and only those that change are touched", () => {
  const { parts, events, textsOf } = makeEvents();
  for (let t = 0; t < 100; t += 1) events.add(line(t, `${t}`, t % 2 ? "sonopose-bridge" : "sonopose-fusion", 1));
  let writes = 0;
  for (const item of parts.list.children) {
    let { hidden } = item;
    Object.defineProperty(item, "hidden", { get: () => hidden, set: (value) => { hidden = value; writes += 1; } });
  }
  events.showUntil(49.5);
  assert.deepEqual([textsOf()[0], textsOf().length], ["49", 50]);
  assert.equal(writes, 50);
  for (let t = 49.6; t < 50; t += 0.1) events.showUntil(t);
  assert.equal(writes, 50);
  events.showUntil(51);
  assert.deepEqual(textsOf().slice(0, 2), ["51", "50"]);
  assert.equal(writes, 52);
  events.showUntil(20);
  assert.equal(textsOf()[0], "20");
  assert.equal(writes, 83);
  parts.program.choose("bridge");
  assert.equal(textsOf()[0], "19"); // a filter shows no later line
  events.showUntil(30);
  assert.equal(textsOf()[0], "29");
  events.add(line(60, "later", "sonopose-bridge", 1));
  assert.equal(textsOf()[0], "29");
  events.showUntil(Infinity);
  assert.equal(textsOf()[0], "99");
});

// A playback of beacon 7 with its time bar.
const makePlayback = (duration, status, fixes = { t: [] }) => {
  load("playback.js");
  const part = () => ({ addEventListener(_, listener) { this.act = listener; } });
  const parts = { box: {}, time: part(), play: part(), rate: { value: "1" }, clock: {} };
  const model = new Model();
  const none = { t: [] };
  const beacons = [{ address: 7, rows: 2, poses: none, fixes, truth: none, status }];
  const playback = new sonopose.Playback(parts, model, { begin: 1000, duration, stationary: [], beacons });
  return { parts, model, playback };
};

test("a recording fills the plots of latency, delay and battery", () => {
  const status = { t: [0, 1], battery: [3.9, null], delay: [0.08, 0.09], in_fusion: [0.001, 0.002] };
  const { model } = makePlayback(1, status);
  const { row, size } = { row: model.beacon(7).status.last(), size: model.beacon(7).status.size };
  assert.equal(size, 2);
  assert.equal(row.t, 1001);
  assert.ok(Number.isNaN(row.battery));
  assert.equal(row.delay, 0.09);
  assert.equal(row.in_fusion, 0.002);
  assert.ok(Number.isNaN(row.fusion_to_here));
});

test("both times of a recorded fix are those of a clock, as live", () => {
  const { model } = makePlayback(2, { t: [] }, { t: [1, 2], t_emission: [0.92, null], verdict: [0, 0] });
  const { fixes } = model.beacon(7);
  near(fixes.row(0).t, 1001);
  near(fixes.row(0).t_emission, 1000.92);
  assert.ok(Number.isNaN(fixes.row(1).t_emission));
});

test("the table has the battery of a live beacon, and of a recording that of the time that is shown", () => {
  globalThis.document = { createElement: () => ({ ...listPart(), style: {}, dataset: {}, setAttribute: () => {}, addEventListener: () => {} }) };
  load("table.js");
  const batteryOf = (model) => {
    const part = listPart();
    new sonopose.Table(part, model).draw();
    const [head, body] = part.children;
    const at = head.children[0].children.findIndex(({ children }) => children[0].textContent === "battery");
    return body.children[0].children[at].textContent;
  };
  const live = new Model();
  live.onStatus({ time_ns: 5e9, beacons: [{ address: 7, latency_segments: Object.fromEntries(
    ["sensor_to_bridge", "bridge_to_fusion", "in_fusion", "fusion_to_here"].map((name) => [name, {}])), bridge: { battery_v: 3.75 } }] });
  assert.equal(batteryOf(live), "3.75 V");
  const { model, playback } = makePlayback(10, { t: [1, 9], battery: [3.9, 3.7] });
  assert.equal(batteryOf(model), "3.70 V");
  playback.show(5);
  assert.equal(batteryOf(model), "3.90 V");
  playback.show(0);
  assert.equal(batteryOf(model), "–");
});

test("a recording is played by the times of the pictures, at its rate, until its end", () => {
  const { parts, model, playback } = makePlayback(10, { t: [] });
  Object.defineProperty(globalThis, "performance", { value: { now: () => 5010 }, configurable: true });
  const picture = (nowMs) => {
    model.isNew = false;
    playback.advance(nowMs);
    return model.now;
  };
  assert.equal(picture(4000), 1010); // at the end and not playing
  assert.ok(!model.isNew);
  parts.play.act();
  assert.equal(model.now, 1000); // from the beginning
  parts.time.value = "2";
  parts.time.act();
  near(picture(5000), 1002); // the click came after this picture's time
  near(picture(5500), 1002.5);
  assert.ok(model.isNew);
  assert.match(parts.clock.textContent, /^2.5 s of 10.0 s/);
  assert.equal(Number(parts.time.value), 2.5);
  parts.rate.value = "8";
  near(picture(6000), 1006.5);
  parts.play.act(); // pause
  near(picture(7000), 1006.5);
  parts.play.act();
  near(picture(8000), 1006.5); // the pause does not count
  near(picture(8250), 1008.5);
  assert.ok(playback.isPlaying && !playback.isAtEnd);
  near(picture(9000), 1010);
  assert.ok(!playback.isPlaying && playback.isAtEnd);
  assert.equal(parts.play.textContent, "▶");
});

test("the time bar reaches the end of a recording whose length is no multiple of its step", () => {
  const { parts, model, playback } = makePlayback(12.347, { t: [] });
  parts.time.value = "12.3";
  parts.time.act();
  assert.ok(!playback.isAtEnd);
  parts.time.value = "12.34"; // the last value of a browser's bar
  parts.time.act();
  assert.ok(playback.isAtEnd);
  near(model.now, 1012.347);
});
