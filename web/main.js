// Puts the page together. Tests use sonopose.statistics and the ids #state, #map, #beacons, #events, #findings,
// #settings, #requests and #time.
"use strict";

(async () => {
  const { Model, MapView, Plots, Table, Events, Findings, Settings, Playback, Connection, fetchJson, urlOf } = sonopose;
  const byId = (id) => document.getElementById(id);
  const model = new Model();
  const statistics = { frames: 0, drawn: 0, drawn_per_s: 0, dropped: 0, connected: false, beacons: {} };
  sonopose.statistics = statistics;
  sonopose.model = model;

  const map = new MapView(byId("map"), model);
  const plots = new Plots(byId("plots"), model);
  const table = new Table(byId("beacons"), model);
  const events = new Events(byId("events"), byId("warnings"));
  let connection = null;
  const request = (object) => connection !== null && connection.send(object);
  const findings = new Findings(byId("findings"), byId("progress"), byId("examine"), () => request({ op: "examine", seconds: 8 }));
  let playback = null;
  let hasLoaded = false; // the recording

  for (const tab of byId("tabs").children) {
    tab.addEventListener("click", () => {
      for (const each of byId("tabs").children) {
        each.setAttribute("aria-selected", String(each === tab));
        byId(each.dataset.panel).hidden = each !== tab;
      }
      model.isNew = true;
    });
  }
  byId("fit").addEventListener("click", () => {
    map.fit();
    plots.follow();
  });
  byId("clear").addEventListener("click", () => {
    model.clearTracks();
    map.redraw();
  });
  for (const name of ["fixes", "truth", "plan"]) {
    byId(`show-${name}`).addEventListener("change", (event) => {
      map.shows[name] = event.target.checked;
      map.redraw();
    });
  }

  let stateText = "";
  const showState = () => {
    const slow = statistics.dropped > 0 ? `, ${statistics.dropped} frames dropped: this browser is slow` : "";
    byId("state").textContent = stateText + slow;
    byId("state").className = statistics.connected ? (slow ? "slow" : "") : "lost";
  };

  const loadRecording = async (hello) => {
    if (hasLoaded) return;
    hasLoaded = true;
    const parts = { box: byId("playback"), time: byId("time"), play: byId("play"), rate: byId("rate"), clock: byId("clock") };
    const recording = await fetchJson("/recording.json");
    playback = new Playback(parts, model, recording);
    for (const event of recording.events || []) events.add(event);
    for (const tab of document.querySelectorAll('[data-panel="doctor"], [data-panel="settings-panel"]')) tab.hidden = true;
    byId("clear").hidden = true;
    byId("title").textContent = hello.title;
    map.fit();
  };

  const settings = new Settings(
    {
      list: byId("settings"), search: byId("settings-search"), of: byId("settings-of"), reset: byId("reset"),
      note: byId("settings-note"), requests: byId("requests"),
    },
    await fetchJson("/settings.json"),
    request,
  );

  const handlers = {
    hello: (hello) => {
      document.title = hello.mode === "recording" ? `${hello.title} – sonopose` : `sonopose, domain ${hello.domain}`;
      byId("title").textContent = hello.mode === "recording" ? hello.title : `domain ${hello.domain}, version ${hello.version}`;
      events.clear(); // the server repeats them
      settings.allow(hello.allow_changes);
      if (hello.mode === "recording") return loadRecording(hello);
      return undefined;
    },
    frame: (frame) => {
      statistics.frames += 1;
      model.onFrame(frame);
    },
    status: (status) => {
      model.onStatus(status);
      events.showWarnings(status.warnings);
    },
    event: (event) => events.add(event),
    stationary: (message) => {
      model.stationary = message.beacons;
      map.redraw();
    },
    settings: (message) => settings.onSettings(message),
    reply: (message) => settings.onReply(message),
    findings: (message) => findings.show(message),
    gone: (message) => {
      model.forget(message.a);
      map.redraw();
    },
    dropped: (message) => {
      statistics.dropped = message.frames;
      showState();
    },
  };

  const layers = await fetchJson("/map.json");
  model.geofence = layers.geofence;
  if (layers.floor_plan) {
    const image = new Image();
    image.addEventListener("load", () => {
      model.floorPlan = { image, area_m: layers.floor_plan.area_m };
      map.redraw();
    });
    image.src = urlOf(layers.floor_plan.url);
  }

  connection = new Connection({
    onMessage: (message) => handlers[message.op]?.(message),
    onState: (text, isConnected) => {
      stateText = text;
      statistics.connected = isConnected;
      statistics.dropped = 0;
      showState();
    },
  });

  const updateStatistics = () => {
    for (const beacon of model.beacons.values()) {
      const pose = beacon.poses.last(model.shown);
      if (pose) statistics.beacons[beacon.address] = { t: pose.t, x: pose.x, y: pose.y, z: pose.z, truth_error_m: beacon.truthErrorM };
    }
  };

  // The map as soon as there is something new; what is costly and slow to read four times a second.
  let sinceSecond = performance.now();
  let drawnBefore = 0;
  let isSlowDue = false;
  let slowFrom = 0;
  const draw = (now) => {
    requestAnimationFrame(draw);
    if (playback) playback.advance(now);
    if (now - sinceSecond >= 1000) {
      statistics.drawn_per_s = ((statistics.drawn - drawnBefore) * 1000) / (now - sinceSecond);
      drawnBefore = statistics.drawn;
      sinceSecond = now;
    }
    if (model.isNew) {
      model.isNew = false;
      isSlowDue = true;
      map.draw();
      statistics.drawn += 1;
    }
    if (!isSlowDue || now < slowFrom) return;
    isSlowDue = false;
    slowFrom = now + 250;
    table.draw();
    plots.draw();
    updateStatistics();
  };
  requestAnimationFrame(draw);
})();
