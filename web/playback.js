// A recording: fills the model completely; the time bar chooses what is shown.
"use strict";

(() => {
  const { clockText } = sonopose;

  const times = ["t", "t_emission"]; // in seconds since the beginning of the recording

  // Columns of numbers, null where a value is not known.
  const fill = (columns, given, beginS) => {
    const valueOf = (name, i) => {
      const value = given[name]?.[i] ?? NaN;
      return times.includes(name) ? beginS + value : value;
    };
    for (let i = 0; i < given.t.length; i += 1) columns.push(columns.names.map((name) => valueOf(name, i)));
  };

  class Playback {
    constructor(parts, model, recording) {
      this.parts = parts;
      this.model = model;
      this.beginS = recording.begin;
      this.durationS = recording.duration;
      const rows = Math.max(1, ...recording.beacons.map((beacon) => beacon.rows));
      model.capacity = { poses: rows, fixes: rows, status: rows };
      for (const each of recording.beacons) {
        const beacon = model.beacon(each.address);
        fill(beacon.poses, each.poses, this.beginS);
        fill(beacon.truth, each.truth, this.beginS);
        fill(beacon.fixes, each.fixes, this.beginS);
        fill(beacon.status, each.status, this.beginS);
      }
      model.stationary = recording.stationary;
      model.extent = [this.beginS, this.beginS + this.durationS];
      this.isPlaying = false;
      this.lastMs = null; // the time of the latest picture, while it plays
      parts.box.hidden = false;
      parts.time.max = String(this.durationS);
      const stepS = Math.max(0.01, this.durationS / 20000);
      parts.time.step = String(stepS);
      parts.time.addEventListener("input", () => {
        const atS = Number(parts.time.value);
        this.show(atS > this.durationS - stepS ? this.durationS : atS); // the last step may be shorter
      });
      parts.play.addEventListener("click", () => this.play(!this.isPlaying));
      this.show(this.durationS);
    }

    // Seconds since the beginning.
    show(atS) {
      this.atS = Math.min(this.durationS, Math.max(0, atS));
      this.model.now = this.beginS + this.atS;
      this.model.isNew = true;
      this.parts.time.value = String(this.atS);
      this.parts.clock.textContent = `${this.atS.toFixed(1)} s of ${this.durationS.toFixed(1)} s, ${clockText(this.model.now)}`;
    }

    get isAtEnd() {
      return this.atS >= this.durationS;
    }

    play(isPlaying) {
      this.isPlaying = isPlaying;
      this.parts.play.textContent = isPlaying ? "❚❚" : "▶";
      this.lastMs = null;
      if (isPlaying && this.isAtEnd) this.show(0);
    }

    // Before each picture, whose time is `nowMs`. That of the first one may be before the click that started it.
    advance(nowMs) {
      if (!this.isPlaying) return;
      const passedS = this.lastMs === null ? 0 : (nowMs - this.lastMs) / 1000;
      this.show(this.atS + passedS * Number(this.parts.rate.value));
      this.lastMs = nowMs;
      if (this.isAtEnd) this.play(false);
    }
  }

  sonopose.Playback = Playback;
})();
