// Puts the page together. Tests use sonopose.statistics, sonopose.model, sonopose.plots and the ids #state, #map, #beacons, #events, #findings,
// #settings, #requests and #time.
"use strict";

(async () => {
  const byId = (id) => document.getElementById(id);
  const needed = ["Model", "MapView", "Plots", "Table", "Events", "Settings", "Playback", "Connection"];
  if (!window.Dygraph || !window.sonopose || needed.some((name) => !sonopose[name])) {
    byId("state").textContent = "a part of this page could not be loaded: reload it";
    byId("state").className = "lost";
    return;
  }
  const { Model, MapView, Plots, Table, Events, Findings, Settings, Playback, Connection } = sonopose;
  const { element, fetchJson, urlOf, setStatusTable } = sonopose;
  const model = new Model();
  const statistics = { frames: 0, drawn: 0, drawn_per_s: 0, dropped: 0, connected: false, beacons: {} };
  sonopose.statistics = statistics;
  sonopose.model = model;

  const map = new MapView(byId("map"), model);
  const plots = new Plots(byId("plots"), model);
  sonopose.plots = plots;
  sonopose.map = map;
  const table = new Table(byId("beacons"), model);
  const events = new Events({
    list: byId("events"), warnings: byId("warnings"), level: byId("events-level"), program: byId("events-program"),
  });
  let connection = null;
  const request = (object) => connection !== null && connection.send(object);
  const findings = new Findings(byId("findings"), byId("progress"), byId("examine"), () => request({ op: "examine", seconds: 8 }));
  let playback = null;
  let shownServer = null; // what the first hello named
  let isLoading = false; // the recording
  let isFirstStatus = true; // of this connection

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

  // Until the server answers.
  const fetchAlways = async (path) => {
    for (;;) {
      try {
        return await fetchJson(path);
      } catch (error) {
        stateText = `${error.message}; trying again`;
        showState();
        await new Promise((resolve) => { setTimeout(resolve, 2000); });
      }
    }
  };

  // Once: the server repeats it when it is connected again.
  const loadRecording = async (hello) => {
    if (isLoading) return;
    isLoading = true;
    const parts = { box: byId("playback"), time: byId("time"), play: byId("play"), rate: byId("rate"), clock: byId("clock") };
    stateText = "loading the recording";
    showState();
    const recording = await fetchAlways("/recording.json");
    stateText = "connected";
    showState();
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
    await fetchAlways("/settings.json"),
    request,
  );

  // Beacons that the model does not have any more.
  const forget = (...addresses) => {
    for (const address of addresses) {
      settings.forget(address);
      delete statistics.beacons[address];
    }
    if (addresses.length > 0) map.redraw();
  };

  const handlers = {
    hello: (hello) => {
      // At the same address another server may show something else.
      const server = JSON.stringify([hello.mode, hello.title, hello.domain, hello.version]);
      shownServer ??= server;
      if (server !== shownServer) {
        location.reload();
        return undefined;
      }
      document.title = hello.mode === "recording" ? `${hello.title} – sonopose` : `sonopose, domain ${hello.domain}`;
      byId("title").textContent = hello.mode === "recording" ? hello.title : `domain ${hello.domain}, version ${hello.version}`;
      connection.isLive = hello.mode === "live";
      settings.allow(hello.allow_changes);
      if (hello.mode === "recording") return loadRecording(hello);
      // The server repeats what still exists.
      events.clear();
      settings.clear();
      model.stationary = [];
      map.redraw();
      isFirstStatus = true;
      return undefined;
    },
    frame: (frame) => {
      statistics.frames += 1;
      model.onFrame(frame);
    },
    status: (status) => {
      if (isFirstStatus) forget(...model.keepOnly(status.beacons.map((view) => view.address)));
      isFirstStatus = false;
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
      forget(message.a);
    },
    dropped: (message) => {
      statistics.dropped = message.frames;
      showState();
    },
  };

  setStatusTable(await fetchAlways("/status.json"));
  const layers = await fetchAlways("/map.json");
  model.geofence = layers.geofence;
  if (layers.floor_plan) {
    const image = new Image();
    image.addEventListener("load", () => {
      model.floorPlan = { image, area_m: layers.floor_plan.area_m };
      map.redraw();
    });
    image.addEventListener("error", () => {
      byId("legend").prepend(element("span", { className: "warning", textContent: "the floor plan cannot be shown as a picture" }));
    });
    image.src = urlOf(layers.floor_plan.url);
  }

  connection = new Connection({
    onMessage: (message) => handlers[message.op]?.(message),
    onState: (text, isConnected) => {
      stateText = text;
      statistics.connected = isConnected;
      statistics.dropped = 0;
      if (!isConnected) {
        settings.onLost();
        findings.onLost();
      }
      showState();
    },
  });

  const updateStatistics = () => {
    const hasTruth = [...model.beacons.values()].some((beacon) => beacon.truth.size > 0);
    for (const each of document.querySelectorAll('[data-of="truth"]')) each.hidden = !hasTruth;
    for (const beacon of model.beacons.values()) {
      const pose = beacon.poses.last(model.shown);
      if (pose) statistics.beacons[beacon.address] = { t: pose.t, x: pose.x, y: pose.y, z: pose.z, truth_error_m: beacon.truthErrorM };
    }
  };

  // Draws the map as soon as something is new, and the rest, which costs more and cannot be read faster, four times a
  // second.
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
    // At the end all: processes also log after the last pose.
    events.showUntil(playback?.isAtEnd ? Infinity : model.shown);
    updateStatistics();
  };
  requestAnimationFrame(draw);
})();
