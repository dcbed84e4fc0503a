// The WebSocket to the server; connects again by itself.
"use strict";

(() => {
  const token = new URLSearchParams(location.search).get("token");
  const query = token === null ? "" : `?token=${encodeURIComponent(token)}`;

  // Where a file of the server is, with the token.
  const urlOf = (path) => path + query;

  const mostSilentS = 5; // a live server says something every second

  const fetchJson = async (path) => {
    const response = await fetch(urlOf(path));
    if (!response.ok) throw Object.assign(new Error((await response.text()).trim()), { status: response.status });
    return response.json();
  };

  // Reason why a WebSocket did not open or was lost, which a browser does not give; empty if it is not known.
  const refusal = async (hasOpened) => {
    try {
      const response = await fetch(urlOf("/ws"));
      // The server would take a WebSocket: it refused that of the page, or a proxy does not pass it on.
      if (response.status === 426 && !hasOpened) return "the WebSocket was refused; see the log of the server or of a proxy";
      return [401, 403, 503].includes(response.status) ? (await response.text()).trim() : "";
    } catch {
      return "";
    }
  };

  class Connection {
    // `handlers`: onMessage(object) and onState(text, isConnected).
    constructor(handlers) {
      this.handlers = handlers;
      this.waitS = 0.25;
      this.isLive = false; // whether silence is a fault
      this.heardAt = 0;
      this.hasOpened = false; // the latest socket
      setInterval(() => this.watch(), 1000);
      this.open();
    }

    open() {
      this.handlers.onState("connecting", false);
      this.hasOpened = false;
      const scheme = location.protocol === "https:" ? "wss:" : "ws:";
      this.socket = new WebSocket(`${scheme}//${location.host}/ws${query}`, "sonopose.v1");
      this.socket.onopen = () => {
        this.waitS = 0.25;
        this.hasOpened = true;
        this.heardAt = performance.now();
        this.handlers.onState("connected", true);
      };
      this.socket.onmessage = (event) => {
        this.heardAt = performance.now();
        this.handlers.onMessage(JSON.parse(event.data));
      };
      this.socket.onclose = () => this.lose("connection lost");
    }

    // A connection can break without an end.
    watch() {
      if (!this.isLive || this.socket.readyState !== WebSocket.OPEN) return;
      if (performance.now() - this.heardAt < 1000 * mostSilentS) return;
      this.socket.onclose = this.socket.onmessage = null;
      this.socket.close();
      this.lose(`connection lost: no message for ${mostSilentS} s`);
    }

    lose(why) {
      const { waitS, hasOpened } = this;
      this.waitS = Math.min(4, 2 * waitS);
      this.handlers.onState(`${why}, trying again in ${waitS} s`, false);
      setTimeout(() => this.open(), 1000 * waitS);
      refusal(hasOpened).then((reason) => {
        if (reason && this.socket.readyState !== WebSocket.OPEN) this.handlers.onState(`${reason}; trying again`, false);
      });
    }

    send(object) {
      if (this.socket.readyState !== WebSocket.OPEN) return false;
      this.socket.send(JSON.stringify(object));
      return true;
    }
  }

  Object.assign(sonopose, { Connection, urlOf, fetchJson });
})();
