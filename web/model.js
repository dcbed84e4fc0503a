// What the page knows of each beacon: bounded columns of numbers over time.
"use strict";

window.sonopose = {};

(() => {
  const keptSeconds = 600;
  const unknown = NaN;

  // A ring of rows, each with a time and some numbers; old rows make place for new ones.
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
  const fixNames = ["t", "t_emission", "x", "y", "z", "ix", "iy", "iz", "ratio", "weight", "flags"];
  const truthNames = ["t", "x", "y", "z", "yaw"];
  const statusNames = ["t", "battery", "delay", "sensor_to_bridge", "bridge_to_fusion", "fusion", "fusion_to_here"];

  // Verdicts of a fix; the bits of FixReport.flags.
  const verdictOf = (fix) => {
    const used = 1;
    if ((fix.flags & used) === 0) return "rejected";
    return fix.ratio > 1 || fix.weight < 0.5 ? "weak" : "used";
  };

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
      for (const part of frame.beacons) {
        const beacon = this.beacon(part.a);
        if (part.truth) beacon.truth.push(part.truth);
        if (part.pose) beacon.poses.push(part.pose);
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
        const segments = Object.values(view.latency_segments).map((segment) => segment.p50_s);
        beacon.status.push([t, bridge.battery_v, delay, ...segments]);
      }
      this.isNew = true;
    }

    forget(address) {
      this.beacons.delete(address);
      if (this.selected === address) this.selected = this.beacons.keys().next().value ?? null;
      this.isNew = true;
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

  // Bits of FusedPose.status, the worst first.
  const statusBits = [
    [1, "initialising", "bad"], [4, "stale", "bad"], [32, "frozen track", "bad"], [2048, "overloaded", "bad"],
    [256, "low trust", "bad"], [1024, "late", "fair"], [128, "IMU gap", "fair"], [8, "converging", "fair"],
    [16, "heading unknown", "fair"], [2, "uncalibrated", "fair"], [64, "predicted", "good"],
    [512, "rotating fast", "good"],
  ];

  const severities = { bad: 2, fair: 1, good: 0 };
  const words = (status) => {
    const set = statusBits.filter(([bit]) => (status & bit) !== 0);
    return {
      text: set.map(([, name]) => name).join(", ") || "ok",
      severity: Math.max(0, ...set.map(([, , level]) => severities[level])),
    };
  };

  // "1.23 m"; a dash for what is unknown.
  const format = (value, digits, unit = "") =>
    Number.isFinite(value) ? `${value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1")}${unit ? ` ${unit}` : ""}` : "–";

  const clockText = (t) => new Date(t * 1000).toLocaleTimeString([], { hour12: false });

  const element = (tag, properties = {}, children = []) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };

  Object.assign(sonopose, { Model, Columns, verdictOf, words, format, clockText, element });
})();
