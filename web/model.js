// Data of each beacon: bounded columns of numbers over time.
"use strict";

(() => {
  const keptSeconds = 600;
  const unknown = NaN;

  // A ring of rows, each with a time and some numbers; old rows make room for new ones.
  class Columns {
    constructor(names, capacity) {
      this.names = names;
      this.capacity = capacity;
      this.columns = Object.fromEntries(names.map((name) => [name, new Float64Array(capacity)]));
      this.begin = 0;
      this.size = 0;
      this.pushed = 0; // rows so far
    }

    push(values) {
      this.pushed += 1;
      const at = (this.begin + this.size) % this.capacity;
      this.names.forEach((name, i) => {
        const value = values[i];
        this.columns[name][at] = value === null || value === undefined ? unknown : value;
      });
      if (this.size < this.capacity) this.size += 1;
      else this.begin = (this.begin + 1) % this.capacity;
    }

    clear() {
      this.begin = 0;
      this.size = 0;
    }

    get(name, i) {
      return this.columns[name][(this.begin + i) % this.capacity];
    }

    row(i) {
      return Object.fromEntries(this.names.map((name) => [name, this.get(name, i)]));
    }

    // The number of rows whose time is at most `t`.
    count(t) {
      let low = 0;
      let high = this.size;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.get("t", middle) <= t) low = middle + 1;
        else high = middle;
      }
      return low;
    }

    last(t = Infinity) {
      const count = t === Infinity ? this.size : this.count(t);
      return count > 0 ? this.row(count - 1) : null;
    }
  }

  const poseNames = ["t", "x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "cxx", "cxy", "cyy", "czz",
    "yaw_std", "trust", "status", "since_fix"];
  const fixNames = ["t", "t_emission", "x", "y", "z", "ix", "iy", "iz", "ratio", "weight", "flags", "verdict"];
  const truthNames = ["t", "x", "y", "z", "yaw"];
  const segmentNames = ["sensor_to_bridge", "bridge_to_fusion", "in_fusion", "fusion_to_here"];
  const statusNames = ["t", "battery", "delay", ...segmentNames];

  const palette = ["#1f77d0", "#d0571f", "#8a4fbf", "#0f9d9d", "#c2337c", "#6f8f00", "#9c6b3f", "#4a68d8"];

  class Beacon {
    constructor(address, capacity) {
      this.address = address;
      this.colour = palette[address % palette.length];
      this.poses = new Columns(poseNames, capacity.poses);
      this.fixes = new Columns(fixNames, capacity.fixes);
      this.truth = new Columns(truthNames, capacity.poses);
      this.status = new Columns(statusNames, capacity.status);
      this.latest = null; // the monitor's object of the latest second
      this.truthErrorM = unknown;
    }

    // Of the latest pose, against the truth of the same time if it is known, else of the nearest one.
    updateTruthError() {
      const pose = this.poses.last();
      const truth = this.truth.last();
      if (!pose || !truth) return;
      const passed = pose.t - truth.t;
      if (Math.abs(passed) > 0.2) return;
      const dx = pose.x - truth.x - pose.vx * passed;
      const dy = pose.y - truth.y - pose.vy * passed;
      const dz = pose.z - truth.z - pose.vz * passed;
      this.truthErrorM = Math.hypot(dx, dy, dz);
    }
  }

  class Model {
    constructor() {
      this.beacons = new Map();
      this.capacity = { poses: keptSeconds * 25, fixes: keptSeconds * 16, status: keptSeconds };
      this.stationary = [];
      this.geofence = null;
      this.floorPlan = null; // {image, area_m}
      this.now = null; // time that is shown, s; null: the latest
      this.extent = null; // of a recording: its first and last time, s
      this.selected = null; // address
      this.isNew = true; // something to draw
    }

    beacon(address) {
      let beacon = this.beacons.get(address);
      if (!beacon) {
        beacon = new Beacon(address, this.capacity);
        this.beacons.set(address, beacon);
        if (this.selected === null) this.selected = address;
      }
      return beacon;
    }

    get shown() {
      return this.now === null ? Infinity : this.now;
    }

    onFrame(frame) {
      // A new connection repeats the latest row.
      const pushNew = (columns, row) => {
        if (row && columns.last()?.t !== row[0]) columns.push(row);
      };
      for (const part of frame.beacons) {
        const beacon = this.beacon(part.a);
        pushNew(beacon.truth, part.truth);
        pushNew(beacon.poses, part.pose);
        for (const fix of part.fixes || []) beacon.fixes.push(fix);
        beacon.updateTruthError();
      }
      this.isNew = true;
    }

    onStatus(status) {
      const t = status.time_ns * 1e-9;
      for (const view of status.beacons) {
        const beacon = this.beacon(view.address);
        beacon.latest = view;
        const bridge = view.bridge || {};
        const delay = view.estimate && view.estimate.delay_s ? view.estimate.delay_s.value : null;
        const segments = segmentNames.map((name) => view.latency_segments[name].p50_s);
        beacon.status.push([t, bridge.battery_v, delay, ...segments]);
      }
      this.isNew = true;
    }

    forget(address) {
      this.beacons.delete(address);
      if (this.selected === address) this.selected = this.beacons.keys().next().value ?? null;
      this.isNew = true;
    }

    // Forgets all others: they went while there was no connection. Returns the addresses.
    keepOnly(addresses) {
      const gone = [...this.beacons.keys()].filter((address) => !addresses.includes(address));
      for (const address of gone) this.forget(address);
      return gone;
    }

    clearTracks() {
      for (const beacon of this.beacons.values()) {
        beacon.poses.clear();
        beacon.truth.clear();
        beacon.fixes.clear();
      }
      this.isNew = true;
    }

    select(address) {
      this.selected = address;
      this.isNew = true;
    }

    isOutside(pose) {
      if (!this.geofence || !Number.isFinite(pose.x)) return false;
      let inside = false;
      const corners = this.geofence;
      for (let i = 0, j = corners.length - 1; i < corners.length; j = i++) {
        const [xi, yi] = corners[i];
        const [xj, yj] = corners[j];
        if (yi > pose.y !== yj > pose.y && pose.x < ((xj - xi) * (pose.y - yi)) / (yj - yi) + xi) inside = !inside;
      }
      return !inside;
    }
  }

  // Bits of FusedPose.status: {bit, word, severity, hidden_by}, as the server has them.
  let statusTable = [];
  const setStatusTable = (table) => {
    statusTable = table;
  };
  const words = (status) => {
    const set = statusTable.filter(({ bit, hidden_by }) =>
      (status & bit) !== 0 && (status & hidden_by) === 0);
    return { text: set.map(({ word }) => word).join(", ") || "ok", severity: Math.max(0, ...set.map(({ severity }) => severity)) };
  };
  const headingUnknown = 16; // bit of FusedPose.status
  const mostYawStd = Math.PI / 6; // of a heading that is shown

  // A yaw is always there; it is arbitrary while the heading is not known.
  const hasHeading = (pose) =>
    Number.isFinite(pose.yaw) && (pose.status & headingUnknown) === 0 && !(pose.yaw_std > mostYawStd);
  const badSeverity = 50; // as in the monitor: from here on the pose cannot be relied on

  // For sorting numbers; those that are not known come last in both directions.
  const compareKnown = (a, b, isDescending) => {
    const unknowns = Number(Number.isNaN(a)) - Number(Number.isNaN(b));
    if (unknowns !== 0 || Number.isNaN(a)) return unknowns;
    return isDescending ? b - a : a - b;
  };

  // "1.23 m"; a dash for what is unknown.
  const format = (value, digits, unit = "") =>
    Number.isFinite(value) ? `${value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1")}${unit ? ` ${unit}` : ""}` : "–";

  const clockText = (t) => new Date(t * 1000).toLocaleTimeString([], { hour12: false });

  Object.assign(sonopose, { Model, Columns, setStatusTable, words, hasHeading, badSeverity, compareKnown, format, clockText });
})();
